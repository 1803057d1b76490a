#include "isopath/field/list_propagation.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>

#include "isopath/field/bucket_queue.h"
#include "isopath/field/prefetch.h"

namespace isopath {
namespace {

/// Directions that are known less well than this leave slits beside the vertices that rays pass, wide enough to matter.
constexpr double widest_slit = 1e-9;
/// Rises less than any direction is known to.
constexpr double least_slope = 1e-20;
/// In mean lengths of half-edges: narrower buckets make shorter lists, wider ones send windows ahead that are beaten
/// later.
constexpr double bucket_width = 0.5;

void note(const FrontOrder::Noted& noted, Index bucket, FrontOrder::Notes& notes) {
  if (bucket >= static_cast<Index>(notes.size())) notes.resize(bucket + 1);
  notes[bucket].push_back(noted);
}

/// Of half-edges.
double mean_length(const TriangleMesh& mesh, const IntrinsicGeometry& geometry) {
  const tbb::blocked_range<Index> all(0, mesh.n_halfedges(), 1 << 14);
  const auto add = [&](const auto& part, double sum) {
    for (Index h = part.begin(); h < part.end(); ++h) sum += geometry.length(h);
    return sum;
  };
  // The same for any number of threads.
  return tbb::parallel_deterministic_reduce(all, 0.0, add, std::plus<>()) / std::max<Index>(mesh.n_halfedges(), 1);
}

}  // namespace

ListPropagation::ListPropagation(const TriangleMesh& mesh, const IntrinsicGeometry& geometry, bool retain)
    : mesh_(mesh),
      geometry_(geometry),
      numbering_(mesh),
      retain_(retain),
      sites_(mesh.n_halfedges()),
      states_(mesh.n_vertices()),
      distances_(mesh.n_vertices(), infinity),
      source_at_(mesh.n_vertices(), no_index),
      fans_(retain ? mesh.n_halfedges() : 0),
      kept_(retain ? mesh.n_halfedges() : 0, nullptr),
      own_positions_(numbering_.is_that_of_mesh() ? 0 : mesh.n_vertices()),
      positions_(numbering_.is_that_of_mesh() ? mesh.soup().positions.data() : own_positions_.data()),
      bucket_width_(std::max(bucket_width * mean_length(mesh, geometry), std::numeric_limits<double>::min())),
      rounding_(geometry.rounding()),
      margin_(rounding_),
      order_(mesh.bounds()) {
  const LocalHalfedges halfedges(mesh, numbering_);
  const LocalGeometry local(geometry, numbering_);
  const auto lay_out_sites = [&] {
    tbb::parallel_for(Index(0), mesh.n_halfedges(), [&](Index h) {
      // A corner on the opposite edge lies above it all the same, so that rays along the edge know their sides of it.
      const double shorter = std::min(local.length(TriangleMesh::next(h)), local.length(TriangleMesh::prev(h)));
      const Vec2 apex(local.apex(h).x(), std::max(local.apex(h).y(), least_slope * shorter));
      const Index twin = halfedges.twin(h);
      sites_[h] = {{nullptr, nullptr, nullptr}, local.length(h), apex, twin, halfedges.from(h), not_waiting, 0};
    });
  };
  // Spokes are counted by one thread alone.
  tbb::parallel_invoke([&] { rings_ = VertexRings(halfedges, local); }, lay_out_sites);
  tbb::parallel_for(Index(0), mesh.n_vertices(), [&](Index v) {
    const std::span<const Spoke> ring = rings_.of(v);
    double total_angle = 0;
    for (const Spoke& spoke : ring) total_angle += spoke.angle;
    const bool bends = isopath::may_bend(!is_closed(ring), total_angle);
    states_[v] = {total_angle, {no_index, 0, 0, Vec2::UnitX()}, no_index, not_waiting, bends, false};
    if (!own_positions_.empty()) own_positions_[v] = mesh.position(numbering_.vertex_in_mesh(v));
  });
}

std::vector<double> ListPropagation::vertex_distances() const {
  if (numbering_.is_that_of_mesh()) return distances_;
  std::vector<double> distances(distances_.size());
  for (Index v = 0; v < mesh_.n_vertices(); ++v) distances[v] = distances_[numbering_.vertex_here(v)];
  return distances;
}

std::vector<Index> ListPropagation::vertex_roots() const {
  std::vector<Index> roots(states_.size());
  for (Index v = 0; v < mesh_.n_vertices(); ++v) roots[v] = states_[numbering_.vertex_here(v)].root;
  return roots;
}

std::vector<FanArc> ListPropagation::fans() const {
  if (numbering_.is_that_of_mesh()) return fans_;
  std::vector<FanArc> fans(fans_.size());
  for (Index h = 0; h < mesh_.n_halfedges(); ++h) fans[h] = fans_[numbering_.halfedge_here(h)];
  return fans;
}

std::size_t ListPropagation::window_bytes() const {
  std::size_t bytes = 0;
  for (const Workshop& workshop : workshops_) bytes += workshop.blocks.bytes();
  return bytes;
}

std::size_t ListPropagation::propagated() const {
  std::size_t windows = 0;
  for (const Workshop& workshop : workshops_) windows += workshop.propagated;
  return windows;
}

void ListPropagation::merge_within(const MergeLimits& limits) {
  limits_ = limits;
  margin_ = rounding_ + 2 * limits.accuracy;
}

double ListPropagation::reach_along_edges(double stop_distance, Progress& progress) const {
  constexpr std::size_t between_checkpoints = 1 << 12;
  std::vector<double> distances = distances_;
  std::vector<double> handed_on(distances.size(), infinity);
  BucketQueue queue(1);
  const auto push = [&](Index vertex) {
    queue.push(static_cast<float>(distances[vertex] / bucket_width_), static_cast<std::uint32_t>(vertex));
  };
  for (Index v = 0; v < mesh_.n_vertices(); ++v) {
    if (distances[v] < infinity) push(v);
  }
  for (std::size_t visited = 0; !queue.empty(); ++visited) {
    if (visited % between_checkpoints == 0) progress.checkpoint();
    queue.n_next();
    const std::uint32_t vertex = queue.pop();
    const double distance = distances[vertex];
    if (distance >= handed_on[vertex] || distance > stop_distance) continue;
    handed_on[vertex] = distance;
    for (const Spoke& spoke : rings_.of(static_cast<Index>(vertex))) {
      if (distance + spoke.length >= distances[spoke.to]) continue;
      distances[spoke.to] = distance + spoke.length;
      push(spoke.to);
    }
  }
  double farthest = 0;
  for (const double distance : handed_on) {
    if (distance < infinity) farthest = std::max(farthest, distance);
  }
  return farthest;
}

void ListPropagation::start(const SourceFronts& fronts) {
  Workshop& workshop = workshops_.emplace_back(retain_);
  for (const SourceFronts::Vertex& source : fronts.vertices) {
    const Index vertex = numbering_.vertex_here(source.vertex);
    source_at_[vertex] = static_cast<Index>(source_arcs_.size());
    source_arcs_.push_back(source.blocked);
    const Index outgoing = numbering_.halfedge_here(mesh_.outgoing(source.vertex));
    offer_vertex({vertex, source.root, 0, {outgoing, 0, 0, Vec2::UnitX()}}, workshop);
  }
  for (const SourceFronts::Front& front : fronts.fronts) {
    const Index h = numbering_.halfedge_here(front.halfedge);
    const Index next = TriangleMesh::next(h);
    const Window& w = front.window;
    const double length = geometry_.length(front.halfedge);
    // The fronts arrive from inside the half-edge's face, to which the way back leads.
    const auto back_at = [&](double x) { return Vec2(-w.direction(x).x(), std::max(-w.direction(x).y(), 0.0)); };
    const auto slack = [&](double x) { return w.kind == Window::Kind::point ? slack_at(w.radius(x)) : 0; };
    if (w.begin == 0) offer_vertex({sites_[h].tail, w.root, w.distance(0), {h, slack(0), 0, back_at(0)}}, workshop);
    if (w.end == length) {
      const Vec2 outgoing = geometry_.apex(front.halfedge) - Vec2(length, 0);
      const Vec2 back = back_at(length);
      offer_vertex({sites_[next].tail,
                    w.root,
                    w.distance(length),
                    {next, slack(length), 0, Vec2(outgoing.dot(back), isopath::cross(outgoing, back))}},
                   workshop);
    }
    if (w.filler && retain_) {
      const Index edge = mesh_.edge_of(front.halfedge);
      edge_sources_.emplace_back(edge, mesh_.halfedge_of(edge) == front.halfedge ? w : w.flipped(length));
    }
  }
  const auto by_edge = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::stable_sort(edge_sources_.begin(), edge_sources_.end(), by_edge);
  put_down_fronts(fronts.fronts, workshop);
}

void ListPropagation::put_down_fronts(const std::vector<SourceFronts::Front>& fronts, Workshop& workshop) {
  struct Arriving {
    Index place;
    Index front;
    double begin;
  };
  std::vector<Arriving> arriving;
  for (Index i = 0; i < static_cast<Index>(fronts.size()); ++i) {
    const auto& [h, window] = fronts[i];
    const Index place = waiting_place(numbering_.halfedge_here(h));
    if (place != no_index && !window.filler) arriving.push_back({place, i, geometry_.length(h) - window.end});
  }
  // One list for each half-edge: of a path's many fronts several arrive at the same one.
  tbb::parallel_sort(arriving.begin(), arriving.end(), [](const Arriving& a, const Arriving& b) {
    return std::tie(a.place, a.begin, a.front) < std::tie(b.place, b.begin, b.front);
  });
  WindowBlocks& blocks = workshop.blocks;
  for (std::size_t first = 0, past = 0; first < arriving.size(); first = past) {
    const Index place = arriving[first].place;
    while (past < arriving.size() && arriving[past].place == place) ++past;
    WindowBlock* block = blocks.take(past - first);
    block->size = static_cast<Index>(past - first);
    block->least = infinity;
    for (std::size_t i = first; i < past; ++i) {
      const SourceFronts::Front& front = fronts[arriving[i].front];
      const Window turned = front.window.flipped(geometry_.length(front.halfedge));
      blocks.arrays(block).set(i - first, turned);
      block->least = std::min(block->least, std::max(turned.min_distance(), 0.0));
    }
    put_down(place, from_corner, block);
    push_halfedge(place, block->least, along(sites_[place].tail), workshop);
  }
}

void ListPropagation::push_halfedge(Index halfedge, double least, float along, Workshop& workshop) {
  const Index bucket = std::max(bucket_, static_cast<Index>(least / bucket_width_));
  const std::atomic_ref<Index> known(sites_[halfedge].bucket);
  Index before = known.load(std::memory_order_relaxed);
  do {
    if (bucket >= before) return;
  } while (!known.compare_exchange_weak(before, bucket, std::memory_order_relaxed));
  note({halfedge, along}, bucket, workshop.halfedges);
}

void ListPropagation::offer_vertex(const Offer& offer, Workshop& workshop) {
  const double distance = std::max(offer.distance, 0.0);
  VertexState& state = states_[offer.vertex];
  if (!(distance < distances_[offer.vertex])) {
    // Of two ways as short as each other the same one must be kept, whichever thread found its way first. By one
    // half-edge two may come: on the boundary, along it and along the edge opposite.
    if (distance > distances_[offer.vertex] || state.bucket == not_waiting) return;
    const auto rank = [](Index root, const Arrival& a) {
      return std::tuple(a.halfedge, root, a.back.x(), a.back.y(), a.error, a.slack);
    };
    if (!(rank(offer.root, offer.arrival) < rank(state.root, state.arrival))) return;
  }
  std::atomic_ref<double>(distances_[offer.vertex]).store(distance, std::memory_order_relaxed);
  state.root = offer.root;
  state.arrival = offer.arrival;
  const Index bucket = std::max(bucket_, static_cast<Index>(distance / bucket_width_));
  if (bucket >= state.bucket) return;
  state.bucket = bucket;
  note({offer.vertex, along(offer.vertex)}, bucket, workshop.vertices);
}

void ListPropagation::offer_vertex_locked(const Offer& offer, Workshop& workshop) {
  // What is longer now will be so then.
  const std::atomic_ref<double> known(distances_[offer.vertex]);
  if (offer.distance > known.load(std::memory_order_relaxed)) return;
  const std::atomic_ref<bool> locked(states_[offer.vertex].locked);
  while (locked.exchange(true, std::memory_order_acquire)) {
  }
  struct Unlock {
    std::atomic_ref<bool> locked;
    ~Unlock() { locked.store(false, std::memory_order_release); }
  };
  const Unlock unlock{locked};
  offer_vertex(offer, workshop);
}

void ListPropagation::put_down(Index halfedge, Feeder feeder, WindowBlock* block) {
  WindowBlock*& first = sites_[halfedge].waiting[feeder];
  block->next = first;
  first = block;
}

void ListPropagation::relax_edges(Index vertex, Workshop& workshop) const {
  const VertexState& from = states_[vertex];
  const std::span<const Spoke> ring = rings_.of(vertex);
  const double distance = distances_[vertex];
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Spoke& spoke = ring[k];
    const double there = distance + spoke.length;
    if (!(there < distances_[spoke.to])) continue;
    prefetch_to_write(&states_[spoke.to]);
    const float slack = slack_at(spoke.length);
    Arrival arrival{no_index, slack > widest_slit ? slack : 0, from.arrival.error, Vec2::UnitX()};
    if (k == 0 && !is_closed(ring)) {
      arrival.halfedge = TriangleMesh::next(spoke.halfedge);
      arrival.back = sites_[arrival.halfedge].apex;
    } else {
      arrival.halfedge = TriangleMesh::prev(ring[k > 0 ? k - 1 : ring.size() - 1].halfedge);
    }
    workshop.offers.push_back({spoke.to, from.root, there, arrival});
  }
}

