#include "isopath/impact/ring_joints.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "isopath/impact/ring_neighbours.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

/// Length c of a cut in spacings w. On the edge of the part, w/2 from the ring, the nearest rung's foot is √(w² + c²) /
/// 2 away; where its corner is rounded with the radius r it is √((c/2 + r)² + (w/2 + r)²) - r: this and 0.08 w keep the
/// gap there at 1.05 w.
constexpr double cut_over_spacing = 0.18;
/// Rings at the top of the function are half a spacing from the next one; where they are nearer still, or where a
/// metric makes them so, cuts are shorter too.
constexpr double most_cut_over_distance = 2 * cut_over_spacing;
constexpr double most_cut_of_ring = 0.2;

/// What a joint has to keep; one set of limits after the other is tried on the rings that are left.
struct Limits {
  double nearest = 0;  ///< spacings between the rings
  double farthest = 0;
  double separation = 0;   ///< spacings between joints of one ring, in space
  double most_detour = 0;  ///< a rung's length over the distance of its ends
};

class JointChooser {
 public:
  JointChooser(const SurfaceLinker& linker, const std::vector<Ring>& rings, double spacing, Progress& progress)
      : linker_(linker),
        mesh_(linker.mesh()),
        rings_(rings),
        spacing_(spacing),
        progress_(progress),
        samples_(rings, spacing, progress),
        joints_of_(rings.size()),
        joined_(rings.size(), 0) {
    for (const Ring& ring : rings) component_.push_back(mesh_.component_of(ring.face()));
  }

  std::vector<RingJoint> run() {
    start_trees();
    for (const Limits& limits : {Limits{0.8, 1.2, 1.5, 1.3}, Limits{0.4, 1.25, 1.2, 1.5}, Limits{0, 1.7, 0.8, 2}})
      grow(limits);
    for (double radius = 2.5; radius * spacing_ < 4 * mesh_.size() && rings_left(); radius *= 2)
      grow({0, radius, 0, 4});
    return std::move(joints_);
  }

 private:
  bool rings_left() const { return std::find(joined_.begin(), joined_.end(), 0) != joined_.end(); }

  /// The longest ring of every component is the root of its tree.
  void start_trees() {
    std::vector<Index> root(mesh_.n_components(), no_index);
    for (Index k = 0; k < static_cast<Index>(rings_.size()); ++k) {
      Index& best = root[component_[k]];
      if (best == no_index || rings_[k].length() > rings_[best].length()) best = k;
    }
    for (const Index k : root) {
      if (k != no_index) joined_[k] = 1;
    }
  }

  /// Breadth first from the rings that are joined already, so that trees stay shallow.
  void grow(const Limits& limits) {
    if (!rings_left()) return;
    std::vector<char> ask(rings_.size());
    std::transform(joined_.begin(), joined_.end(), ask.begin(), [](char joined) { return joined ? 0 : 1; });
    std::vector<FacingPlace> places = samples_.facing(ask, component_, limits.farthest * spacing_, progress_);
    std::erase_if(places, [&](const FacingPlace& place) { return place.distance < limits.nearest * spacing_; });
    std::vector<std::vector<Index>> places_of(rings_.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (const Index ring : places[i].ring) places_of[ring].push_back(static_cast<Index>(i));
    }
    std::deque<Index> queue;
    for (Index k = 0; k < static_cast<Index>(rings_.size()); ++k) {
      if (joined_[k] && !places_of[k].empty()) queue.push_back(k);
    }
    while (!queue.empty()) {
      const Index ring = queue.front();
      queue.pop_front();
      for (const Index next : join_neighbours(ring, places, places_of[ring], limits)) queue.push_back(next);
    }
  }

  struct Choice {
    Index other = no_index;
    double cost = 0;
    const FacingPlace* place = nullptr;
  };

  /// Joins to a ring of the tree all those beside it that are in no tree yet; returns them.
  std::vector<Index> join_neighbours(Index ring, const std::vector<FacingPlace>& places,
                                     const std::vector<Index>& places_here, const Limits& limits) {
    std::vector<Choice> choices;
    for (const Index i : places_here) {
      const Index other = places[i].ring[0] == ring ? places[i].ring[1] : places[i].ring[0];
      if (!joined_[other]) choices.push_back({other, cost(places[i], ring), &places[i]});
    }
    std::stable_sort(choices.begin(), choices.end(), [](const Choice& a, const Choice& b) {
      return std::tie(a.other, a.cost) < std::tie(b.other, b.cost);
    });
    std::vector<Index> next;
    for (const Choice& choice : choices) {
      if (joined_[choice.other]) continue;
      progress_.checkpoint();
      auto joint = try_joint(*choice.place, limits);
      if (!joint) continue;
      for (const auto& cut : joint->cuts) joints_of_[cut.ring].push_back(static_cast<Index>(joints_.size()));
      joints_.push_back(*std::move(joint));
      joined_[choice.other] = 1;
      next.push_back(choice.other);
    }
    return next;
  }

