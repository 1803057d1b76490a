#include "isopath/impact/bump.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "isopath/impact/spot_patch.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

/// Half the length of curve that a bump takes the place of, in spacings: low bumps are broad; high ones are narrow, as
/// what is taken away is missed on the other side.
constexpr double low_bump = 0.25;
constexpr double broad_base = 0.3;
constexpr double narrow_base = 0.13;
/// Half a spacing from the curve this leaves less than a hundredth of a gap.
constexpr double slim_base = 0.06;
/// The curve may leave what it covered before by so much, in spacings.
constexpr double most_left = 0.16;
/// Bumps are tried in steps of this, in spacings.
constexpr double height_step = 0.02;
/// A tip that would lose more than this by rounding, in spacings, is made flat instead.
constexpr double most_rounded_off = 0.1;
/// Turns have this many points and, where the radius does not ask for more, a radius of at most so many spacings.
constexpr int points_of_turn = 28;
constexpr double largest_turn = 0.4;
/// A turn of exactly the radius would be drawn tight when its neighbourhood is.
constexpr double turn_over_radius = 1.1;
constexpr double turn_step = 0.03;
/// Swells are tried in steps of this height, up to the highest, and get broader by this factor up to the broadest half
/// width, in spacings, until they keep the radius.
constexpr double swell_step = 0.01;
constexpr double highest_swell = 0.25;
constexpr double broadening = 1.3;
constexpr double broadest_swell = 0.5;
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
              const CoverField& cover, const OpenSpot& spot, const BumpLimits& limits)
      : linker_(linker),
        mesh_(linker.mesh()),
        normals_(normals),
        curve_(curve),
        cover_(cover),
        spot_(spot),
        radius_(limits.radius),
        slim_(limits.slim),
        // a metric is taken for a scale of lengths in space as small as a spot
        scale_(scale_of_lengths()),
        limit_(scale_ * limits.reach),
        spacing_(scale_ * limits.spacing),
        patch_(mesh_, spot, limit_, limits.progress) {}

  std::optional<Replacement> best_turn() const {
    std::optional<Circle> best;
    for (const CurvePlace& foot : feet()) {
      const double least = turn_over_radius * radius_;
      for (double radius = least; radius <= std::max(least, largest_turn * spacing_); radius += turn_step * spacing_) {
        auto circle = circle_at(foot, radius);
        if (!circle) break;
        if (!best || circle->left < best->left || (circle->left == best->left && radius < best->radius))
          best = std::move(circle);
        if (best->left == 0) break;
      }
    }
    if (!best || best->left == spot_.cells.size()) return std::nullopt;
    std::vector<SurfacePoint> between(best->points.begin() + 1, best->points.end() - 1);
    return replacement(
        {best->foot, {best->foot.after + 1, best->foot.at, best->foot.position}, std::move(between), {}, 0});
  }

  std::optional<Replacement> best_swell() const { return cheapest(&BumpBuilder::swell_from); }
  std::optional<Replacement> best() const { return cheapest(&BumpBuilder::bump_from); }

 private:
  struct Bump {
    CurvePlace start;
    CurvePlace end;
    std::vector<SurfacePoint> control;  ///< the way between both
    std::vector<SurfacePoint> reached;  ///< where that way will be once it is rounded, with both
    double cost = 0;                    ///< length added, mm
  };
  struct Circle {
    CurvePlace foot;
    double radius = 0;
    std::vector<SurfacePoint> points;  ///< from the foot to the foot
    std::size_t left = 0;              ///< cells out of reach
  };

  double scale_of_lengths() const {
    const SpotCell& top = spot_.cells.front();
    const double in_space = length_of(make_curve(mesh_, cover_.field.shortest_path(top.at)));
    return in_space > 0 ? in_space / top.distance : 1;
  }

  /// The one that lengthens the curve least, of those from each place near the spot.
  std::optional<Replacement> cheapest(std::optional<Bump> (BumpBuilder::*from)(const CurvePlace&, double) const) const {
    std::optional<Bump> least;
    for (const CurvePlace& foot : feet()) {
      if (auto bump = (this->*from)(foot, least ? least->cost : infinity)) least = std::move(bump);
    }
    if (!least) return std::nullopt;
    return replacement(*least);
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
        const SurfacePoint at{way.back().face, snapped(way.back().barycentric)};
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
    return {face,
            snapped((1 - t) * express_in(mesh_, a, face).barycentric + t * express_in(mesh_, b, face).barycentric)};
  }

  /// From a place to point i of the curve, or as far as `length` lasts: then true.
  bool walk_to(Index i, double& length, CurvePlace& place) const {
    const ImpactPoint& point = curve_.points[i];
    const double step = (point.position - place.position).norm();
    if (step >= length && step > 0) {
      const SurfacePoint at = between(place.at, point.at, length / step);
      place = {i, at, position_of(mesh_, at)};
      return true;
    }
    length -= step;
    place = {i, point.at, point.position};
    return false;
  }
  /// Along the covering stretch around a foot, `length` back or forth, or as far as it goes.
  CurvePlace back(const CurvePlace& foot, double length) const {
    CurvePlace place = foot;
    Index i = foot.after;
    while (!walk_to(i, length, place) && covers(i)) --i;
    return place;
  }
  /// `after` of what is returned is that of the first point not passed.
  CurvePlace forth(const CurvePlace& foot, double length) const {
    CurvePlace place = foot;
    Index i = foot.after + 1;
    while (covers(i) && !walk_to(i, length, place)) ++i;
    place.after = i;
    return place;
  }

  /// The lowest bump from a foot towards the top of the spot that reaches all of it, unless that costs too much.
  std::optional<Bump> bump_from(const CurvePlace& foot, double most_cost) const {
    const SpotCell& top = spot_.cells.front();
    const auto way = linker_.link(foot.at, top.at, 2 * spacing_);
    if (!way || way->size() < 2) return std::nullopt;
    const double full = length_of(*way);
    for (double height = std::min(height_step * spacing_, full);;) {
      auto bump = bump_to(foot, *way, height);
      if (bump && bump->cost >= most_cost) return std::nullopt;
      const double missing = bump ? farthest_from(bump->reached) - limit_ : 0;
      if (bump && missing <= 0) return bump;
      if (height >= full) return std::nullopt;
      // no point of a bump moves farther than its tip
      height = std::min(full, height + std::max(height_step * spacing_, std::min(missing, full)));
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

  /// How much of a corner is lost when it is rounded.
  double rounded_off(const Vec3& before, const Vec3& corner, const Vec3& behind) const {
    const Vec3 a = (before - corner).stableNormalized();
    const Vec3 b = (behind - corner).stableNormalized();
    const double sin_of_half = std::sqrt(std::max(0.0, 0.5 * (1 - a.dot(b))));
    return radius_ * (1 / std::max(sin_of_half, 0.1) - 1);
  }

  /// A bump whose tip is at this height on the way from the foot once it is rounded. None where there is no room.
  std::optional<Bump> bump_to(const CurvePlace& foot, const SurfaceCurve& way, double height) const {
    Bump bump;
    double dropped = 0;
    const SurfacePoint tip_point = on_way(way, height);
    const Vec3 tip = position_of(mesh_, tip_point);
    const double widest_base = slim_ ? slim_base : height < low_bump * spacing_ ? broad_base : narrow_base;
    for (double base = spacing_ * widest_base;; base /= 2) {
      bump.start = back(foot, base);
      bump.end = forth(foot, base);
      if (base < 0.02 * spacing_ || leaves_little(bump, foot, tip, dropped)) break;
    }
    bump.reached = {bump.start.at, tip_point, bump.end.at};
    double loss = rounded_off(bump.start.position, tip, bump.end.position);
    if (loss <= most_rounded_off * spacing_) {
      bump.control = {on_way(way, height + loss)};
    } else if (!add_flat_tip(tip_point, bump)) {
      return std::nullopt;
    }
    Vec3 last = bump.start.position;
    for (const SurfacePoint& point : bump.control) {
      const Vec3 position = position_of(mesh_, point);
      bump.cost += (position - last).norm();
      last = position;
    }
    bump.cost += (bump.end.position - last).norm() - dropped;
    return bump;
  }

  /// Two corners beside a tip that is too sharp to be rounded.
  bool add_flat_tip(const SurfacePoint& tip, Bump& bump) const {
    const Vec3 along = (bump.end.position - bump.start.position).stableNormalized();
    const Vec3 middle = position_of(mesh_, tip);
    for (const double side : {-1.2, 1.2}) {
      const NearestPoint corner = linker_.locator().nearest(middle + side * radius_ * along, spacing_);
      if (!corner.at.valid()) return false;
      bump.control.push_back(corner.at);
    }
    return true;
  }

  bool leaves_little(const Bump& bump, const CurvePlace& foot, const Vec3& tip, double& dropped) const {
    dropped = 0;
    Vec3 last = bump.start.position;
    bool little = true;
    const auto pass = [&](const Vec3& p) {
      const double away =
          std::min(distance_to_segment(p, bump.start.position, tip), distance_to_segment(p, tip, bump.end.position));
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

  /// The way over some points, along the surface unless straight distances from it will do. Empty where there is none.
  SurfaceCurve way_over(const std::vector<SurfacePoint>& points) const {
    if (patch_.nearly_flat()) return make_curve(mesh_, points);
    SurfaceCurve way;
    way.add(mesh_, points.front());
    for (std::size_t i = 1; i < points.size(); ++i) {
      const auto step = linker_.link(points[i - 1], points[i], 4 * spacing_);
      if (!step) return {};
      for (std::size_t k = 1; k < step->size(); ++k) way.add(mesh_, step->points[k]);
    }
    return way;
  }
  std::vector<double> distances_from(const std::vector<SurfacePoint>& points) const {
    const SurfaceCurve way = way_over(points);
    return way.empty() ? std::vector<double>(spot_.cells.size(), infinity) : patch_.distances_from(way);
  }
  /// How far the spot goes from a way.
  double farthest_from(const std::vector<SurfacePoint>& points) const {
    const std::vector<double> distances = distances_from(points);
    return *std::max_element(distances.begin(), distances.end());
  }

  /// The circle beside the curve, in the plane that touches the surface at the foot, brought to the surface.
  std::optional<Circle> circle_at(const CurvePlace& foot, double radius) const {
    const Vec3 along = forth(foot, 0.5 * radius).position - back(foot, 0.5 * radius).position;
    const Vec3& normal = mesh_.face_normal(foot.at.face);
    Vec3 aside = normal.cross(along);
    if (!(along.norm() > 0.5 * radius && aside.norm() > 0.5 * along.norm())) return std::nullopt;
    aside.normalize();
    const Vec3 ahead = aside.cross(normal);
    if (aside.dot(spot_.cells.front().position - foot.position) < 0) aside = -aside;
    Circle circle{foot, radius, {}, 0};
    circle.points = {foot.at};
    Vec3 last = foot.position;
    const double step = 2 * std::numbers::pi * radius / points_of_turn;
    for (int i = 1; i < points_of_turn; ++i) {
      const double angle = 2 * std::numbers::pi * i / points_of_turn;
      const Vec3 place = foot.position + radius * (std::sin(angle) * ahead + (1 - std::cos(angle)) * aside);
      const NearestPoint there = linker_.locator().nearest(place, radius);
      if (!there.at.valid()) return std::nullopt;
      // over an edge or the rim the circle would be pressed flat
      const Vec3 position = position_of(mesh_, there.at);
      const double stepped = (position - last).norm();
      last = position;
      if (stepped < 0.7 * step || stepped > 1.4 * step) return std::nullopt;
      circle.points.push_back(there.at);
    }
    circle.points.push_back(foot.at);
    const std::vector<double> distances = distances_from(circle.points);
    circle.left = static_cast<std::size_t>(
        std::count_if(distances.begin(), distances.end(), [&](double distance) { return distance > limit_; }));
    return circle;
  }

  /// Places along the curve from half a width behind a foot to half a width before it, evenly spaced; empty where the
  /// covering stretch is shorter.
  std::vector<CurvePlace> around(const CurvePlace& foot, double half_width, int steps) const {
    const CurvePlace end = forth(foot, half_width);
    CurvePlace at = back(foot, half_width);
    std::vector<CurvePlace> places = {at};
    double length = 0;
    Vec3 last = at.position;
    for (Index i = at.after + 1; i < end.after; ++i) {
      length += (curve_.points[i].position - last).norm();
      last = curve_.points[i].position;
    }
    length += (end.position - last).norm();
    if (length < 1.9 * half_width) return {};
    for (int k = 1; k < steps; ++k) {
      at = forth(at, length / steps);
      at.after -= 1;
      places.push_back(at);
    }
    places.push_back(end);
    return places;
  }

  /// The lowest swell that reaches all of the spot: the curve around a foot is shifted towards the top of the spot by
  /// h cos², which turns by no more than h π² / 2 b² where the curve is straight.
  std::optional<Bump> swell_from(const CurvePlace& foot, double most_cost) const {
    const Vec3 aim = spot_.cells.front().position - foot.position;
    const Vec3& normal = mesh_.face_normal(foot.at.face);
    const Vec3 aside = (aim - normal.dot(aim) * normal).stableNormalized();
    const double missing = scale_ * spot_.cells.front().distance - limit_;
    for (double height = swell_step; height <= highest_swell; height += swell_step) {
      if (height * spacing_ < missing) continue;
      const double h = height * spacing_;
      double half_width = std::max(std::numbers::pi * std::sqrt(0.5 * h * 1.1 * radius_), 0.05 * spacing_);
      for (; half_width <= broadest_swell * spacing_; half_width *= broadening) {
        auto swell = swell_of(foot, aside, h, half_width);
        if (!swell) continue;
        if (swell->cost >= most_cost) return std::nullopt;
        if (farthest_from(swell->reached) <= limit_) return swell;
        break;
      }
    }
    return std::nullopt;
  }

  /// None where it would turn too tightly or there is no room.
  std::optional<Bump> swell_of(const CurvePlace& foot, const Vec3& aside, double height, double half_width) const {
    const double span = half_width + 0.5 * radius_;  // with what the turns at its ends are measured on
    const int steps = static_cast<int>(std::clamp(std::ceil(2 * span / (0.25 * radius_)), 8.0, 64.0));
    const std::vector<CurvePlace> places = around(foot, span, steps);
    if (places.empty()) return std::nullopt;
    Bump swell;
    swell.start = places.front();
    swell.end = places.back();
    std::vector<Vec3> way;
    for (int k = 0; k <= steps; ++k) {
      const double away = std::min(1.0, std::abs(2.0 * k / steps - 1) * span / half_width);
      const double c = std::cos(0.5 * std::numbers::pi * away);
      way.push_back(places[k].position + height * c * c * aside);
    }
    if (least_radius(way, mesh_.face_normal(foot.at.face)) < radius_) return std::nullopt;
    for (int k = 1; k < steps; ++k) {
      const NearestPoint there = linker_.locator().nearest(way[k], height + 0.1 * spacing_);
      if (!there.at.valid()) return std::nullopt;
      const Vec3 position = position_of(mesh_, there.at);
      if ((position - way[k]).norm() > 0.3 * height) return std::nullopt;  // beyond the rim, over an edge
      swell.control.push_back(there.at);
      way[k] = position;
    }
    swell.reached = {swell.start.at};
    swell.reached.insert(swell.reached.end(), swell.control.begin(), swell.control.end());
    swell.reached.push_back(swell.end.at);
    for (int k = 1; k <= steps; ++k) {
      swell.cost += (way[k] - way[k - 1]).norm();
      swell.cost -= (places[k].position - places[k - 1].position).norm();
    }
    return swell;
  }

  /// Of the circles through points of a way about half the radius apart, seen along the normal.
  double least_radius(const std::vector<Vec3>& way, const Vec3& normal) const {
    double least = infinity;
    const double step = (way[1] - way[0]).norm();
    if (!(step > 0)) return 0;
    const auto arm = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::min(std::round(0.5 * radius_ / step), static_cast<double>(way.size()))));
    for (std::size_t i = arm; i + arm < way.size(); ++i) {
      Vec3 a = way[i] - way[i - arm];
      Vec3 b = way[i + arm] - way[i];
      a -= normal.dot(a) * normal;
      b -= normal.dot(b) * normal;
      const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
      if (angle > 0) least = std::min(least, 0.25 * (a.norm() + b.norm()) / std::sin(0.5 * angle));
    }
    return least;
  }

  std::optional<Replacement> replacement(const Bump& bump) const {
    Replacement replacement;
    replacement.first = bump.start.after;
    replacement.last = bump.end.after;
    replacement.added = bump.cost;
    const Index piece = curve_.points[bump.start.after].piece;
    const auto add = [&](const SurfacePoint& at, const Vec3& position) {
      replacement.points.push_back({MoveKind::cover, at, position, normals_.at(at), piece});
    };
    add(bump.start.at, bump.start.position);
    std::vector<SurfacePoint> goals = bump.control;
    goals.push_back(bump.end.at);
    for (const SurfacePoint& goal : goals) {
      const auto way = linker_.link(replacement.points.back().at, goal, 4 * spacing_);
      if (!way) return std::nullopt;
      for (std::size_t i = 1; i < way->size(); ++i) add(way->points[i], way->positions[i]);
    }
    return replacement;
  }

  const SurfaceLinker& linker_;
  const TriangleMesh& mesh_;
  const SmoothNormals& normals_;
  const ImpactCurve& curve_;
  const CoverField& cover_;
  const OpenSpot& spot_;
  double radius_;
  bool slim_;
  double scale_;    ///< lengths in space over those of the field
  double limit_;    ///< the reach, in space
  double spacing_;  ///< in space
  SpotPatch patch_;
};

}  // namespace

std::optional<Replacement> bump_into(const SurfaceLinker& linker, const SmoothNormals& normals,
                                     const ImpactCurve& curve, const CoverField& cover, const OpenSpot& spot,
                                     const BumpLimits& limits) {
  return BumpBuilder(linker, normals, curve, cover, spot, limits).best();
}

std::optional<Replacement> swell_into(const SurfaceLinker& linker, const SmoothNormals& normals,
                                      const ImpactCurve& curve, const CoverField& cover, const OpenSpot& spot,
                                      const BumpLimits& limits) {
  // no point of a swell moves farther than its top
  if (spot.cells.front().distance - limits.reach > highest_swell * limits.spacing) return std::nullopt;
  return BumpBuilder(linker, normals, curve, cover, spot, limits).best_swell();
}

std::optional<Replacement> turn_into(const SurfaceLinker& linker, const SmoothNormals& normals,
                                     const ImpactCurve& curve, const CoverField& cover, const OpenSpot& spot,
                                     const BumpLimits& limits) {
  return BumpBuilder(linker, normals, curve, cover, spot, limits).best_turn();
}

}  // namespace isopath