bool ListPropagation::may_bend(Index vertex) const {
  const VertexState& state = states_[vertex];
  if (state.may_bend || state.arrival.slack <= widest_slit) return state.may_bend;
  const double sides = is_closed(rings_.of(vertex)) ? 2 : 1;
  return state.total_angle > sides * (std::numbers::pi - state.arrival.slack);
}

void ListPropagation::find_fans(Index vertex, Workshop& workshop) {
  const double total = states_[vertex].total_angle;
  const bool is_source = source_at_[vertex] != no_index;
  if (!is_source && !may_bend(vertex)) return;
  const std::span<const Spoke> ring = rings_.of(vertex);
  std::size_t first = 0;
  BlockedArc behind;
  if (!is_source) {
    const Arrival& arrival = states_[vertex].arrival;
    behind = {std::atan2(std::max(arrival.back.y(), 0.0), arrival.back.x()),
              std::max(std::numbers::pi - angle_slack - arrival.slack, 0.0)};
    while (ring[first].halfedge != arrival.halfedge) {
      if (!is_closed(ring)) behind.angle += ring[first].angle;
      ++first;
    }
    if (!is_closed(ring)) first = 0;
  }
  const std::span<const BlockedArc> blocked =
      is_source ? std::span<const BlockedArc>(source_arcs_[source_at_[vertex]]) : std::span(&behind, 1);
  if (retain_) {
    for (const Spoke& spoke : ring) {
      if (spoke.halfedge != no_index) fans_[spoke.halfedge] = {};
    }
  }
  for_each_free_arc(ring, first, total, blocked, [&](Index outgoing, double low, double high, bool cut) {
    if (retain_) fans_[outgoing] = {std::min(fans_[outgoing].low, low), std::max(fans_[outgoing].high, high)};
    workshop.fans.push_back({vertex, outgoing, low, cut ? high : infinity});
    __builtin_prefetch(&sites_[outgoing]);
    __builtin_prefetch(&sites_[TriangleMesh::next(outgoing)]);
  });
}

