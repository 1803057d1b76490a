#include "isopath/field/list_propagation.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

namespace isopath {
namespace {

/// Directions that are known less well than this leave slits beside the vertices that rays pass, wide enough to matter.
constexpr double widest_slit = 1e-9;
/// Rises less than any direction is known to.
constexpr double least_slope = 1e-20;
/// Shares of a thread in a round.
constexpr std::size_t lists_at_a_time = 16;
constexpr std::size_t vertices_at_a_time = 16;
/// Items are fetched into the cache this many places before their turn.
constexpr std::size_t ahead = 4;
/// In mean edge lengths: narrower buckets make shorter lists, wider ones send windows ahead that are beaten later.
constexpr double bucket_width = 0.5;
/// Lists cross a half-edge a few times. Around closed needles they would go on and on, each turn a little longer than
/// the one before: after so many times a half-edge begins to remember what crossed.
constexpr Index lists_without_memory = 64;
/// So many lists are merged one after the other; more, as sources on a large face send them, are sorted.
constexpr std::size_t few_lists = 8;

/// Direction from the apex of a triangle to the head of its base; `tail` is the base's tail in the frame from the head
/// to the apex. Where these two are close together, the difference of two far points would not know it; elsewhere it
/// keeps points on one line on it, which regular grids need.
Vec2 axis_to_head(double base, const Vec2& apex, double right, const Vec2& tail) {
  constexpr double close = 1e-2;
  if (right < close * base) return Vec2(tail.x() / base, -tail.y() / base);
  return Vec2((base - apex.x()) / right, -apex.y() / right);
}

double mean_length(const TriangleMesh& mesh, const IntrinsicGeometry& geometry) {
  double sum = 0;
  for (Index e = 0; e < mesh.n_edges(); ++e) sum += geometry.length(mesh.halfedge_of(e));
  return sum / std::max<Index>(mesh.n_edges(), 1);
}

}  // namespace

ListPropagation::ListPropagation(const TriangleMesh& mesh, const IntrinsicGeometry& geometry, bool retain)
    : mesh_(mesh),
      geometry_(geometry),
      retain_(retain),
      sites_(mesh.n_halfedges()),
      rings_(mesh, geometry),
      states_(mesh.n_vertices()),
      distances_(mesh.n_vertices(), infinity),
      source_at_(mesh.n_vertices(), no_index),
      fans_(retain ? mesh.n_halfedges() : 0),
      kept_(retain ? mesh.n_halfedges() : 0, nullptr),
      bucket_width_(bucket_width * mean_length(mesh, geometry)),
      rounding_(geometry.rounding()) {
  tbb::parallel_for(Index(0), mesh.n_halfedges(), [&](Index h) {
    Site& site = sites_[h];
    site.length = geometry.length(h);
    // A corner on the opposite edge lies above it all the same, so that rays along the edge know their sides of it.
    const double shorter = std::min(geometry.length(TriangleMesh::next(h)), geometry.length(TriangleMesh::prev(h)));
    site.apex = Vec2(geometry.apex(h).x(), std::max(geometry.apex(h).y(), least_slope * shorter));
    site.twin = mesh.twin(h);
    site.tail = mesh.from(h);
  });
  tbb::parallel_for(Index(0), mesh.n_vertices(), [&](Index v) {
    const std::span<const Spoke> ring = rings_.of(v);
    for (const Spoke& spoke : ring) states_[v].total_angle += spoke.angle;
    states_[v].may_bend = isopath::may_bend(!is_closed(ring), states_[v].total_angle);
  });
}

std::vector<Index> ListPropagation::vertex_roots() const {
  std::vector<Index> roots(states_.size());
  for (std::size_t v = 0; v < states_.size(); ++v) roots[v] = states_[v].root;
  return roots;
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

void ListPropagation::start(const SourceFronts& fronts, const MergeLimits& limits) {
  limits_ = limits;
  margin_ = rounding_ + 2 * limits.accuracy;
  Workshop& workshop = workshops_.emplace_back(retain_);
  WindowBlocks& blocks = workshop.blocks;
  struct Arriving {
    Index place;
    Index front;
    double begin;
  };
  std::vector<Arriving> arriving;
  for (const SourceFronts::Vertex& source : fronts.vertices) {
    source_at_[source.vertex] = static_cast<Index>(source_arcs_.size());
    source_arcs_.push_back(source.blocked);
    offer_vertex({source.vertex, source.root, 0, {mesh_.outgoing(source.vertex)}});
  }
  for (Index i = 0; i < static_cast<Index>(fronts.fronts.size()); ++i) {
    const SourceFronts::Front& front = fronts.fronts[i];
    const Index h = front.halfedge;
    const Window& w = front.window;
    const double length = geometry_.length(h);
    // The fronts arrive from inside the half-edge's face, to which the way back leads.
    const auto back_at = [&](double x) { return Vec2(-w.direction(x).x(), std::max(-w.direction(x).y(), 0.0)); };
    const auto slack = [&](double x) { return w.kind == Window::Kind::point ? slack_at(w.radius(x)) : 0; };
    if (w.begin == 0) offer_vertex({mesh_.from(h), w.root, w.distance(0), {h, slack(0), 0, back_at(0)}});
    if (w.end == length) {
      const Vec2 outgoing = geometry_.apex(h) - Vec2(length, 0);
      const Vec2 back = back_at(length);
      offer_vertex(
          {mesh_.to(h),
           w.root,
           w.distance(length),
           {TriangleMesh::next(h), slack(length), 0, Vec2(outgoing.dot(back), isopath::cross(outgoing, back))}});
    }
    if (w.filler && retain_) {
      const Index edge = mesh_.edge_of(h);
      edge_sources_.emplace_back(edge, mesh_.halfedge_of(edge) == h ? w : w.flipped(length));
    }
    const Index place = waiting_place(h);
    if (place != no_index && !w.filler) arriving.push_back({place, i, length - w.end});
  }
  // One list for each half-edge: of a path's many fronts several arrive at the same one.
  tbb::parallel_sort(arriving.begin(), arriving.end(), [](const Arriving& a, const Arriving& b) {
    return std::tie(a.place, a.begin, a.front) < std::tie(b.place, b.begin, b.front);
  });
  for (std::size_t first = 0, past = 0; first < arriving.size(); first = past) {
    const Index place = arriving[first].place;
    while (past < arriving.size() && arriving[past].place == place) ++past;
    WindowBlock* block = blocks.take(past - first);
    block->size = static_cast<Index>(past - first);
    block->least = infinity;
    for (std::size_t i = first; i < past; ++i) {
      const SourceFronts::Front& front = fronts.fronts[arriving[i].front];
      const Window turned = front.window.flipped(sites_[front.halfedge].length);
      blocks.arrays(block).set(i - first, turned);
      block->least = std::min(block->least, std::max(turned.min_distance(), 0.0));
    }
    put_down(place, from_corner, block);
    push_halfedge(place, block->least, workshop);
  }
  const auto by_edge = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::stable_sort(edge_sources_.begin(), edge_sources_.end(), by_edge);
}

void ListPropagation::push_halfedge(Index halfedge, double least, Workshop& workshop) {
  const Index bucket = std::max(bucket_, static_cast<Index>(least / bucket_width_));
  const std::atomic_ref<Index> known(sites_[halfedge].bucket);
  Index before = known.load(std::memory_order_relaxed);
  do {
    if (bucket >= before) return;
  } while (!known.compare_exchange_weak(before, bucket, std::memory_order_relaxed));
  if (bucket >= static_cast<Index>(workshop.halfedges.size())) workshop.halfedges.resize(bucket + 1);
  workshop.halfedges[bucket].push_back(halfedge);
}

void ListPropagation::offer_vertex(const Offer& offer) {
  const double distance = std::max(offer.distance, 0.0);
  VertexState& state = states_[offer.vertex];
  if (!(distance < distances_[offer.vertex])) {
    // Of two ways as short as each other the same one must be kept, whichever thread found its way first.
    if (distance > distances_[offer.vertex] || state.bucket == not_waiting) return;
    if (offer.arrival.halfedge >= state.arrival.halfedge) return;
  }
  distances_[offer.vertex] = distance;
  state.root = offer.root;
  state.arrival = offer.arrival;
  const Index bucket = std::max(bucket_, static_cast<Index>(distance / bucket_width_));
  if (bucket >= state.bucket) return;
  state.bucket = bucket;
  if (bucket >= static_cast<Index>(vertices_.size())) vertices_.resize(bucket + 1);
  vertices_[bucket].push_back(offer.vertex);
}

void ListPropagation::put_down(Index halfedge, Feeder feeder, WindowBlock* block) {
  WindowBlock*& first = sites_[halfedge].waiting[feeder];
  block->next = first;
  first = block;
}

void ListPropagation::relax_edges(Index vertex, Handed& handed) const {
  const VertexState& from = states_[vertex];
  const std::span<const Spoke> ring = rings_.of(vertex);
  const double distance = distances_[vertex];
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Spoke& spoke = ring[k];
    const double there = distance + spoke.length;
    if (!(there < distances_[spoke.to])) continue;
    __builtin_prefetch(&states_[spoke.to], 1);
    const float slack = slack_at(spoke.length);
    Arrival arrival{no_index, slack > widest_slit ? slack : 0, from.arrival.error, Vec2::UnitX()};
    if (k == 0 && !is_closed(ring)) {
      arrival.halfedge = TriangleMesh::next(spoke.halfedge);
      arrival.back = geometry_.apex(arrival.halfedge);
    } else {
      arrival.halfedge = TriangleMesh::prev(ring[k > 0 ? k - 1 : ring.size() - 1].halfedge);
    }
    handed.offers.push_back({spoke.to, from.root, there, arrival});
  }
}

bool ListPropagation::may_bend(Index vertex) const {
  const VertexState& state = states_[vertex];
  if (state.may_bend || state.arrival.slack <= widest_slit) return state.may_bend;
  const double sides = is_closed(rings_.of(vertex)) ? 2 : 1;
  return state.total_angle > sides * (std::numbers::pi - state.arrival.slack);
}

void ListPropagation::find_fans(Index vertex, Handed& handed) {
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
    handed.fans.push_back({vertex, outgoing, low, cut ? high : infinity});
    __builtin_prefetch(&sites_[outgoing]);
    __builtin_prefetch(&sites_[TriangleMesh::next(outgoing)]);
  });
}

