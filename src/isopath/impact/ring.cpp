#include "isopath/impact/ring.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "isopath/mesh/surface_walk.h"

namespace isopath {

Ring::Ring(const TriangleMesh& mesh, std::vector<SurfacePoint> points, bool open)
    : mesh_(mesh), open_(open), points_(std::move(points)) {
  positions_.reserve(points_.size());
  for (const SurfacePoint& point : points_) positions_.push_back(position_of(mesh, point));
  arc_.push_back(0);
  for (std::size_t i = 0; i < points_.size(); ++i)
    arc_.push_back(arc_.back() + (open && i + 1 == points_.size() ? 0 : (positions_[next(i)] - positions_[i]).norm()));
}

double Ring::wrapped(double arc) const {
  const double rest = arc - std::floor(arc / length()) * length();
  return rest < length() ? rest : 0;
}

std::size_t Ring::segment_at(double wrapped_arc) const {
  const auto above = std::upper_bound(arc_.begin(), arc_.end() - 1, wrapped_arc);
  return static_cast<std::size_t>(above - arc_.begin()) - 1;
}

double Ring::fraction_in(std::size_t segment, double wrapped_arc) const {
  const double length = arc_[segment + 1] - arc_[segment];
  return length > 0 ? std::clamp((wrapped_arc - arc_[segment]) / length, 0.0, 1.0) : 0;
}

SurfacePoint Ring::point(double arc) const {
  const double at = wrapped(arc);
  const std::size_t i = segment_at(at);
  const double t = fraction_in(i, at);
  const Index face = common_face(mesh_, points_[i], points_[next(i)]);
  if (t == 0 || face == no_index) return points_[i];
  const Vec3 a = express_in(mesh_, points_[i], face).barycentric;
  const Vec3 b = express_in(mesh_, points_[next(i)], face).barycentric;
  return {face, (1 - t) * a + t * b};
}

Vec3 Ring::position(double arc) const {
  const double at = wrapped(arc);
  const std::size_t i = segment_at(at);
  const double t = fraction_in(i, at);
  return (1 - t) * positions_[i] + t * positions_[next(i)];
}

double Ring::nearest_arc(const Vec3& place, double near, double reach) const {
  double best = wrapped(near);
  double least = (position(near) - place).squaredNorm();
  const std::size_t first = segment_at(wrapped(near - reach));
  double covered = -reach;
  for (std::size_t i = first; covered <= reach; i = next(i)) {
    const Vec3 side = positions_[next(i)] - positions_[i];
    const double t =
        side.squaredNorm() > 0 ? std::clamp((place - positions_[i]).dot(side) / side.squaredNorm(), 0.0, 1.0) : 0;
    const double d = (positions_[i] + t * side - place).squaredNorm();
    if (d < least) {
      least = d;
      best = wrapped(arc_[i] + t * (arc_[i + 1] - arc_[i]));
    }
    covered += arc_[i + 1] - arc_[i];
    if (next(i) == first) break;
  }
  return best;
}

void Ring::append_forward(SurfaceCurve& curve, double from, double to) const {
  const double start = wrapped(from);
  double left = wrapped(to) - start;
  if (left <= 0) left += length();
  curve.add(mesh_, point(start));
  std::size_t i = segment_at(start);
  double done = arc_[i + 1] - start;
  for (i = next(i); done < left; i = next(i)) {
    curve.points.push_back(points_[i]);
    curve.positions.push_back(positions_[i]);
    done += arc_[i + 1] - arc_[i];
  }
  curve.add(mesh_, point(to));
}

void Ring::append_backward(SurfaceCurve& curve, double from, double to) const {
  SurfaceCurve stretch;
  append_forward(stretch, to, from);
  stretch.reverse();
  curve.points.insert(curve.points.end(), stretch.points.begin(), stretch.points.end());
  curve.positions.insert(curve.positions.end(), stretch.positions.begin(), stretch.positions.end());
}

}  // namespace isopath
