#include "isopath/field/virtual_source.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "isopath/core/error.h"
#include "isopath/field/bucket_queue.h"
#include "isopath/field/edge_front.h"
#include "isopath/field/source_faces.h"

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

// What a vertex is up to; one that waits in the queue is not settled.
constexpr std::uint32_t is_settled = 1;   ///< has handed its distance on
constexpr std::uint32_t was_settled = 2;  ///< has done so before, with a longer one

/// An edge whose ends a front has reached: the vertex behind, and the one ahead that it may reach next, in the frame of
/// the edge.
struct Door {
  const Arrival& tail;
  const Arrival& head;
  const Arrival& behind;
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
  if (expected > 0) distance = over_two_edges(door, front, at / ray.y, distance);
  if (!(distance < wanted)) return false;
  const Arrival& nearer = 2 * at < width ? door.tail : door.head;
  arrival = {distance, nearer.bent, nearer.source, 0};
  return true;
}

class Propagation {
 public:
  Propagation(const TriangleMesh& mesh, const FanLayout& fans)
      : mesh_(mesh),
        fans_(fans),
        arrivals_(mesh.n_vertices(), Arrival{}),
        around_(fans.most_spokes()),
        queue_(bucket_step) {}

  void start(const SourceSet& sources);
  void run(Progress& progress);
  std::vector<double> distances() const;

 private:
  void start_at(std::uint32_t vertex, double distance, float bent, std::uint32_t source);
  void start_from(const SourceElement& element, std::uint32_t source, float bent);
  void start_beyond(const SourceElement& element, std::uint32_t source, float bent);
  bool is_corner(const SourceSet& sources, const SourceElement& point) const;
  void settle(std::uint32_t vertex);
  void step_through_faces(const Arrival& here, const FanLayout::Fan& fan);
  void step_through_face(const Arrival& here, const FanLayout::Fan& fan, std::size_t i, bool to_left);
  void hand_over(std::uint32_t vertex, const Arrival& arrival);
  void look_ahead() const;

  const TriangleMesh& mesh_;
  const FanLayout& fans_;
  LargeVector<Arrival> arrivals_;
  std::vector<Arrival> around_;  ///< of the fan at hand
  BucketQueue queue_;
};

[[gnu::always_inline]] inline void Propagation::hand_over(std::uint32_t vertex, const Arrival& arrival) {
  Arrival& held = arrivals_[vertex];
  if (!(arrival.distance < held.distance)) return;  // a vertex may be twice in a fan
  const std::uint32_t revised = (held.state & is_settled) != 0 ? was_settled : 0;
  held = {arrival.distance, arrival.bent, arrival.source, revised | (held.state & was_settled)};
  queue_.push(arrival.distance, vertex);
}

/// Hands the distance of a vertex on to its neighbours: through every edge from it whose other end is settled as well
/// to the third vertex of the face, and along all edges.
void Propagation::settle(std::uint32_t vertex) {
  Arrival& own = arrivals_[vertex];
  if ((own.state & is_settled) != 0) return;
  own.state |= is_settled;
  const FanLayout::Fan fan = fans_.fan(vertex);
  const std::span<const FanSpoke> spokes = fan.spokes;
  const std::size_t n = spokes.size();
  for (std::size_t i = 0; i < n; ++i) around_[i] = arrivals_[spokes[i].end];
  const Arrival here = own;
  step_through_faces(here, fan);

  const float bent = fan.bends ? here.distance : here.bent;
  const std::uint32_t source = fan.bends ? vertex : here.source;
  for (std::size_t i = 0; i < n; ++i) {
    const float distance = here.distance + spokes[i].length;
    if (distance < around_[i].distance * (1 - single_rounding)) hand_over(spokes[i].end, {distance, bent, source, 0});
  }
}

void Propagation::step_through_faces(const Arrival& here, const FanLayout::Fan& fan) {
  const std::size_t n = fan.spokes.size();
  const std::size_t n_faces = fan.closed ? n : std::max<std::size_t>(n, 1) - 1;
  // After a new distance the nearer end of a spoke may have been served through the old one.
  const bool both_ways = (here.state & was_settled) != 0;
  for (std::size_t i = 0; i < n_faces; ++i) {
    const bool to_left = around_[i].distance <= around_[i + 1 == n ? 0 : i + 1].distance;
    step_through_face(here, fan, i, to_left);
    if (both_ways) step_through_face(here, fan, i, !to_left);
  }
}

/// In the face between spokes i and i + 1, through one of them to the end of the other.
[[gnu::always_inline]] inline void Propagation::step_through_face(const Arrival& here, const FanLayout::Fan& fan,
                                                                  std::size_t i, bool to_left) {
  const std::span<const FanSpoke> spokes = fan.spokes;
  const std::size_t n = spokes.size();
  const std::size_t j = i + 1 == n ? 0 : i + 1;
  const std::size_t side = to_left ? i : j;  // through the spoke to this one
  const std::size_t ahead = to_left ? j : i;
  if ((around_[side].state & is_settled) == 0) return;
  if (!(around_[ahead].distance > std::min(around_[side].distance, here.distance))) return;
  if (!fan.closed && side == (to_left ? 0 : n - 1)) return;  // nothing comes through a boundary edge
  const std::size_t behind = to_left ? (i == 0 ? n : i) - 1 : (j + 1 == n ? 0 : j + 1);
  const FanSpoke& face = spokes[i];
  const FanSpoke& back = spokes[to_left ? behind : j];
  const float front_length = spokes[ahead].length;
  const float back_length = spokes[behind].length;
  const Door door{here,
                  around_[side],
                  around_[behind],
                  spokes[side].length,
                  {back_length * back.cosine, -back_length * back.sine},
                  {front_length * face.cosine, front_length * face.sine}};
  Arrival arrival;
  if (!step_through(door, around_[ahead].distance, arrival)) return;
  around_[ahead] = arrival;
  hand_over(spokes[ahead].end, arrival);
}

