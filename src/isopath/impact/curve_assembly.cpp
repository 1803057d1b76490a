#include "isopath/impact/curve_assembly.h"

#include "isopath/impact/boundary_way.h"
#include "isopath/impact/lift.h"

namespace isopath {

void CurveAssembly::append(const SurfacePoint& at, const Vec3& position, MoveKind kind) {
  const double tolerance = linker_.mesh().tolerance().length;
  if (!curve_.points.empty() && kind != MoveKind::lift &&
      (curve_.points.back().position - position).norm() <= tolerance)
    return;
  curve_.points.push_back({kind, at, position, normals_.at(at), piece_});
}

void CurveAssembly::add_stroke(const SurfaceCurve& stroke) {
  if (stroke.empty()) return;
  if (!empty()) connect(stroke.points.front());
  for (std::size_t i = 0; i < stroke.size(); ++i) append(stroke.points[i], stroke.positions[i], MoveKind::cover);
}

void CurveAssembly::add_stretch(std::span<const ImpactPoint> stretch) {
  if (stretch.empty()) return;
  if (!empty()) connect(stretch.front().at);
  append(stretch.front().at, stretch.front().position, MoveKind::cover);
  for (const ImpactPoint& point : stretch.subspan(1)) append(point.at, point.position, point.kind);
}

void CurveAssembly::add_link(const SurfaceCurve& way) {
  for (std::size_t i = 1; i < way.size(); ++i) append(way.points[i], way.positions[i], MoveKind::link);
}

void CurveAssembly::connect(const SurfacePoint& to) {
  const ImpactPoint from = curve_.points.back();
  auto way = boundary_way(linker_.mesh(), from.at, to, limits_.longest_link);
  if (!way) way = linker_.link(from.at, to, limits_.longest_link);
  if (way) {
    add_link(*way);
    return;
  }
  ++piece_;
  const Vec3 place = position_of(linker_.mesh(), to);
  const LiftPath lift = lift_between(linker_.locator(), linker_.mesh().bounds(), from.position, from.normal, place,
                                     normals_.at(to), limits_.clearance);
  if (!lift.clear) ++blocked_lifts_;
  const std::size_t n = lift.way_points.size();
  for (std::size_t i = 0; i < n; ++i) {
    // the axis turns evenly from one normal to the other on the way
    const double t = n > 1 ? static_cast<double>(i) / static_cast<double>(n - 1) : 1;
    const Vec3 blended = (1 - t) * from.normal + t * normals_.at(to);
    const Vec3 normal = blended.norm() > 1e-6 ? Vec3(blended.normalized()) : from.normal;
    curve_.points.push_back({MoveKind::lift, {}, lift.way_points[i], normal, piece_});
  }
  append(to, place, MoveKind::lift);
}

}  // namespace isopath
