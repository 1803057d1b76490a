#include "isopath/impact/surface_curve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "isopath/core/quiet_progress.h"
#include "isopath/field/exact_field.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {

void SurfaceCurve::add(const TriangleMesh& mesh, const SurfacePoint& point) {
  points.push_back(point);
  positions.push_back(position_of(mesh, point));
}

void SurfaceCurve::reverse() {
  std::reverse(points.begin(), points.end());
  std::reverse(positions.begin(), positions.end());
}

void append_between(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to, double step,
                    std::vector<SurfacePoint>& points) {
  const Index face = common_face(mesh, from, to);
  if (face == no_index) return;
  const Vec3 start = express_in(mesh, from, face).barycentric;
  const Vec3 way = express_in(mesh, to, face).barycentric - start;
  const double length = (position_of(mesh, to) - position_of(mesh, from)).norm();
  const int parts = static_cast<int>(std::clamp(std::ceil(length / step), 1.0, 1000.0));
  for (int k = 1; k < parts; ++k) points.push_back({face, start + way * (static_cast<double>(k) / parts)});
}

SurfaceCurve make_curve(const TriangleMesh& mesh, std::vector<SurfacePoint> points) {
  SurfaceCurve curve;
  curve.points = std::move(points);
  curve.positions.reserve(curve.points.size());
  for (const SurfacePoint& point : curve.points) curve.positions.push_back(position_of(mesh, point));
  return curve;
}

double length_of(const SurfaceCurve& curve) {
  double sum = 0;
  for (std::size_t i = 1; i < curve.size(); ++i) sum += (curve.positions[i] - curve.positions[i - 1]).norm();
  return sum;
}

std::size_t nearest_index(const SurfaceCurve& curve, const Vec3& place) {
  std::size_t best = 0;
  double least = infinity;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const double d = (curve.positions[i] - place).squaredNorm();
    if (d < least) {
      least = d;
      best = i;
    }
  }
  return best;
}

SurfaceCurve rotated(const SurfaceCurve& closed, std::size_t start) {
  SurfaceCurve curve = closed;
  std::rotate(curve.points.begin(), curve.points.begin() + start, curve.points.end());
  std::rotate(curve.positions.begin(), curve.positions.begin() + start, curve.positions.end());
  return curve;
}

SurfaceCurve closed_from(const TriangleMesh& mesh, const Contour& contour, const Vec3& place) {
  const SurfaceCurve all = make_curve(mesh, contour.points);
  SurfaceCurve curve = rotated(all, nearest_index(all, place));
  const SurfacePoint first = curve.points.front();
  curve.add(mesh, first);
  return curve;
}

std::optional<SurfaceCurve> SurfaceLinker::plain_link(const SurfacePoint& from, const SurfacePoint& to,
                                                      double longest) const {
  if ((position_of(mesh_, to) - position_of(mesh_, from)).norm() > longest) return std::nullopt;
  if (mesh_.component_of(from.face) != mesh_.component_of(to.face)) return std::nullopt;
  if (common_face(mesh_, from, to) != no_index) return make_curve(mesh_, {from, to});
  auto walk = surface_walk(mesh_, from, to);
  if (walk.empty()) return std::nullopt;
  SurfaceCurve curve = make_curve(mesh_, std::move(walk));
  if (length_of(curve) > longest) return std::nullopt;
  return curve;
}

std::optional<SurfaceCurve> SurfaceLinker::link(const SurfacePoint& from, const SurfacePoint& to,
                                                double longest) const {
  if (auto curve = plain_link(from, to, longest)) return curve;
  if ((position_of(mesh_, to) - position_of(mesh_, from)).norm() > longest) return std::nullopt;
  if (mesh_.component_of(from.face) != mesh_.component_of(to.face)) return std::nullopt;
  SourceSet source;
  source.add_point(from);
  QuietProgress quiet(progress_);
  quiet.checkpoint();
  const ExactField field = ExactField::compute(mesh_, source, {.stop_distance = longest}, quiet);
  if (field.value(to) > longest) return std::nullopt;
  SurfaceCurve path = make_curve(mesh_, field.shortest_path(to));
  path.reverse();
  return path;
}

void SurfaceLinker::extend(SurfaceCurve& curve, const SurfacePoint& to) const {
  if (curve.empty()) return curve.add(mesh_, to);
  if (mesh_.component_of(curve.points.back().face) != mesh_.component_of(to.face)) return curve.add(mesh_, to);
  const double straight = (position_of(mesh_, to) - curve.positions.back()).norm();
  // the way over a sharp edge can be many times as long as the straight one
  for (double longest = 4 * straight + mesh_.tolerance().length; longest < 16 * mesh_.size(); longest *= 4) {
    const auto way = link(curve.points.back(), to, longest);
    if (!way) continue;
    for (std::size_t i = 1; i < way->size(); ++i) curve.add(mesh_, way->points[i]);
    return;
  }
  curve.add(mesh_, to);
}

}  // namespace isopath