void Propagation::start_at(std::uint32_t vertex, double distance, float bent, std::uint32_t source) {
  const auto scaled = static_cast<float>(distance / fans_.unit());
  if (scaled < arrivals_[vertex].distance * (1 - single_rounding)) hand_over(vertex, {scaled, bent, source, 0});
}

/// To the corners of the faces that hold an element; of a segment, to those beside it.
void Propagation::start_from(const SourceElement& element, std::uint32_t source, float bent) {
  const Vec3 a = position_of(mesh_, element.a);
  const Vec3 along = position_of(mesh_, element.b) - a;
  for (const Index face : faces_of(mesh_, element)) {
    for (const Index vertex : mesh_.triangle(face)) {
      const Vec3& p = mesh_.position(vertex);
      if (element.kind == SourceElement::Kind::segment) {
        const double at = (p - a).dot(along);
        if (!(at >= 0 && at <= along.squaredNorm())) continue;
      }
      start_at(static_cast<std::uint32_t>(vertex), distance_in_face(mesh_, element, p), bent, source);
    }
  }
}

/// From a segment to the corners beyond the edges of its faces, exactly: so near to it, edges are too long for a front
/// to be told from the distances at their ends.
void Propagation::start_beyond(const SourceElement& element, std::uint32_t source, float bent) {
  const Vec3 ends[] = {position_of(mesh_, element.a), position_of(mesh_, element.b)};
  for (const Index face : faces_of(mesh_, element)) {
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      const Index twin = mesh_.twin(h);
      const Vec3& tail = mesh_.position(mesh_.from(h));
      const Vec3 edge = mesh_.position(mesh_.to(h)) - tail;
      const double length = edge.norm();
      if (twin == no_index || !(length > 0)) continue;
      // in the frame of the edge, the element's face above and the other below it
      const auto unfold = [&](const Vec3& p, double side) {
        const double x = (p - tail).dot(edge) / length;
        return Vec2(x, side * (p - tail - x / length * edge).norm());
      };
      const Index corner = mesh_.from(TriangleMesh::prev(twin));
      const Vec2 to = unfold(mesh_.position(corner), -1);
      const Vec2 start = unfold(ends[0], 1);
      const Vec2 along = unfold(ends[1], 1) - start;
      const double squared = along.squaredNorm();
      const double at = squared > 0 ? std::clamp((to - start).dot(along) / squared, 0.0, 1.0) : 0;
      const Vec2 way = to - start - at * along;
      const double crossing = to.x() * way.y() - to.y() * way.x();  // times way.y, below zero
      if (crossing > 0 || crossing < length * way.y()) continue;
      start_at(static_cast<std::uint32_t>(corner), way.norm(), bent, source);
    }
  }
}

/// Whether the front around a point of a source is a circle: at single points, ends and corners, not where two segments
/// go on into each other.
bool Propagation::is_corner(const SourceSet& sources, const SourceElement& point) const {
  if (point.segment_before == no_index || point.segment_after == no_index) return true;
  const Support support = support_of(mesh_, point.a);
  if (support.kind == Support::Kind::vertex && mesh_.is_boundary_vertex(support.index)) {
    return fans_.bends(static_cast<std::uint32_t>(support.index));
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
  // Segments first: where the end of one is as near, the front is straight.
  for (std::uint32_t k = 0; k < elements.size(); ++k) {
    if (elements[k].kind != SourceElement::Kind::segment) continue;
    start_from(elements[k], n_vertices + k, no_centre);
    start_beyond(elements[k], n_vertices + k, no_centre);
  }
  for (std::uint32_t k = 0; k < elements.size(); ++k) {
    const SourceElement& point = elements[k];
    if (point.kind != SourceElement::Kind::point) continue;
    const Support support = support_of(mesh_, point.a);
    const bool at_vertex = support.kind == Support::Kind::vertex;
    const std::uint32_t source = at_vertex ? static_cast<std::uint32_t>(support.index) : n_vertices + k;
    const float bent = is_corner(sources, point) ? 0 : no_centre;
    if (at_vertex) start_at(source, 0, bent, source);
    start_from(point, source, bent);
    start_beyond(point, source, bent);
  }
}

/// Most of the time would go into waiting for memory: fetches what items further back in the queue are about to read.
void Propagation::look_ahead() const {
  fans_.prefetch_head(queue_.ahead(12));
  const std::uint32_t near = queue_.ahead(6);
  __builtin_prefetch(&arrivals_[near], 1);
  fans_.prefetch(near);
}

void Propagation::run(Progress& progress) {
  std::size_t n_settled = 0;
  while (!queue_.empty()) {
    const std::uint32_t vertex = queue_.pop();
    look_ahead();
    if (++n_settled % 65536 == 0) {
      progress.checkpoint();
      progress.at(std::min(1.0, static_cast<double>(n_settled) / (2.0 * static_cast<double>(arrivals_.size()))));
    }
    settle(vertex);
  }
}

std::vector<double> Propagation::distances() const {
  std::vector<double> result(arrivals_.size());
  for (std::size_t v = 0; v < result.size(); ++v) result[v] = arrivals_[v].distance * fans_.unit();
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
