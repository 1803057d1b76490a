#include "isopath/tool/thin_path.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "isopath/core/angle.h"
#include "isopath/core/segment.h"

namespace isopath {
namespace {

// The great circle from one axis to another.
class AxisArc {
 public:
  AxisArc(const Vec3& a, const Vec3& b) : a_(a), b_(b), angle_(angle_between(a, b)), sine_(std::sin(angle_)) {}

  Vec3 at(double u) const {
    // Nearly parallel: the chord's midpoint differs from the arc by angle^2 / 8, below rounding here; nearly opposite:
    // the great circle is not defined.
    if (sine_ < 1e-8) return a_.dot(b_) > 0 ? ((1 - u) * a_ + u * b_).normalized() : (u < 0.5 ? a_ : b_);
    return (std::sin((1 - u) * angle_) * a_ + std::sin(u * angle_) * b_) / sine_;
  }

 private:
  Vec3 a_;
  Vec3 b_;
  double angle_;
  double sine_;
};

// How far the point is from the move a to b, as a multiple of the tolerances.
double excess(const ToolPoint& point, const ToolPoint& a, const ToolPoint& b, const AxisArc& axes, double chord,
              double angle) {
  const double u = nearest_on_segment(a.tip, b.tip, point.tip);
  const double distance = (point.tip - mix(a.tip, b.tip, u)).norm();
  const double turn = angle_between(point.axis, axes.at(u));
  // An axis tolerance of 0 asks for equal axes: 1e-15 is the rounding error of two unit vectors.
  return std::max(distance / chord, turn / std::max(angle, 1e-15));
}

bool same_run(const ToolPoint& a, const ToolPoint& b) { return a.kind == b.kind && a.piece == b.piece; }

// Marks the points of [first, last] to keep; the ends already are.
void keep_needed(const std::vector<ToolPoint>& points, std::size_t first, std::size_t last, double chord, double angle,
                 std::vector<char>& keep, const Progress& progress) {
  std::vector<std::pair<std::size_t, std::size_t>> open = {{first, last}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    progress.checkpoint();
    double worst = 1;
    std::size_t split = a;
    const AxisArc axes(points[a].axis, points[b].axis);
    for (std::size_t i = a + 1; i < b; ++i) {
      const double e = excess(points[i], points[a], points[b], axes, chord, angle);
      if (e > worst) {
        worst = e;
        split = i;
      }
    }
    if (split == a) continue;
    keep[split] = 1;
    open.emplace_back(a, split);
    open.emplace_back(split, b);
  }
}

}  // namespace

Vec3 axis_between(const Vec3& a, const Vec3& b, double u) { return AxisArc(a, b).at(u); }

ToolPath thin_path(const ToolPath& path, double chord_tolerance, double axis_tolerance, const Progress& progress) {
  const std::vector<ToolPoint>& points = path.points;
  if (!(chord_tolerance > 0) || points.size() < 3) return path;
  std::vector<char> keep(points.size(), 0);
  for (std::size_t first = 0; first < points.size();) {
    std::size_t last = first;
    while (last + 1 < points.size() && same_run(points[first], points[last + 1])) ++last;
    keep[first] = keep[last] = 1;
    keep_needed(points, first, last, chord_tolerance, axis_tolerance, keep, progress);
    first = last + 1;
  }
  ToolPath result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (keep[i]) result.points.push_back(points[i]);
  }
  return result;
}

}  // namespace isopath