void ListPropagation::send_fan(const Fan& fan, Workshop& workshop) {
  const Site& outgoing = sites_[fan.outgoing];
  const Site& opposite = sites_[TriangleMesh::next(fan.outgoing)];
  const Index place = waiting_place(TriangleMesh::next(fan.outgoing));
  if (place == no_index) return;
  __builtin_prefetch(&sites_[place], 1);
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
  push_halfedge(place, block->least, workshop);
}

void ListPropagation::Workshop::make_sides(std::size_t n) {
  if (sides[0].size() >= n + WindowBlock::lanes + 1) return;
  for (auto& side : sides) side.resize(2 * n + WindowBlock::lanes + 1);
}

WindowArrays ListPropagation::Workshop::scratch(int which, std::size_t n) {
  const std::size_t capacity = n + WindowBlock::lanes;
  const std::size_t needed = (tagged ? WindowArrays::tagged_count : WindowArrays::count) * capacity;
  if (arrays[which].size() < needed) arrays[which].resize(2 * needed);
  return WindowArrays::at(arrays[which].data(), capacity, tagged);
}

ListPropagation::KeptList* ListPropagation::Workshop::keep(const WindowArrays& windows, std::size_t n) {
  constexpr std::size_t header = sizeof(KeptList) / sizeof(double);
  double* memory = kept.take(header + WindowArrays::tagged_count * n);
  windows.copy(n, WindowArrays::at(memory + header, n, true));
  return new (memory) KeptList{nullptr, n};
}

