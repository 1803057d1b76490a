#include "isopath/impact/ring_joints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <tuple>
#include <utility>

#include "isopath/impact/ring_neighbours.h"
#include "isopath/impact/ring_row.h"

namespace isopath {
namespace {

/// Rings at the top of the function are half a spacing from the next one; where they are nearer still, or where a
/// metric makes them so, cuts are shorter too.
constexpr double most_cut_over_distance = 2 * cut_over_spacing;
constexpr double most_cut_of_ring = 0.2;

/// Rings of a row lie between so many spacings apart, run so straight, and the way from ring to ring hardly turns.
constexpr double nearest_in_row = 0.85;
constexpr double farthest_in_row = 1.15;
constexpr double most_bend_in_row = 0.06;
constexpr double least_cosine_in_row = 0.85;
/// Rows of two are nothing but single joints.
constexpr std::size_t shortest_row = 3;
/// Rows keep so many spacings away from other joints.
constexpr double row_separation = 2;

/// What a joint of two has to keep; one set of limits after the other is tried on the rings that are left.
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
        taken_(rings.size()),
        joined_(rings.size(), 0) {
    for (const Ring& ring : rings) component_.push_back(mesh_.component_of(ring.face()));
  }

  std::vector<RingJoint> run() {
    start_trees();
    add_rows();
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

  /// From every ring of a tree, breadth first, the longest rows of rings that are in no tree yet.
  void add_rows() {
    const std::vector<FacingPlace> places =
        samples_.facing(std::vector<char>(rings_.size(), 1), component_, farthest_in_row * spacing_, progress_);
    std::vector<std::size_t> first(rings_.size() + 1, 0);  // places come ring by ring, by ascending arc
    for (const FacingPlace& place : places) ++first[place.ring[0] + 1];
    for (std::size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
    std::deque<Index> queue;
    for (Index k = 0; k < static_cast<Index>(rings_.size()); ++k) {
      if (joined_[k]) queue.push_back(k);
    }
    while (!queue.empty()) {
      const Index ring = queue.front();
      queue.pop_front();
      while (auto joint = longest_row(ring, places, first)) {
        for (std::size_t k = 1; k < joint->cuts.size(); ++k) queue.push_back(joint->cuts[k].ring);
        add(*std::move(joint));
      }
    }
  }

  struct Row {
    std::vector<RingPlace> places;
    double cost = 0;
    bool better_than(const Row& other) const {
      return places.size() != other.places.size() ? places.size() > other.places.size() : cost < other.cost;
    }
  };

  std::optional<RingJoint> longest_row(Index ring, const std::vector<FacingPlace>& places,
                                       const std::vector<std::size_t>& first) {
    std::vector<Row> rows;
    double last_arc = -1;
    for (std::size_t i = first[ring]; i < first[ring + 1]; ++i) {
      progress_.checkpoint();
      if (std::exchange(last_arc, places[i].arc[0]) == places[i].arc[0]) continue;
      Row row = row_from({ring, places[i].arc[0]}, places, first);
      if (row.places.size() >= shortest_row) rows.push_back(std::move(row));
    }
    std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.better_than(b); });
    for (const Row& row : rows) {
      if (auto joint = joint_of_row(mesh_, rings_, row.places, spacing_)) return joint;
    }
    return std::nullopt;
  }

  /// From ring to ring, on as long as there is one that faces the last one.
  Row row_from(const RingPlace& start, const std::vector<FacingPlace>& places,
               const std::vector<std::size_t>& first) const {
    Row row{{start}, 0};
    if (!is_apart(position_of(start), start.ring)) return row;
    Vec3 along = Vec3::Zero();
    while (const FacingPlace* next = next_in_row(row, along, places, first)) {
      const RingPlace& here = row.places.back();
      const Vec3 from = position_of(here);
      const Index ring = next->ring[1];
      const RingPlace there{ring, rings_[ring].nearest_arc(from, next->arc[1], 0.25 * spacing_)};
      if (!is_apart(position_of(there), ring)) break;
      along = (position_of(there) - from).normalized();
      row.cost += 2 * std::abs(next->distance / spacing_ - 1) + 8 * next->bend;
      row.places.push_back(there);
    }
    return row;
  }

  Vec3 position_of(const RingPlace& place) const { return rings_[place.ring].position(place.arc); }

  const FacingPlace* next_in_row(const Row& row, const Vec3& along, const std::vector<FacingPlace>& places,
                                 const std::vector<std::size_t>& first) const {
    const RingPlace& here = row.places.back();
    const double reach = 0.14 * spacing_;  // samples are a quarter of a spacing apart
    const auto begin = places.begin() + static_cast<std::ptrdiff_t>(first[here.ring]);
    const auto end = places.begin() + static_cast<std::ptrdiff_t>(first[here.ring + 1]);
    const FacingPlace* best = nullptr;
    for (auto p = std::lower_bound(begin, end, here.arc - reach,
                                   [](const FacingPlace&place, double arc) { return place.arc[0] < arc; });
         p != end && p->arc[0] <= here.arc + reach; ++p) {
      const Index ring = p->ring[1];
      if (joined_[ring] || p->distance < nearest_in_row * spacing_ || p->bend > most_bend_in_row) continue;
      if (std::any_of(row.places.begin(), row.places.end(), [&](const RingPlace& r) { return r.ring == ring; }))
        continue;
      const Vec3 way = rings_[ring].position(p->arc[1]) - rings_[here.ring].position(p->arc[0]);
      if (!along.isZero() && along.dot(way) < least_cosine_in_row * way.norm()) continue;
      if (!best || std::abs(p->distance - spacing_) < std::abs(best->distance - spacing_)) best = &*p;
    }
    return best;
  }

