#include "isopath/field/virtual_source.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/bucket_queue.h"
#include "isopath/field/edge_front.h"
#include "isopath/field/four_lanes.h"
#include "isopath/field/straight_ways.h"

namespace isopath {
namespace {

/// Single precision: a shorter way by less than this share is no improvement.
constexpr float single_rounding = 3e-7F;
/// A ray that misses an end of an edge by less than this share of its length passes it.
constexpr float grazing = 1e-4F;
/// Where the vertex behind an edge is farther than the front through the edge would have it, by more than this share of
/// its height over the edge, the ends of the edge belong to two fronts that met, and nothing goes through between them.
constexpr float met = 0.2F;
/// Width of a bucket of the queue in units of the layout.
constexpr float bucket_step = 1;

/// Faces that straight ways from a vertex with a sharp bend may cross, and ways from an element of a source: enough for
/// a radius of four and of nine edges. Of long sources each element gets its share.
constexpr std::size_t most_faces_at_bend = 64;
constexpr std::size_t most_faces_at_element = 256;
constexpr std::size_t least_faces_at_element = 16;
/// All of that together: this many faces, about a millisecond, and one more for every second vertex.
constexpr std::size_t faces_at_least = 32768;
/// A front would be at a vertex later than another one was by this share of the edge between: the two met on it.
constexpr float overtaken = 0.01F;

// Marks of a vertex, below its root; one that waits in the queue is not settled.
constexpr std::uint32_t is_settled = 1;   ///< has handed its distance on
constexpr std::uint32_t was_settled = 2;  ///< has done so before, with a longer one
constexpr std::uint32_t is_seen = 4;      ///< a straight way from a source came
constexpr std::uint32_t marks = 7;

/// Fronts of one polyline or point, or from one sharp bend, have one root.
constexpr std::uint32_t root_of(std::uint32_t number) { return number * (marks + 1); }

/// An edge whose ends a front has reached: the vertex behind, and the one ahead that it may reach next, in the frame of
/// the edge.
struct Door {
  const Arrival& tail;
  const Arrival& head;
  const Arrival& behind;
  std::uint32_t corner;  ///< number of the vertex behind
  float length;
  FlatPoint back;   ///< where the vertex behind is, y < 0
  FlatPoint front;  ///< where the vertex ahead is, y > 0
};

/// The same step with the edge crossed before, from the vertex behind to an end: a front that is fitted anew at every
/// edge gathers errors at each, and this way skips every other. `distance` where the ray does not come that way.
float over_two_edges(const Door& door, const EdgeFront& direct, float crossing, float distance) {
  const FlatPoint ray{crossing - door.front.x, -door.front.y};
  const bool by_head = cross(ray, door.back - door.front) < 0;  // the vertex behind is on the tail's side of the ray
  const FlatPoint start = by_head ? door.back : FlatPoint{0, 0};
  const FlatPoint end = by_head ? FlatPoint{door.length, 0} : door.back;
  const FlatPoint along = end - start;
  if (!direct.straight && cross(along, direct.at - start) >= 0) return distance;  // it starts between the edges
  const float length = norm(along);
  const EdgeFront front = fit_front(by_head ? door.behind : door.tail, by_head ? door.head : door.behind, length);
  const float inverse = 1 / length;
  const FlatPoint seen = door.front - start;
  const FlatPoint ahead{inverse * dot(along, seen), inverse * cross(along, seen)};
  const FlatPoint way = front.ray_to(ahead);
  const float at = cross(ahead, way);
  return at >= 0 && at <= length * way.y ? front.distance_of(ahead, way) : distance;
}

/// Where a front on its own is at two points.
struct Alone {
  float at_end;
  float ahead;
};

/// Straight from the vertex behind, to an end of the edge and to the vertex ahead.
Alone from_behind(const Door& door, bool to_head) {
  const FlatPoint end{to_head ? door.length : 0, 0};
  return {door.behind.distance + norm(end - door.back), door.behind.distance + norm(door.front - door.back)};
}

/// Through the edge from the vertex behind to the one end, to the other end and to the vertex ahead.
Alone through_edge_behind(const Door& door, bool to_head) {
  const FlatPoint start = to_head ? FlatPoint{0, 0} : door.back;
  const FlatPoint end = to_head ? door.back : FlatPoint{door.length, 0};
  const FlatPoint along = end - start;
  const float length = norm(along);
  const float inverse = 1 / length;
  const EdgeFront front =
      to_head ? fit_front(door.tail, door.behind, length) : fit_front(door.behind, door.head, length);
  const auto reach = [&](FlatPoint point) {
    const FlatPoint seen = point - start;
    const FlatPoint ahead{inverse * dot(along, seen), inverse * cross(along, seen)};
    return front.distance_of(ahead, front.ray_to(ahead));
  };
  return {reach({to_head ? door.length : 0, 0}), reach(door.front)};
}

/// Fronts of two roots came to the ends of an edge. Where they met on it, no circle fits both, and one that is fitted
/// nevertheless arrives too early: then the one of them that came by the vertex behind counts, on its own. False where
/// they did not meet there.
bool fronts_met(const Door& door, float& distance) {
  const bool circle_to_head = door.tail.source == door.corner;
  const bool circle = circle_to_head || door.head.source == door.corner;
  const bool by_tail = door.behind.source == door.tail.source;
  if (!circle && by_tail == (door.behind.source == door.head.source)) return false;
  const bool to_head = circle ? circle_to_head : by_tail;
  const Alone alone = circle ? from_behind(door, to_head) : through_edge_behind(door, to_head);
  if (!((to_head ? door.head : door.tail).distance < alone.at_end - overtaken * door.length)) return false;
  distance = std::max(distance, alone.ahead);
  return true;
}

/// Takes the front through an edge to the vertex ahead; false where that is no nearer than `known`.
[[gnu::always_inline]] inline bool step_through(const Door& door, float known, Arrival& arrival) {
  const EdgeFront front = fit_front(door.tail, door.head, door.length);
  const FlatPoint ray = front.ray_to(door.front);
  const float at = cross(door.front, ray);  // times ray.y: where the ray crosses the edge
  const float width = door.length * ray.y;
  const float slack = grazing * width;
  const float wanted = known * (1 - single_rounding);
  if (!(at >= -slack && at <= width + slack)) return false;
  float distance = front.distance_of(door.front, ray);
  if (!(distance < wanted)) return false;
  const float expected = front.distance_of(door.back, front.ray_to(door.back));
  if (!(door.behind.distance <= expected - met * door.back.y)) return false;
  const bool two_roots = (door.tail.root ^ door.head.root) > marks;
  if (!(two_roots && fronts_met(door, distance)) && expected > 0) {
    distance = over_two_edges(door, front, at / ray.y, distance);
  }
  if (!(distance < wanted)) return false;
  // of two roots, the flatter front is the cautious choice
  const bool tail_counts =
      two_roots && door.tail.bent != door.head.bent ? door.tail.bent < door.head.bent : 2 * at < width;
  const Arrival& origin = tail_counts ? door.tail : door.head;
  arrival = {std::max(distance, 0.0F), origin.bent, origin.source, origin.root & ~marks};
  return true;
}

/// Which of four faces beside each other may take the front on: `step_through` with all that costs little, of which
/// most faces bring nothing. The nearer end of two spokes is the one to step through. What to do next waits for this
/// answer, so the way to it is kept short: no division by what is not known early, and squares compared, not roots.
[[gnu::always_inline]] inline std::uint32_t steps_from(const Arrival& here, const Fan& fan, std::size_t i,
                                                       const Arrival* around) {
  const FourRecords left = records(around);
  const FourRecords right = records(around + 1);
  const Floats left_length = words_at(fan.length + i);
  const Floats right_length = words_at(fan.next_length + i);
  const Ints to_left = left.first <= right.first;
  const Floats nearer = select(to_left, left.first, right.first);
  const Floats farther = select(to_left, right.first, left.first);
  const Ints root = Ints(select(to_left, left.fourth, right.fourth));
  const Ints served = (root & Ints{is_settled, is_settled, is_settled, is_settled}) != 0;
  const Ints worth = served & (farther > min(nearer, all(here.distance)));
  if (bits(worth) == 0) return 0;

  const Floats length = select(to_left, left_length, right_length);
  const Floats front_length = select(to_left, right_length, left_length);
  const Floats front_x = front_length * words_at(fan.cosine + i);
  const Floats front_y = front_length * words_at(fan.sine + i);
  const Floats other_bent = select(to_left, left.second, right.second);
  const Ints source = Ints(select(to_left, left.third, right.third));
  const auto own_source = static_cast<std::int32_t>(here.source);
  const Floats bent = min(other_bent, all(here.bent));
  const Ints two_roots = (source != Ints{own_source, own_source, own_source, own_source}) & (bent == 0) &
                         (max(other_bent, all(here.bent)) == 0) & (nearer > 0) & (all(here.distance) > 0);
  const Ints straight = (bent == all(no_centre)) | two_roots;

  const Floats to_tail = all(here.distance) - bent;
  const Floats to_head = nearer - bent;
  const Floats x = 0.5F * ((to_tail - to_head) * (to_tail + to_head) * (1 / length) + length);
  const Floats y = square_root((to_tail - x) * (to_tail + x));  // where there is no circle, nothing compares to it
  Floats ray_x = front_x - x;
  Floats ray_y = front_y + y;
  const Floats wanted = farther * all(1 - single_rounding);
  const Floats wanted_radius = wanted - bent;
  Ints nearer_by_front = ray_x * ray_x + ray_y * ray_y < wanted_radius * wanted_radius;
  if (bits(straight) != 0) {
    const Floats slope = (nearer - all(here.distance)) / length;
    const Floats rise = square_root(1 - slope * slope);
    ray_x = select(straight, slope, ray_x);
    ray_y = select(straight, rise, ray_y);
    const Ints nearer_straight = all(here.distance) + (slope * front_x + rise * front_y) < wanted;
    nearer_by_front = (straight & nearer_straight) | (~straight & nearer_by_front);
  }
  const Floats at = front_x * ray_y - front_y * ray_x;
  const Floats width = length * ray_y;
  const Floats slack = grazing * width;
  return bits(worth & (at >= -slack) & (at <= width + slack) & nearer_by_front);
}

/// Calls `visit` for those of n items that `chosen` names, which looks at four at a time, in order.
template <typename Chosen, typename Visit>
[[gnu::always_inline]] inline void for_each_of_four(std::size_t n, const Chosen& chosen, const Visit& visit) {
  constexpr std::size_t most = 32;
  std::size_t first = 0;
  do {
    const std::size_t end = std::min(n - first, most);
    std::uint64_t mask = 0;
    for (std::size_t i = 0; i < end; i += 4) mask |= std::uint64_t{chosen(first + i)} << i;
    mask &= (std::uint64_t{1} << end) - 1;
    for (; mask != 0; mask &= mask - 1) visit(first + static_cast<std::size_t>(std::countr_zero(mask)));
    first += most;
  } while (first < n);
}

class Propagation {
 public:
  Propagation(const TriangleMesh& mesh, const FanLayout& fans)
      : mesh_(mesh),
        fans_(fans),
        arrivals_(mesh.n_vertices(), Arrival{}),
        at_hand_(fans),
        around_(fans.most_spokes() + 6),
        queue_(bucket_step),
        ways_(mesh) {}