WindowArrays ListPropagation::gather(Crossing& crossing, Workshop& workshop, std::size_t& n,
                                     WindowBlock*& owner) const {
  std::vector<WindowBlock*>& blocks = workshop.waiting;
  blocks.clear();
  n = 0;
  for (WindowBlock* first : crossing.lists) {
    for (WindowBlock* block = first; block != nullptr; block = block->next) {
      blocks.push_back(block);
      n += static_cast<std::size_t>(block->size);
      crossing.depth = std::min(crossing.depth, block->depth);
    }
  }
  owner = blocks.size() == 1 ? blocks.front() : nullptr;
  if (owner != nullptr) return workshop.blocks.arrays(owner);
  WindowArrays gathered = workshop.scratch(0, n);
  std::size_t so_far = 0;
  const auto size_of = [&](std::size_t k) { return static_cast<std::size_t>(blocks[k]->size); };
  if (blocks.size() <= few_lists) {
    gathered = workshop.blocks.arrays(blocks[0]);
    so_far = size_of(0);
    for (std::size_t k = 1; k < blocks.size(); ++k) {
      const WindowArrays to = workshop.scratch(static_cast<int>(k % 2), n);
      merge_lists(gathered, so_far, workshop.blocks.arrays(blocks[k]), size_of(k), to);
      gathered = to;
      so_far += size_of(k);
    }
  } else {
    for (std::size_t k = 0; k < blocks.size(); so_far += size_of(k), ++k)
      workshop.blocks.arrays(blocks[k]).copy(size_of(k), gathered + so_far);
    const WindowArrays sorted = workshop.scratch(1, n);
    sort_list(gathered, n, sorted);
    gathered = sorted;
  }
  for (WindowBlock* block : blocks) workshop.blocks.give_back(block);
  return gathered;
}

