#include "isopath/impact/impact_curve.h"

namespace isopath {

std::string_view name_of(MoveKind kind) {
  switch (kind) {
    case MoveKind::cover:
      return "cover";
    case MoveKind::link:
      return "link";
    case MoveKind::lift:
      return "lift";
  }
  return "";
}

double length_of(const ImpactCurve& curve, MoveKind kind) {
  double sum = 0;
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    if (curve.points[i].kind == kind) sum += (curve.points[i].position - curve.points[i - 1].position).norm();
  }
  return sum;
}

}  // namespace isopath