void ListPropagation::send_fan(const Fan& fan, Workshop& workshop) {
  const Site& outgoing = sites_[fan.outgoing];
  const Site& opposite = sites_[TriangleMesh::next(fan.outgoing)];
  const Index place = waiting_place(TriangleMesh::next(fan.outgoing));
  if (place == no_index) return;
  prefetch_to_write(&sites_[place]);
  const FanInterval interval = fan_interval(outgoing.length, outgoing.apex, opposite.length, fan.low, fan.high);
  // From a corner next to the opposite edge many directions pass within a rounding error.
  Window window;
  window.begin = std::max(opposite.length - interval.end - rounding_, 0.0);
  window.end = std::min(opposite.length - interval.begin + rounding_, opposite.length);
  if (!(window.begin < window.end)) return;
  window.source = Vec2(opposite.length, 0) - opposite.apex;
  window.offset = distances_[fan.vertex];
  window.root = states_[fan.vertex].root;
  window.error = states_[fan.vertex].arrival.error;
  WindowBlock* block = workshop.blocks.take(1);
  workshop.blocks.arrays(block).set(0, window);
  block->size = 1;
  block->least = window.min_distance();
  put_down(place, from_corner, block);
  push_halfedge(place, block->least, along(fan.vertex), workshop);
}

}  // namespace isopath