  void start(const SourceSet& sources);
  void run(Progress& progress);
  std::vector<double> distances() const;

 private:
  void start_at(std::uint32_t vertex, double distance, Arrival arrival);
  void start_ways(std::span<const StraightWays::Way> ways, double before, const Arrival& arrival);
  void start_from(const SourceSet& sources, std::uint32_t k, std::size_t most_faces);
  bool is_corner(const SourceSet& sources, const SourceElement& point);
  void settle(std::uint32_t vertex, const Fan& fan);
  void take_batch();
  void walk_along_edges(const Arrival& here, std::uint32_t vertex, const Fan& fan);
  void step_through_face(const Arrival& here, const Fan& fan, std::size_t i, bool to_left);
  void hand_over(std::uint32_t vertex, const Arrival& arrival);

  const TriangleMesh& mesh_;
  const FanLayout& fans_;
  LargeVector<Arrival> arrivals_;
  FanBatch at_hand_;
  std::array<std::uint32_t, FanBatch::most_fans> taken_{};  ///< whose fans they are
  std::size_t n_taken_ = 0;
  std::vector<Arrival> around_;  ///< the fan at hand, from the spoke before the first one to the one after the last
  BucketQueue queue_;
  StraightWays ways_;
  std::uint32_t n_chains_ = 0;  ///< of the sources: points, polylines and loops
};

[[gnu::always_inline]] inline void Propagation::hand_over(std::uint32_t vertex, const Arrival& arrival) {
  Arrival& held = arrivals_[vertex];
  if (!(arrival.distance < held.distance)) return;  // a vertex may be twice in a fan
  std::uint32_t before = held.root & was_settled;
  if ((held.root & is_settled) != 0) before = was_settled;
  const bool waits = held.distance < std::numeric_limits<float>::infinity() && (held.root & is_settled) == 0 &&
                     queue_.same_bucket(arrival.distance, held.distance);
  put_words(words_of(Arrival{arrival.distance, arrival.bent, arrival.source, arrival.root | before}), &held);
  if (!waits) queue_.push(arrival.distance, vertex);
}

/// Hands the distance of a vertex on to its neighbours: through every edge from it whose other end is settled as well
/// to the third vertex of the face, and along all edges.
void Propagation::settle(std::uint32_t vertex, const Fan& fan) {
  Arrival& own = arrivals_[vertex];
  if ((own.root & is_settled) != 0) return;
  const Arrival here{own.distance, own.bent, own.source, own.root | is_settled};
  own.root = here.root;
  const std::size_t n = fan.n_spokes;
  if (n == 0) return;
  Arrival* const around = around_.data() + 1;
  const Arrival* const known = arrivals_.data();
  for (std::size_t i = 0; i < n; i += 4) {
    for (std::size_t k = i; k < i + 4; ++k) put_words(words_of(known[fan.ends[k]]), around + k);
  }
  around[-1] = fan.closed ? around[n - 2] : Arrival{};
  around[n] = fan.closed ? around[1] : Arrival{};

  // After a new distance the nearer end of a spoke may have been served through the old one.
  if ((here.root & was_settled) != 0) {
    for (std::size_t i = 0; i + 1 < n; ++i) {
      step_through_face(here, fan, i, true);
      step_through_face(here, fan, i, false);
    }
  } else {
    for_each_of_four(
        n - 1, [&](std::size_t i) { return steps_from(here, fan, i, around + i); },
        [&](std::size_t i) { step_through_face(here, fan, i, around[i].distance <= around[i + 1].distance); });
  }
  walk_along_edges(here, vertex, fan);
}

void Propagation::walk_along_edges(const Arrival& here, std::uint32_t vertex, const Fan& fan) {
  Arrival along{0, here.bent, here.source, here.root & ~marks};
  if (fan.bends) along = {0, here.distance, vertex, along.root};
  if (fan.bends_sharply) {
    along.root = root_of(n_chains_ + vertex);
    start_ways(ways_.from_vertex(static_cast<Index>(vertex), most_faces_at_bend), here.distance * fans_.unit(), along);
  }
  const Arrival* const around = around_.data() + 1;
  for_each_of_four(
      fan.n_spokes,
      [&](std::size_t i) {
        const Floats distance = all(here.distance) + words_at(fan.length + i);
        return bits(distance < records(around + i).first * all(1 - single_rounding));
      },
      [&](std::size_t i) {
        along.distance = here.distance + fan.length[i];
        hand_over(fan.ends[i], along);
      });
}

/// In the face between spokes i and i + 1, through one of them to the end of the other.
[[gnu::always_inline]] inline void Propagation::step_through_face(const Arrival& here, const Fan& fan, std::size_t i,
                                                                  bool to_left) {
  Arrival* const around = around_.data() + 1;
  const std::size_t n_faces = fan.n_spokes - 1;
  const std::size_t side = to_left ? i : i + 1;  // through the spoke to this one
  const std::size_t ahead = to_left ? i + 1 : i;
  if ((around[side].root & is_settled) == 0) return;
  if (!(around[ahead].distance > std::min(around[side].distance, here.distance))) return;
  // in sight of the sources, what a front of two of them would bring is less sure than what is there
  if ((around[ahead].root & is_seen) != 0 && here.source != around[side].source) return;
  if (!fan.closed && side == (to_left ? 0 : n_faces)) return;  // nothing comes through a boundary edge
  std::size_t behind = to_left ? i - 1 : i + 2;
  if (to_left && i == 0) behind = n_faces - 1;
  if (!to_left && i + 1 == n_faces) behind = 1;
  const std::size_t back = to_left ? behind : i + 1;  // the face behind
  const float front_length = fan.length[ahead];
  const float back_length = fan.length[behind];
  const Door door{here,
                  around[side],
                  around[behind],
                  fan.ends[behind],
                  fan.length[side],
                  {back_length * fan.cosine[back], -back_length * fan.sine[back]},
                  {front_length * fan.cosine[i], front_length * fan.sine[i]}};
  Arrival arrival;
  if (!step_through(door, around[ahead].distance, arrival)) return;
  put_words(words_of(arrival), around + ahead);
  if (fan.closed && ahead == 0) around[n_faces] = arrival;
  if (fan.closed && ahead == n_faces) around[0] = arrival;
  hand_over(fan.ends[ahead], arrival);
}

/// Arrives at a vertex after so many mm.
void Propagation::start_at(std::uint32_t vertex, double distance, Arrival arrival) {
  arrival.distance = static_cast<float>(distance / fans_.unit());
  if (arrival.distance < arrivals_[vertex].distance * (1 - single_rounding)) hand_over(vertex, arrival);
}

void Propagation::start_ways(std::span<const StraightWays::Way> ways, double before, const Arrival& arrival) {
  for (const StraightWays::Way& way : ways)
    start_at(fans_.vertex_here(static_cast<Index>(way.to)), before + way.length, arrival);
}

/// Whether the front around a point of a source is a circle: at single points, ends and corners, not where two segments
/// go on into each other.
bool Propagation::is_corner(const SourceSet& sources, const SourceElement& point) {
  if (point.segment_before == no_index || point.segment_after == no_index) return true;
  const Support support = support_of(mesh_, point.a);
  if (support.kind == Support::Kind::vertex && mesh_.is_boundary_vertex(support.index)) {
    at_hand_.clear();
    at_hand_.add(fans_.vertex_here(support.index), arrivals_.data());
    return at_hand_[0].bends;
  }
  const auto direction = [&](Index k) -> Vec3 {
    const SourceElement& segment = sources.elements()[k];
    return position_of(mesh_, segment.b) - position_of(mesh_, segment.a);
  };
  const Vec3 before = direction(point.segment_before);
  const Vec3 after = direction(point.segment_after);
  return before.cross(after).norm() > 0.03 * before.norm() * after.norm() || before.dot(after) < 0;
}

void Propagation::start(const SourceSet& sources) {
  const auto n_vertices = static_cast<std::uint32_t>(mesh_.n_vertices());
  const std::span<const SourceElement> elements = sources.elements();
  const auto n_elements = static_cast<std::uint32_t>(elements.size());
  const std::size_t most_faces =
      std::clamp((n_vertices / 2 + faces_at_least) / n_elements, least_faces_at_element, most_faces_at_element);
  // Segments first: where the end of one is as near, the front is straight.
  for (const auto kind : {SourceElement::Kind::segment, SourceElement::Kind::point}) {
    n_chains_ = 0;
    for (std::uint32_t k = 0; k < n_elements; ++k) {
      const SourceElement& element = elements[k];
      // a chain is a point, then a segment and a point by turns
      const bool goes_on = k > 0 && (element.kind == SourceElement::Kind::segment ||
                                     element.segment_before == static_cast<Index>(k) - 1);
      if (!goes_on) ++n_chains_;
      if (element.kind == kind) start_from(sources, k, most_faces);
    }
  }
}

void Propagation::start_from(const SourceSet& sources, std::uint32_t k, std::size_t most_faces) {
  const SourceElement& element = sources.elements()[k];
  const bool is_point = element.kind == SourceElement::Kind::point;
  const bool is_circle = is_point && is_corner(sources, element);
  const Support support = is_point ? support_of(mesh_, element.a) : Support{};
  const bool at_vertex = is_point && support.kind == Support::Kind::vertex;
  Arrival arrival{0, is_circle ? 0 : no_centre, static_cast<std::uint32_t>(mesh_.n_vertices()) + k,
                  root_of(n_chains_) | is_seen};
  if (at_vertex) {
    arrival.source = fans_.vertex_here(support.index);
    start_at(arrival.source, 0, arrival);
    if (is_circle) start_ways(ways_.from_vertex(support.index, most_faces), 0, arrival);
  } else {
    start_ways(ways_.from_element(element, most_faces), 0, arrival);
  }
}

/// Takes the next few items out of the queue and works out their fans, those of vertices that are not settled. Most of
/// the time would go into waiting for memory: fetches what items further back are about to read.
void Propagation::take_batch() {
  n_taken_ = 0;
  at_hand_.clear();
  for (std::size_t left = queue_.n_next(); left > 0 && !at_hand_.full(); --left) {
    fans_.prefetch_head(queue_.ahead(24));
    const std::uint32_t near = queue_.ahead(16);
    __builtin_prefetch(&arrivals_[near], 1);
    fans_.prefetch_ring(near);
    fans_.prefetch_positions(queue_.ahead(8));
    const std::uint32_t vertex = queue_.pop();
    if ((arrivals_[vertex].root & is_settled) != 0) continue;
    taken_[n_taken_++] = vertex;
    at_hand_.add(vertex, arrivals_.data());
  }
}

void Propagation::run(Progress& progress) {
  constexpr std::size_t report_every = 65536;
  std::size_t n_settled = 0;
  while (!queue_.empty()) {
    take_batch();
    for (std::size_t i = 0; i < n_taken_; ++i) settle(taken_[i], at_hand_[i]);
    const std::size_t n_before = n_settled;
    n_settled += n_taken_;
    if (n_before / report_every != n_settled / report_every) {
      progress.checkpoint();
      progress.at(std::min(1.0, static_cast<double>(n_settled) / (2.0 * static_cast<double>(arrivals_.size()))));
    }
  }
}

std::vector<double> Propagation::distances() const {
  std::vector<double> result(arrivals_.size());
  for (Index v = 0; v < mesh_.n_vertices(); ++v) result[v] = arrivals_[fans_.vertex_here(v)].distance * fans_.unit();
  return result;
}

}  // namespace

std::vector<double> VirtualSourceSolver::distances(const SourceSet& sources, Progress& progress) const {
  if (sources.empty()) throw Error(ErrorCode::bad_usage, "the source set is empty", {.advice = "name a source"});
  progress.checkpoint();
  Propagation fronts(mesh_, fans_);
  fronts.start(sources);
  fronts.run(progress);
  return fronts.distances();
}

std::vector<double> virtual_source_distances(const TriangleMesh& mesh, const SourceSet& sources, Progress& progress) {
  return VirtualSourceSolver(mesh).distances(sources, progress);
}

}  // namespace isopath
