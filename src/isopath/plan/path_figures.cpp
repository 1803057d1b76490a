#include "isopath/plan/path_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/impact/min_radius.h"

namespace isopath {
namespace {

/// A polyline in space with the arc length and the surface's normal at each of its points, which are all distinct.
class Polyline {
 public:
  void append(const ImpactPoint& place) {
    const Vec3& point = place.position;
    if (!points_.empty() && points_.back() == point) return;
    arc_.push_back(points_.empty() ? 0 : arc_.back() + (point - points_.back()).norm());
    points_.push_back(point);
    normals_.push_back(place.normal);
  }
  std::size_t size() const { return points_.size(); }
  double length() const { return arc_.empty() ? 0 : arc_.back(); }
  double arc(std::size_t i) const { return arc_[i]; }
  const Vec3& point(std::size_t i) const { return points_[i]; }
  /// The normal at the last point before an arc, and at the first one after it.
  const Vec3& normal_before(double arc) const { return normals_[segment_at(arc)]; }
  const Vec3& normal_after(double arc) const { return normals_[segment_at(arc) + 1]; }

  Vec3 at(double arc) const {
    const std::size_t j = segment_at(arc) + 1;
    const double fraction = (arc - arc_[j - 1]) / (arc_[j] - arc_[j - 1]);
    return points_[j - 1] + fraction * (points_[j] - points_[j - 1]);
  }

 private:
  /// The segment that holds an arc, by its first point.
  std::size_t segment_at(double arc) const {
    const auto above = std::upper_bound(arc_.begin(), arc_.end(), arc);
    return std::clamp<std::size_t>(static_cast<std::size_t>(above - arc_.begin()), 1, size() - 1) - 1;
  }

  std::vector<Vec3> points_;
  std::vector<Vec3> normals_;
  std::vector<double> arc_;
};

/// Maximal stretches of moves whose kind `take` accepts, each with the point it starts from.
template <class Take>
std::vector<Polyline> stretches(const ImpactCurve& curve, Take take) {
  std::vector<Polyline> found;
  bool inside = false;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const ImpactPoint& point = curve.points[i];
    // The first point of the curve arrives from nowhere; it only starts a stretch.
    if (i == 0 || !take(point.kind)) {
      inside = false;
      continue;
    }
    if (!inside) found.emplace_back().append(curve.points[i - 1]);
    found.back().append(point);
    inside = true;
  }
  return found;
}

/// Radius of the circle through three points: the product of the sides over four times the area.
double circumradius(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double twice_area = (b - a).cross(c - a).norm();
  const double product = (b - a).norm() * (c - b).norm() * (a - c).norm();
  // Three points in line, up to rounding, have no circle; two that fall together are a reversal.
  if (product == 0) return 0;
  return twice_area <= 1e-9 * (b - a).norm() * (c - b).norm() ? infinity : product / (2 * twice_area);
}

double smallest_radius(const Polyline& line, double reach) {
  double least = infinity;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double s = line.arc(i);
    if (s < reach || s + reach > line.length()) continue;
    least = std::min(least, circumradius(line.at(s - reach), line.point(i), line.at(s + reach)));
  }
  return least;
}

/// A step as it would be if the surface were unfolded, so that one normal became the other.
Vec3 unfolded(const Vec3& step, const Vec3& normal, const Vec3& onto) {
  const Vec3 axis = normal.cross(onto);
  const double cosine = normal.dot(onto);
  if (cosine < -0.9) return step;  // folded back: there is no telling how
  return cosine * step + axis.cross(step) + axis.dot(step) / (1 + cosine) * axis;
}

/// More than 45 degrees between two steps.
bool turns_sharply(const Vec3& arriving, const Vec3& leaving) {
  return arriving.dot(leaving) < std::cos(std::numbers::pi / 4) * arriving.norm() * leaving.norm();
}

Index count_turns(const Polyline& line, double reach) {
  Index count = 0;
  double last = -infinity;
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    const double s = line.arc(i);
    if (s < reach || s + reach > line.length()) continue;
    const Vec3 arriving = line.point(i) - line.at(s - reach);
    const Vec3 leaving = line.at(s + reach) - line.point(i);
    if (!turns_sharply(arriving, leaving)) continue;
    // a straight way over a sharp edge of the part turns in space alone
    if (!turns_sharply(arriving, unfolded(leaving, line.normal_after(s + reach), line.normal_before(s - reach))))
      continue;
    if (s - last > 2 * reach) ++count;
    last = s;
  }
  return count;
}

}  // namespace

PathFigures path_figures(const ImpactCurve& curve, double spacing, double radius) {
  if (!(spacing > 0)) {
    throw Error(ErrorCode::bad_usage, "the spacing must be above zero",
                {.element = "spacing", .value = fmt::format("{}", spacing)});
  }
  PathFigures figures;
  const double window = radius > 0 ? std::min(spacing / 2, radius_window * radius) : spacing / 2;
  figures.cover_length = length_of(curve, MoveKind::cover);
  figures.links_length = length_of(curve, MoveKind::link);
  figures.pieces = curve.points.empty() ? 0 : curve.points.back().piece + 1;
  figures.lifts = std::max<Index>(figures.pieces - 1, 0);
  for (const Polyline& line : stretches(curve, [](MoveKind kind) { return kind == MoveKind::cover; })) {
    figures.min_radius = std::min(figures.min_radius, smallest_radius(line, window));
  }
  for (const Polyline& line : stretches(curve, [](MoveKind kind) { return kind != MoveKind::lift; })) {
    figures.sharp_corners += count_turns(line, spacing / 20);
    figures.tight_turns += count_turns(line, spacing / 4);
  }
  return figures;
}

}  // namespace isopath
