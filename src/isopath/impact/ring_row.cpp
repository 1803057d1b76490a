#include "isopath/impact/ring_row.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

/// Inside a row a turn ends so many spacings e from the lane. On the other side of it the passes before and behind it
/// are joined, and half way between the turn's pass and the next one a place x from the lane is
/// √((e - x + r)² + (w/2 + r)²) - r from where the turn starts: with the radius r = 0.08 w, no place is farther from
/// both than 0.51 w.
constexpr double turn_from_lane = 0.54;
/// Of a ring, on either side of the lane.
constexpr double most_of_ring = 0.12;
constexpr double most_detour = 1.3;

/// What is cut out of a ring of the row on both sides of the lane, mm.
struct Extent {
  double left = 0;
  double right = 0;
};

class RowBuilder {
 public:
  RowBuilder(const TriangleMesh& mesh, const std::vector<Ring>& rings, std::span<const RingPlace> row, double spacing)
      : mesh_(mesh), rings_(rings), row_(row), spacing_(spacing) {}

  std::optional<RingJoint> joint() {
    orient();
    RingJoint joint;
    for (Index k = 0; k < count(); ++k) {
      const Extent extent{reach(k, true), reach(k, false)};
      if (extent.left + extent.right > 2 * most_of_ring * ring(k).length()) return std::nullopt;
      const double arc = row_[k].arc;
      const double low = arc - (rising_[k] ? extent.left : extent.right);
      const double high = arc + (rising_[k] ? extent.right : extent.left);
      joint.cuts.push_back({row_[k].ring, ring(k).wrapped(low), ring(k).wrapped(high)});
    }
    for (Index k = 0; k + 1 < count(); ++k) {
      if (!add_turn(joint, k)) return std::nullopt;
    }
    if (!add_lane(joint)) return std::nullopt;
    return joint;
  }

 private:
  Index count() const { return static_cast<Index>(row_.size()); }
  const Ring& ring(Index k) const { return rings_[row_[k].ring]; }

  /// Looking along the row, arcs of the first ring rise to the right.
  void orient() {
    rising_ = {true};
    const double step = 0.3 * spacing_;
    for (Index k = 1; k < count(); ++k) {
      const auto at = [&](Index ring_of_row, double side) {
        return ring(ring_of_row).position(row_[ring_of_row].arc + (rising_at(ring_of_row) ? side : -side));
      };
      rising_.push_back(true);
      const double same = (at(k, step) - at(k - 1, step)).norm() + (at(k, -step) - at(k - 1, -step)).norm();
      const double other = (at(k, -step) - at(k - 1, step)).norm() + (at(k, step) - at(k - 1, -step)).norm();
      rising_[k] = same <= other;
    }
  }
  bool rising_at(Index k) const { return rising_[k]; }

  /// Rings k and k + 1 turn into each other on the left where k is even.
  static bool turns_left(Index k) { return k % 2 == 0; }

  /// How far from the lane a ring ends on one side: at the lane itself where it leads into that.
  double reach(Index k, bool left) const {
    const bool first = k == 0;
    const bool last = k + 1 == count();
    const bool has_turn = (!last && turns_left(k) == left) || (!first && turns_left(k - 1) == left);
    if (!has_turn) return 0;
    if (!first && !last) return std::min(turn_from_lane * spacing_, most_of_ring * ring(k).length());
    const Index other = first ? 1 : k - 1;
    const double apart = (ring(k).position(row_[k].arc) - ring(other).position(row_[other].arc)).norm();
    // where rings are nearer to each other than a spacing, cuts are shorter too
    return std::min({cut_over_spacing * spacing_, 2 * cut_over_spacing * apart, 2 * most_of_ring * ring(k).length()});
  }

  RingJoint::End end_of(Index k, bool left) const { return {k, left != rising_[k]}; }
  SurfacePoint point_of(const RingJoint& joint, const RingJoint::End& end) const {
    const RingJoint::Cut& cut = joint.cuts[end.cut];
    return rings_[cut.ring].point(end.high ? cut.high : cut.low);
  }

  bool add_turn(RingJoint& joint, Index k) const {
    const RingJoint::End from = end_of(k, turns_left(k));
    const RingJoint::End to = end_of(k + 1, turns_left(k));
    auto way = straight_rung(mesh_, point_of(joint, from), point_of(joint, to), most_detour);
    if (!way) return false;
    joint.rungs.push_back({from, to, *std::move(way)});
    return true;
  }

  /// Back along the middles of the cuts.
  bool add_lane(RingJoint& joint) const {
    const RingJoint::End from = end_of(count() - 1, !turns_left(count() - 2));
    const RingJoint::End to = end_of(0, !turns_left(0));
    SurfaceCurve lane;
    lane.add(mesh_, point_of(joint, from));
    for (Index k = count() - 1; k-- > 0;) {
      const SurfacePoint next = k == 0 ? point_of(joint, to) : ring(k).point(row_[k].arc);
      const auto way = straight_rung(mesh_, lane.points.back(), next, most_detour);
      if (!way) return false;
      for (std::size_t i = 1; i < way->size(); ++i) lane.add(mesh_, way->points[i]);
    }
    joint.rungs.push_back({from, to, std::move(lane)});
    return true;
  }

  const TriangleMesh& mesh_;
  const std::vector<Ring>& rings_;
  std::span<const RingPlace> row_;
  double spacing_;
  std::vector<char> rising_;
};

}  // namespace

std::optional<SurfaceCurve> straight_rung(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                          double most_detour) {
  std::vector<SurfacePoint> walk = surface_walk(mesh, from, to);
  if (walk.empty()) return std::nullopt;
  SurfaceCurve curve = make_curve(mesh, std::move(walk));
  const double straight = (curve.positions.back() - curve.positions.front()).norm();
  if (length_of(curve) > most_detour * straight + mesh.tolerance().length) return std::nullopt;
  return curve;
}

std::optional<RingJoint> joint_of_row(const TriangleMesh& mesh, const std::vector<Ring>& rings,
                                      std::span<const RingPlace> row, double spacing) {
  return RowBuilder(mesh, rings, row, spacing).joint();
}

}  // namespace isopath