void ListPropagation::trim(WindowArrays& windows, std::size_t& n, Index h, bool several, Workshop& workshop) {
  const Site& site = sites_[h];
  const bool leaves_surface = site.twin == no_index;  // see waiting_place
  const Index next = TriangleMesh::next(h);
  const Index tail = sites_[leaves_surface ? next : h].tail;
  const Index head = sites_[leaves_surface ? h : next].tail;
  n = trim_by_vertices(windows, n, site.length, distances_[tail], distances_[head], margin_);
  double* begin = workshop.sides[0].data();
  double* end = workshop.sides[1].data();
  if (several && trim_by_neighbours(windows, n, margin_, begin, end)) {
    std::copy_n(begin, n, windows.begin);
    std::copy_n(end, n, windows.end);
    n = drop_empty(windows, n);
  }
  if (site.memory > 0) windows = news(windows, n, h, workshop);
  if (limits_.accuracy > 0) windows = merged(windows, n, site.length, workshop);
}

ListPropagation::Arrival ListPropagation::arrival_at_apex(const WindowArrays& windows, const ApexReach& apex,
                                                          const StepGeometry& triangle, Index previous) const {
  Vec2 back = Vec2(apex.x, 0) - triangle.apex;
  float slack = 0;
  if (apex.window == apex.direct) {  // the crossing may be too near to tell the direction
    const Window w = windows.window(static_cast<std::size_t>(apex.window));
    const bool is_point = w.kind == Window::Kind::point;
    back = is_point ? Vec2(w.source - triangle.apex) : Vec2(-w.source);
    slack = is_point ? slack_at(back.norm()) : 0;
  } else {
    slack = slack_at(back.norm());
  }
  const Vec2 along = -triangle.apex;
  return {previous, slack, 0, Vec2(along.dot(back), isopath::cross(along, back))};
}

void ListPropagation::cross(Crossing& crossing, Workshop& workshop) {
  const Index h = crossing.halfedge;
  std::size_t n = 0;
  WindowBlock* owner = nullptr;
  WindowArrays windows = gather(crossing, workshop, n, owner);
  workshop.make_sides(n);
  if (crossing.depth > mesh_.n_faces()) n = 0;  // a shortest way comes into a face but once

  const Index next = TriangleMesh::next(h);
  const Index previous = TriangleMesh::prev(h);
  const Site& site = sites_[h];
  for (const Index leaving : {previous, next}) __builtin_prefetch(&sites_[std::max(sites_[leaving].twin, 0)], 1);
  const Site& right = sites_[next];
  const StepGeometry triangle{site.length,
                              site.apex,
                              sites_[previous].length,
                              right.length,
                              axis_to_head(site.length, site.apex, right.length, right.apex),
                              rounding_};
  trim(windows, n, h, owner == nullptr, workshop);
  if (retain_ && n > 0) {
    KeptList* list = workshop.keep(windows, n);
    list->next = std::exchange(kept_[h], list);
  }
  workshop.propagated += n;
  if (n > 0 && site.twin != no_index) {
    workshop.make_sides(n);  // merging and remembering may have divided windows
    double* side_of_begin = workshop.sides[0].data();
    double* side_of_end = workshop.sides[1].data();
    const ApexReach apex = reach_apex(windows, n, triangle, margin_, side_of_begin, side_of_end);
    const Index corner = sites_[previous].tail;
    if (apex.distance < distances_[corner]) {
      __builtin_prefetch(&states_[corner], 1);
      Offer& offer = workshop.offers.emplace_back();
      offer = {corner, no_index, apex.distance, arrival_at_apex(windows, apex, triangle, previous)};
      if (retain_) {
        offer.root = static_cast<Index>(windows.root[apex.window]);
        offer.arrival.error = windows.error[apex.window];
      }
    }
    const auto send = [&](auto&& cross_to, Index leaving, Feeder feeder, std::size_t at_most) {
      const Index entering = waiting_place(leaving);
      if (entering == no_index || at_most == 0) return;
      WindowBlock* block = workshop.blocks.take(at_most);
      block->size = static_cast<Index>(cross_to(windows, n, triangle, apex, side_of_begin, side_of_end,
                                                workshop.blocks.arrays(block), block->least));
      if (block->size == 0) return workshop.blocks.give_back(block);
      block->depth = crossing.depth + 1;
      put_down(entering, feeder, block);
      push_halfedge(entering, block->least, workshop);
    };
    send(cross_to_left, previous, from_next, apex.n_left);
    send(cross_to_right, next, from_previous, apex.n_right);
  }
  if (owner != nullptr) workshop.blocks.give_back(owner);
}