  /// Whether a place on a ring is far enough from the joints the ring has.
  bool is_apart(const Vec3& place, Index ring) const {
    return std::none_of(taken_[ring].begin(), taken_[ring].end(),
                        [&](const Taken& taken) { return (taken.middle - place).norm() < row_separation * spacing_; });
  }

  void add(RingJoint joint) {
    for (const RingJoint::Cut& cut : joint.cuts) {
      joined_[cut.ring] = 1;
      Vec3 middle = middle_of(cut);
      // that of two rings lies between them
      if (joint.cuts.size() == 2) middle = 0.5 * (middle_of(joint.cuts[0]) + middle_of(joint.cuts[1]));
      taken_[cut.ring].push_back({cut, middle});
    }
    joints_.push_back(std::move(joint));
  }

  Vec3 middle_of(const RingJoint::Cut& cut) const {
    return 0.5 * (rings_[cut.ring].position(cut.low) + rings_[cut.ring].position(cut.high));
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
      add(*std::move(joint));
      next.push_back(choice.other);
    }
    return next;
  }

  /// Rather where rings are a spacing apart and straight, and then near the joint before, so that joints line up.
  double cost(const FacingPlace& place, Index ring) const {
    double cost = 2 * std::abs(place.distance / spacing_ - 1) + 8 * place.bend;
    if (!taken_[ring].empty()) {
      const Vec3 before = taken_[ring].front().middle;
      const double away = (rings_[place.ring[0]].position(place.arc[0]) - before).norm() / spacing_;
      cost += 0.05 * std::min(away, 20.0);
    }
    return cost;
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
      joint.cuts.push_back({place.ring[side], ring.wrapped(centre[side] - half), ring.wrapped(centre[side] + half)});
      if (!is_free(joint.cuts[side], 0.5 * (from + to), centre[side], half, limits)) return std::nullopt;
    }
    if (samples_.other_ring_near(0.5 * (from + to), 0.35 * distance, a, b) && limits.farthest < 2) return std::nullopt;
    if (!add_rungs(joint, limits)) return std::nullopt;
    return joint;
  }

  bool is_free(const RingJoint::Cut& cut, const Vec3& middle_of_joint, double centre, double half,
               const Limits& limits) const {
    const Ring& ring = rings_[cut.ring];
    for (const Taken& taken : taken_[cut.ring]) {
      if ((taken.middle - middle_of_joint).norm() < limits.separation * spacing_) return false;
      const double other_length = ring.wrapped(taken.cut.high - taken.cut.low);
      const double apart = ring.wrapped(centre - taken.cut.low - 0.5 * other_length);
      if (std::min(apart, ring.length() - apart) < 1.2 * (half + 0.5 * other_length)) return false;
    }
    return true;
  }

  bool add_rungs(RingJoint& joint, const Limits& limits) const {
    const Ring& p = rings_[joint.cuts[0].ring];
    const Ring& q = rings_[joint.cuts[1].ring];
    const std::array<double, 2> from = {joint.cuts[0].low, joint.cuts[0].high};
    const std::array<double, 2> to = {joint.cuts[1].low, joint.cuts[1].high};
    const auto apart = [&](int i, int j) { return (p.position(from[i]) - q.position(to[j])).norm(); };
    const bool crosswise = apart(0, 1) + apart(1, 0) < apart(0, 0) + apart(1, 1);
    for (int i = 0; i < 2; ++i) {
      const int j = crosswise ? 1 - i : i;
      auto rung = rung_between(p.point(from[i]), q.point(to[j]), limits);
      if (!rung) return false;
      joint.rungs.push_back({{0, i == 1}, {1, j == 1}, *std::move(rung)});
    }
    return true;
  }

  /// Near neighbours have to see each other along a plane section; geodesics are for the last of the rings only.
  std::optional<SurfaceCurve> rung_between(const SurfacePoint& from, const SurfacePoint& to,
                                           const Limits& limits) const {
    if (limits.farthest <= 2) return straight_rung(mesh_, from, to, limits.most_detour);
    const double straight = (isopath::position_of(mesh_, from) - isopath::position_of(mesh_, to)).norm();
    return linker_.link(from, to, limits.most_detour * straight);
  }

  /// A cut that a ring has, and where its joint is.
  struct Taken {
    RingJoint::Cut cut;
    Vec3 middle = Vec3::Zero();
  };

  const SurfaceLinker& linker_;
  const TriangleMesh& mesh_;
  const std::vector<Ring>& rings_;
  double spacing_;
  Progress& progress_;
  RingSamples samples_;
  std::vector<Index> component_;
  std::vector<std::vector<Taken>> taken_;  // of every ring, the one that joined it to its tree first
  std::vector<char> joined_;
  std::vector<RingJoint> joints_;
};

}  // namespace

std::vector<RingJoint> choose_joints(const SurfaceLinker& linker, const std::vector<Ring>& rings, double spacing,
                                     Progress& progress) {
  return JointChooser(linker, rings, spacing, progress).run();
}

}  // namespace isopath
