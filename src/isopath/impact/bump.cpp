#include "isopath/impact/bump.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

/// Half the length of curve that a bump takes the place of, in spacings: low bumps are broad; high ones are narrow, as
/// what is taken away is missed on the other side.
constexpr double low_bump = 0.25;
constexpr double broad_base = 0.3;
constexpr double narrow_base = 0.13;
/// The curve may leave what it covered before by so much, in spacings.
constexpr double most_left = 0.16;
/// Bumps are tried in steps of this, in spacings.
constexpr double height_step = 0.02;
/// From so many cells of a spot the curve is looked for.
constexpr int most_feet = 5;

/// A place between two points of the curve, or at the first of them.
struct CurvePlace {
  Index after = 0;
  SurfacePoint at;
  Vec3 position = Vec3::Zero();
};

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 side = b - a;
  const double t = side.squaredNorm() > 0 ? std::clamp((p - a).dot(side) / side.squaredNorm(), 0.0, 1.0) : 0;
  return (a + t * side - p).norm();
}

class BumpBuilder {
 public:
  BumpBuilder(const SurfaceLinker& linker, const SmoothNormals& normals, const ImpactCurve& curve,
              const CoverField& cover, const OpenSpot& spot, double limit, double spacing)
      : linker_(linker), mesh_(linker.mesh()), normals_(normals), curve_(curve), cover_(cover), spot_(spot) {
    // a metric is taken for a scale of lengths in space as small as a spot
    const double in_space = distance_in_space(spot.cells.front());
    const double scale = in_space > 0 ? in_space / spot.cells.front().distance : 1;
    limit_ = scale * limit;
    spacing_ = scale * spacing;
  }

  std::optional<Replacement> best() const {
    std::optional<Bump> least;
    for (const CurvePlace& foot : feet()) {
      auto bump = bump_from(foot);
      if (bump && (!least || bump->cost < least->cost)) least = std::move(bump);
    }
    if (!least) return std::nullopt;
    return replacement(*least);
  }

 private:
  struct Bump {
    CurvePlace start;
    CurvePlace end;
    SurfacePoint tip;
    Vec3 tip_position = Vec3::Zero();
    double cost = 0;  ///< length added, mm
  };

  double distance_in_space(const SpotCell& cell) const {
    return length_of(make_curve(mesh_, cover_.field.shortest_path(cell.at)));
  }

  /// Where the shortest ways from the top of the spot, and from cells far from those asked before, come to the curve.
  std::vector<CurvePlace> feet() const {
    std::vector<CurvePlace> feet;
    std::vector<double> away(spot_.cells.size(), infinity);
    std::size_t asked = 0;
    for (int k = 0; k < most_feet; ++k) {
      const SpotCell& cell = spot_.cells[asked];
      const std::vector<SurfacePoint> way = cover_.field.shortest_path(cell.at);
      if (!way.empty()) {
        const SurfacePoint& at = way.back();
        const Vec3 position = position_of(mesh_, at);
        const bool known = std::any_of(feet.begin(), feet.end(), [&](const CurvePlace& foot) {
          return (foot.position - position).norm() < 0.05 * spacing_;
        });
        // asked at the foot: where two ways from the cell are equally long, its own nearest root may be the other one's
        if (!known) feet.push_back({cover_.curve_point[cover_.field.nearest(at).root], at, position});
      }
      for (std::size_t i = 0; i < away.size(); ++i)
        away[i] = std::min(away[i], (spot_.cells[i].position - cell.position).norm());
      asked = static_cast<std::size_t>(std::max_element(away.begin(), away.end()) - away.begin());
      if (away[asked] < 0.05 * spacing_) break;
    }
    return feet;
  }

  bool covers(Index i) const {
    return i > 0 && i < static_cast<Index>(curve_.points.size()) && curve_.points[i].kind == MoveKind::cover;
  }

  SurfacePoint between(const SurfacePoint& a, const SurfacePoint& b, double t) const {
    const Index face = common_face(mesh_, a, b);
    if (face == no_index) return t < 0.5 ? a : b;  // a step shorter than the tolerance, past a vertex
    return {face, (1 - t) * express_in(mesh_, a, face).barycentric + t * express_in(mesh_, b, face).barycentric};
  }

  /// Along the covering stretch around a foot, `length` back or forth, or as far as it goes.
  CurvePlace back(const CurvePlace& foot, double length) const {
    CurvePlace place = foot;
    for (Index i = foot.after;; --i) {
      const ImpactPoint& point = curve_.points[i];
      const double step = (point.position - place.position).norm();
      if (step >= length && step > 0) {
        const SurfacePoint at = between(place.at, point.at, length / step);
        return {i, at, position_of(mesh_, at)};
      }
      length -= step;
      place = {i, point.at, point.position};
      if (!covers(i)) return place;
    }
  }
  /// `after` of what is returned is that of the first point not passed.
  CurvePlace forth(const CurvePlace& foot, double length) const {
    CurvePlace place = foot;
    for (Index i = foot.after + 1;; ++i) {
      if (!covers(i)) return {i, place.at, place.position};
      const ImpactPoint& point = curve_.points[i];
      const double step = (point.position - place.position).norm();
      if (step >= length && step > 0) {
        const SurfacePoint at = between(place.at, point.at, length / step);
        return {i, at, position_of(mesh_, at)};
      }
      length -= step;
      place = {i, point.at, point.position};
    }
  }