WindowArrays ListPropagation::news(const WindowArrays& windows, std::size_t& n, Index halfedge, Workshop& workshop) {
  constexpr Index is_new = 0;  // in place of a half-edge, of which the envelope takes no notice
  EdgeEnvelope& memory = memories_[sites_[halfedge].memory - 1];
  for (std::size_t i = 0; i < n; ++i) {
    Window window = windows.window(i);
    window.halfedge = is_new;
    window.offset += margin_;  // what is nearer by less than rounding is no news
    memory.insert(window);
  }
  const WindowArrays to = workshop.scratch(2, memory.windows().size());
  n = 0;
  for (Window& window : memory.windows()) {
    if (std::exchange(window.halfedge, no_index) != is_new) continue;
    window.offset -= margin_;
    to.set(n++, window);
  }
  return to;
}

WindowArrays ListPropagation::merged(const WindowArrays& windows, std::size_t& n, double length,
                                     Workshop& workshop) const {
  if (n < 2) return windows;
  EdgeEnvelope& envelope = workshop.envelope;
  envelope.reset(length, snap_width(length));
  for (std::size_t i = 0; i < n; ++i) envelope.insert(windows.window(i));
  envelope.merge(limits_);
  const std::vector<Window>& left = envelope.windows();
  const WindowArrays to = left.size() <= n ? windows : workshop.scratch(3, left.size());
  n = left.size();
  for (std::size_t i = 0; i < n; ++i) to.set(i, left[i]);
  return to;
}

void ListPropagation::run_vertices(Team& team) {
  active_.clear();
  for (const Index v : std::exchange(vertices_[bucket_], {})) {
    if (states_[v].bucket != bucket_) continue;
    states_[v].bucket = not_waiting;
    active_.push_back(v);
  }
  const std::size_t n_parts = (active_.size() + vertices_at_a_time - 1) / vertices_at_a_time;
  if (handed_.size() < n_parts) handed_.resize(n_parts);
  team.share(n_parts, 1, [&](std::size_t first, std::size_t past, std::size_t member) {
    Workshop& workshop = workshops_[member];
    for (std::size_t part = first; part < past; ++part) {
      Handed& handed = handed_[part];
      handed.offers.clear();
      handed.fans.clear();
      const std::size_t end = std::min(active_.size(), (part + 1) * vertices_at_a_time);
      for (std::size_t i = part * vertices_at_a_time; i < end; ++i) {
        if (i + ahead < active_.size()) fetch_around(active_[i + ahead]);
        relax_edges(active_[i], handed);
        find_fans(active_[i], handed);
      }
      for (const Fan& fan : handed.fans) send_fan(fan, workshop);
    }
  });
  for (std::size_t part = 0; part < n_parts; ++part) {
    for (const Offer& offer : handed_[part].offers) offer_vertex(offer);
  }
}