  /// Rather where rings are a spacing apart and straight, and then near the joint before, so that joints line up.
  double cost(const FacingPlace& place, Index ring) const {
    double cost = 2 * std::abs(place.distance / spacing_ - 1) + 8 * place.bend;
    if (!joints_of_[ring].empty()) {
      const Vec3 before = middle(joints_[joints_of_[ring].front()]);
      const double away = (rings_[place.ring[0]].position(place.arc[0]) - before).norm() / spacing_;
      cost += 0.05 * std::min(away, 20.0);
    }
    return cost;
  }

  Vec3 middle(const RingJoint& joint) const {
    return 0.25 * (joint.rungs[0].positions.front() + joint.rungs[0].positions.back() +
                   joint.rungs[1].positions.front() + joint.rungs[1].positions.back());
  }

  std::optional<RingJoint> try_joint(const FacingPlace& place, const Limits& limits) const {
    const auto& [a, b] = place.ring;
    const double reach = 0.25 * spacing_;
    const Vec3 from = rings_[a].position(place.arc[0]);
    const std::array<double, 2> centre = {place.arc[0], rings_[b].nearest_arc(from, place.arc[1], reach)};
    const Vec3 to = rings_[b].position(centre[1]);
    const double distance = (to - from).norm();
    RingJoint joint;
    for (int side = 0; side < 2; ++side) {
      const Ring& ring = rings_[place.ring[side]];
      const double half = 0.5 * std::min(std::min(cut_over_spacing * spacing_, most_cut_over_distance * distance),
                                         most_cut_of_ring * ring.length());
      joint.cuts[side] = {place.ring[side], ring.wrapped(centre[side] - half), ring.wrapped(centre[side] + half)};
      if (!is_free(joint.cuts[side], 0.5 * (from + to), centre[side], half, limits)) return std::nullopt;
    }
    if (samples_.other_ring_near(0.5 * (from + to), 0.35 * distance, a, b) && limits.farthest < 2) return std::nullopt;
    if (!add_rungs(joint, limits)) return std::nullopt;
    return joint;
  }

  bool is_free(const RingJoint::Cut& cut, const Vec3& middle_of_joint, double centre, double half,
               const Limits& limits) const {
    const Ring& ring = rings_[cut.ring];
    for (const Index j : joints_of_[cut.ring]) {
      if ((middle(joints_[j]) - middle_of_joint).norm() < limits.separation * spacing_) return false;
      for (const auto& other : joints_[j].cuts) {
        if (other.ring != cut.ring) continue;
        const double other_length = ring.wrapped(other.high - other.low);
        const double apart = ring.wrapped(centre - other.low - 0.5 * other_length);
        if (std::min(apart, ring.length() - apart) < 1.2 * (half + 0.5 * other_length)) return false;
      }
    }
    return true;
  }

  bool add_rungs(RingJoint& joint, const Limits& limits) const {
    const Ring& p = rings_[joint.cuts[0].ring];
    const Ring& q = rings_[joint.cuts[1].ring];
    const std::array<double, 2> from = {joint.cuts[0].low, joint.cuts[0].high};
    const std::array<double, 2> to = {joint.cuts[1].low, joint.cuts[1].high};
    const auto apart = [&](int i, int j) { return (p.position(from[i]) - q.position(to[j])).norm(); };
    joint.crosswise = apart(0, 1) + apart(1, 0) < apart(0, 0) + apart(1, 1);
    for (int i = 0; i < 2; ++i) {
      const int j = joint.crosswise ? 1 - i : i;
      auto rung = rung_between(p.point(from[i]), q.point(to[j]), limits.most_detour * apart(i, j), limits);
      if (!rung) return false;
      joint.rungs[i] = *std::move(rung);
    }
    return true;
  }

  /// Near neighbours have to see each other along a plane section; geodesics are for the last of the rings only.
  std::optional<SurfaceCurve> rung_between(const SurfacePoint& from, const SurfacePoint& to, double longest,
                                           const Limits& limits) const {
    if (limits.farthest > 2) return linker_.link(from, to, longest);
    std::vector<SurfacePoint> walk = surface_walk(mesh_, from, to);
    if (walk.empty()) return std::nullopt;
    SurfaceCurve curve = make_curve(mesh_, std::move(walk));
    if (length_of(curve) > longest + mesh_.tolerance().length) return std::nullopt;
    return curve;
  }

  const SurfaceLinker& linker_;
  const TriangleMesh& mesh_;
  const std::vector<Ring>& rings_;
  double spacing_;
  Progress& progress_;
  RingSamples samples_;
  std::vector<Index> component_;
  std::vector<std::vector<Index>> joints_of_;  // of every ring, the one that joined it to its tree first
  std::vector<char> joined_;
  std::vector<RingJoint> joints_;
};

}  // namespace

std::vector<RingJoint> choose_joints(const SurfaceLinker& linker, const std::vector<Ring>& rings, double spacing,
                                     Progress& progress) {
  return JointChooser(linker, rings, spacing, progress).run();
}

}  // namespace isopath