  /// The lowest bump from a foot towards the top of the spot that reaches all of it.
  std::optional<Bump> bump_from(const CurvePlace& foot) const {
    const SpotCell& top = spot_.cells.front();
    const auto way = linker_.link(foot.at, top.at, 2 * spacing_);
    if (!way || way->size() < 2) return std::nullopt;
    const double full = length_of(*way);
    for (double height = height_step * spacing_;; height += height_step * spacing_) {
      height = std::min(height, full);
      const SurfacePoint tip = on_way(*way, height);
      Bump bump = bump_to(foot, tip, height < low_bump * spacing_ ? broad_base : narrow_base);
      if (reaches_all(bump)) return bump;
      if (height >= full) return std::nullopt;
    }
  }

  SurfacePoint on_way(const SurfaceCurve& way, double arc) const {
    for (std::size_t i = 1; i < way.size(); ++i) {
      const double step = (way.positions[i] - way.positions[i - 1]).norm();
      if (step >= arc && step > 0) return between(way.points[i - 1], way.points[i], arc / step);
      arc -= step;
    }
    return way.points.back();
  }

  Bump bump_to(const CurvePlace& foot, const SurfacePoint& tip, double base) const {
    Bump bump;
    bump.tip = tip;
    bump.tip_position = position_of(mesh_, tip);
    double dropped = 0;
    for (base *= spacing_;; base /= 2) {
      bump.start = back(foot, base);
      bump.end = forth(foot, base);
      if (base < 0.02 * spacing_ || leaves_little(bump, foot, dropped)) break;
    }
    bump.cost =
        (bump.tip_position - bump.start.position).norm() + (bump.end.position - bump.tip_position).norm() - dropped;
    return bump;
  }

  bool leaves_little(const Bump& bump, const CurvePlace& foot, double& dropped) const {
    dropped = 0;
    Vec3 last = bump.start.position;
    bool little = true;
    const auto pass = [&](const Vec3& p) {
      const double away = std::min(distance_to_segment(p, bump.start.position, bump.tip_position),
                                   distance_to_segment(p, bump.tip_position, bump.end.position));
      little = little && away <= most_left * spacing_;
      dropped += (p - last).norm();
      last = p;
    };
    for (Index i = bump.start.after + 1; i < bump.end.after; ++i) {
      if (i == foot.after + 1) pass(foot.position);
      pass(curve_.points[i].position);
    }
    if (foot.after + 1 >= bump.end.after) pass(foot.position);
    pass(bump.end.position);
    return little;
  }

  bool reaches_all(const Bump& bump) const {
    const Vec3& normal = mesh_.face_normal(bump.tip.face);
    return std::all_of(spot_.cells.begin(), spot_.cells.end(), [&](const SpotCell& cell) {
      const double straight = std::min(distance_to_segment(cell.position, bump.start.position, bump.tip_position),
                                       distance_to_segment(cell.position, bump.tip_position, bump.end.position));
      // over an edge of angle θ the way on the surface is at most 1 / cos(θ/2) times as long
      const double cos_of_half = std::sqrt(0.5 * (1 + normal.dot(mesh_.face_normal(cell.at.face))));
      return straight <= limit_ * std::max(cos_of_half, 0.5);
    });
  }

  std::optional<Replacement> replacement(const Bump& bump) const {
    Replacement replacement;
    replacement.first = bump.start.after;
    replacement.last = bump.end.after;
    const Index piece = curve_.points[bump.start.after].piece;
    const double longest = 4 * spacing_;
    const auto up = linker_.link(bump.start.at, bump.tip, longest);
    const auto down = linker_.link(bump.tip, bump.end.at, longest);
    if (!up || !down) return std::nullopt;
    const auto add = [&](const SurfacePoint& at, const Vec3& position) {
      replacement.points.push_back({MoveKind::cover, at, position, normals_.at(at), piece});
    };
    for (std::size_t i = 0; i < up->size(); ++i) add(up->points[i], up->positions[i]);
    for (std::size_t i = 1; i < down->size(); ++i) add(down->points[i], down->positions[i]);
    return replacement;
  }

  const SurfaceLinker& linker_;
  const TriangleMesh& mesh_;
  const SmoothNormals& normals_;
  const ImpactCurve& curve_;
  const CoverField& cover_;
  const OpenSpot& spot_;
  double limit_ = 0;
  double spacing_ = 0;
};

}  // namespace

std::optional<Replacement> bump_into(const SurfaceLinker& linker, const SmoothNormals& normals,
                                     const ImpactCurve& curve, const CoverField& cover, const OpenSpot& spot,
                                     double limit, double spacing) {
  return BumpBuilder(linker, normals, curve, cover, spot, limit, spacing).best();
}

}  // namespace isopath
