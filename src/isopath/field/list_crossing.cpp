// How one list of windows gets through a triangle: gathered, trimmed, remembered, and put down on the other side.
#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>
#include <vector>

#include "isopath/field/list_propagation.h"
#include "isopath/field/prefetch.h"

namespace isopath {
namespace {

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

}  // namespace

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
    n = set_intervals(windows, n, begin, end);
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
  for (const Index leaving : {previous, next}) prefetch_to_write(&sites_[std::max(sites_[leaving].twin, 0)]);
  const Index corner = sites_[previous].tail;
  if (is_shared_) __builtin_prefetch(&positions_[corner]);
  const Site& site = sites_[h];
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
    if (apex.distance < distances_[corner]) {
      prefetch_to_write(&states_[corner]);
      Offer& offer = workshop.offers.emplace_back();
      offer = {corner, no_index, apex.distance, arrival_at_apex(windows, apex, triangle, previous)};
      if (retain_) {
        offer.root = static_cast<Index>(windows.root[apex.window]);
        offer.arrival.error = windows.error[apex.window];
      }
    }
    const float place = along(corner);
    const auto send = [&](auto&& cross_to, Index leaving, Feeder feeder, std::size_t at_most) {
      const Index entering = waiting_place(leaving);
      if (entering == no_index || at_most == 0) return;
      WindowBlock* block = workshop.blocks.take(at_most);
      block->size = static_cast<Index>(cross_to(windows, n, triangle, apex, side_of_begin, side_of_end,
                                                workshop.blocks.arrays(block), block->least));
      if (block->size == 0) return workshop.blocks.give_back(block);
      block->depth = crossing.depth + 1;
      put_down(entering, feeder, block);
      push_halfedge(entering, block->least, place, workshop);
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

}  // namespace isopath