void ListPropagation::fetch_around(Index vertex) const {
  const std::span<const Spoke> ring = rings_.of(vertex);
  for (std::size_t k = 0; k < ring.size(); k += 2) __builtin_prefetch(&ring[k]);
  __builtin_prefetch(&states_[vertex]);
}

void ListPropagation::fetch(const Crossing& crossing) const {
  const Index first = crossing.halfedge - crossing.halfedge % 3;
  for (Index h = first; h < first + 3; ++h) {
    __builtin_prefetch(&sites_[h]);
  }
  for (const WindowBlock* block : crossing.lists) {
    if (block == nullptr) continue;
    const char* line = reinterpret_cast<const char*>(block);
    for (int k = 0; k < 16; ++k) __builtin_prefetch(line + 64 * k);
  }
}

bool ListPropagation::take(Index halfedge, Crossing& crossing, Workshop& workshop) {
  Site& site = sites_[halfedge];
  // A half-edge may be noted twice in a bucket: once long ago, before it was called from a nearer one.
  Index noted = bucket_;
  if (!std::atomic_ref<Index>(site.bucket).compare_exchange_strong(noted, not_waiting, std::memory_order_relaxed)) {
    return false;
  }
  crossing.halfedge = halfedge;
  crossing.depth = std::numeric_limits<Index>::max();
  for (int k = 0; k < 3; ++k) crossing.lists[k] = std::exchange(site.waiting[k], nullptr);
  if (site.memory <= 0 && --site.memory <= -lists_without_memory) workshop.crowded.push_back(halfedge);
  return true;
}

void ListPropagation::run_lists(Team& team) {
  waiting_.clear();
  for (Workshop& workshop : workshops_) {
    if (bucket_ >= static_cast<Index>(workshop.halfedges.size())) continue;
    std::vector<Index>& noted = workshop.halfedges[bucket_];
    waiting_.insert(waiting_.end(), noted.begin(), noted.end());
    noted.clear();
  }
  crossings_.resize(waiting_.size());
  // All are taken before one crosses: what crosses may be put down where another one waits.
  team.share(waiting_.size(), 4 * lists_at_a_time, [&](std::size_t first, std::size_t past, std::size_t member) {
    Workshop& workshop = workshops_[member];
    for (std::size_t i = first; i < past; ++i) {
      if (i + ahead < past) __builtin_prefetch(&sites_[waiting_[i + ahead]], 1);
      if (!take(waiting_[i], crossings_[i], workshop)) crossings_[i].halfedge = no_index;
    }
  });
  for (Workshop& workshop : workshops_) {
    for (const Index h : workshop.crowded) {
      memories_.emplace_back().reset(sites_[h].length, snap_width(sites_[h].length));
      sites_[h].memory = static_cast<Index>(memories_.size());
    }
    workshop.crowded.clear();
  }
  team.share(crossings_.size(), lists_at_a_time, [&](std::size_t first, std::size_t past, std::size_t member) {
    Workshop& workshop = workshops_[member];
    for (std::size_t i = first; i < past; ++i) {
      if (i + ahead < past) fetch(crossings_[i + ahead]);
      if (crossings_[i].halfedge != no_index) cross(crossings_[i], workshop);
    }
  });
  for (Workshop& workshop : workshops_) {
    for (const Offer& offer : workshop.offers) offer_vertex(offer);
    workshop.offers.clear();
  }
}

bool ListPropagation::are_waiting() const {
  return std::any_of(workshops_.begin(), workshops_.end(), [&](const Workshop& workshop) {
    return bucket_ < static_cast<Index>(workshop.halfedges.size()) && !workshop.halfedges[bucket_].empty();
  });
}

void ListPropagation::run(double stop_distance, Progress& progress) {
  Team team;
  while (workshops_.size() < team.size()) workshops_.emplace_back(retain_);
  for (bucket_ = 0; bucket_ * bucket_width_ <= stop_distance; ++bucket_) {
    std::size_t past = vertices_.size();
    for (const Workshop& workshop : workshops_) past = std::max(past, workshop.halfedges.size());
    if (bucket_ >= static_cast<Index>(past)) break;
    vertices_.resize(past);
    while (!vertices_[bucket_].empty() || are_waiting()) {
      progress.checkpoint();
      if (!vertices_[bucket_].empty()) run_vertices(team);
      if (are_waiting()) run_lists(team);
    }
  }
  progress.at(1);
}

}  // namespace isopath
