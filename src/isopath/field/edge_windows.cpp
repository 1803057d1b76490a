#include "isopath/field/edge_windows.h"

#include <algorithm>

namespace isopath {
namespace {

/// Distances carry a rounding error of a few units in the last place; a difference below it decides nothing.
constexpr double rounding = 1e-15;
/// A path along an edge must not displace a front that reaches the same points a hair's breadth beside it (see
/// Window::filler).
constexpr double filler_margin = 1e-12;

/// True when `window` is to replace `old` around x.
bool beats(const Window& window, const Window& old, double x) {
  const double mine = window.distance(x);
  const double theirs = old.distance(x);
  if (window.filler == old.filler) return mine < theirs - rounding * theirs;
  const double margin = filler_margin * theirs + window.error + old.error;
  return mine < theirs - (window.filler ? margin : -margin);
}

}  // namespace

Index WindowPool::allocate(const Window& window) {
  Index id = size_;
  if (!free_.empty()) {
    id = free_.back();
    free_.pop_back();
  } else {
    if (id >> block_bits == static_cast<Index>(blocks_.size()))
      blocks_.push_back(std::make_unique<Window[]>(1 << block_bits));
    ++size_;
  }
  (*this)[id] = window;
  return id;
}

void WindowPool::reorder(std::vector<Index> order) {
  const std::size_t kept = order.size();
  order.insert(order.end(), free_.begin(), free_.end());  // now a permutation of all places: follow its cycles
  for (Index start = 0; start < size_; ++start) {
    if (order[start] == start) continue;
    const Window saved = (*this)[start];
    Index place = start;
    while (order[place] != start) {
      const Index source = order[place];
      (*this)[place] = (*this)[source];
      order[place] = place;
      place = source;
    }
    (*this)[place] = saved;
    order[place] = place;
  }
  size_ = static_cast<Index>(kept);
  free_ = {};
  blocks_.resize((kept + block_mask) >> block_bits);
}

EdgeWindows::EdgeWindows(std::vector<double> edge_length, std::vector<double> snap, const MergeLimits& limits)
    : lists_(edge_length.size()), length_(std::move(edge_length)), snap_(std::move(snap)), limits_(limits) {}

WindowPool EdgeWindows::take(std::vector<Index>& first) {
  std::vector<Index> order;
  order.reserve(pool_.size());
  first.assign(1, 0);
  first.reserve(lists_.size() + 1);
  for (std::vector<Slot>& list : lists_) {
    for (const Slot& slot : list) order.push_back(slot.id);
    list = {};
    first.push_back(static_cast<Index>(order.size()));
  }
  pool_.reorder(std::move(order));
  return std::move(pool_);
}

void EdgeWindows::append(double begin, double end, Index id) {
  if (end <= begin) return;
  if (!parts_.empty() && parts_.back().id == id && parts_.back().end == begin) {
    parts_.back().end = end;
  } else {
    parts_.push_back({begin, end, id});
  }
}

void EdgeWindows::divide_overlap(Index old_id, const Window& window, double low, double high, double snap) {
  const Window& old = pool_[old_id];
  // Both distances have slope at most 1: far enough apart at the ends, they do not meet in between.
  const double apart = 0.5 * (window.distance(low) - old.distance(low) + window.distance(high) - old.distance(high));
  if (std::abs(apart) > (high - low) + filler_margin * old.distance(low))
    return append(low, high, apart < 0 ? newcomer : old_id);
  const Ties ties = ties_between(old, window, low + snap, high - snap);
  double from = low;
  for (int i = 0; i <= ties.count; ++i) {
    const double to = i < ties.count ? ties.x[i] : high;
    append(from, to, beats(window, old, 0.5 * (from + to)) ? newcomer : old_id);
    from = to;
  }
}

std::span<const Index> EdgeWindows::insert(Index edge, const Window& window) {
  inserted_.clear();
  const double length = length_[edge];
  const double snap = snap_[edge];
  Window w = window;
  if (w.begin < snap) w.begin = 0;
  if (w.end > length - snap) w.end = length;
  if (w.end - w.begin < std::min(snap, length)) return inserted_;

  std::vector<Slot>& list = lists_[edge];
  const auto starts_after = [](double x, const Slot& slot) { return x < slot.begin; };
  auto first =
      static_cast<std::size_t>(std::upper_bound(list.begin(), list.end(), w.begin - snap, starts_after) - list.begin());
  if (first > 0 && pool_[list[first - 1].id].end >= w.begin - snap) --first;
  parts_.clear();
  double x = w.begin;
  std::size_t last = first;
  for (; last < list.size() && list[last].begin <= w.end + snap; ++last) {
    const Index id = list[last].id;
    const double old_begin = pool_[id].begin;
    const double old_end = pool_[id].end;
    if (old_begin > x) append(x, old_begin, newcomer);
    if (old_begin < w.begin) append(old_begin, std::min(old_end, w.begin), id);
    const double low = std::max(old_begin, w.begin);
    const double high = std::min(old_end, w.end);
    if (low < high) divide_overlap(id, w, low, high, snap);
    if (old_end > w.end) append(std::max(old_begin, w.end), old_end, id);
    x = std::max(x, old_end);
  }
  if (x < w.end) append(x, w.end, newcomer);
  if (std::none_of(parts_.begin(), parts_.end(), [](const Part& p) { return p.id == newcomer; })) return inserted_;
  absorb_narrow_parts(snap);
  write_back(list, first, last, w);
  return inserted_;
}

void EdgeWindows::absorb_narrow_parts(double snap) {
  // Close hair cracks between parts, then give parts below the snap width to a neighbour.
  for (std::size_t i = 1; i < parts_.size(); ++i) {
    const double crack = parts_[i].begin - parts_[i - 1].end;
    if (crack > 0 && crack <= snap) parts_[i].begin = parts_[i - 1].end;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part part = parts_[i];
    if (kept > 0 && parts_[kept - 1].end == part.begin) {
      Part& left = parts_[kept - 1];
      if (left.id == part.id || part.end - part.begin < snap) {
        left.end = part.end;
        continue;
      }
      if (left.end - left.begin < snap) {
        left.id = part.id;
        left.end = part.end;
        continue;
      }
    }
    parts_[kept++] = part;
  }
  parts_.resize(kept);
}

void EdgeWindows::merge_neighbours() {
  std::size_t kept = 1;
  for (std::size_t i = 1; i < slots_.size(); ++i) {
    Slot slot = slots_[i];
    for (; kept > 0; --kept) {
      const Index left_id = slots_[kept - 1].id;
      Window& left = pool_[left_id];
      const Window& right = pool_[slot.id];
      if (!left.pending || !right.pending || left.halfedge != right.halfedge || left.end != right.begin) break;
      if (!merge_windows(left, right, limits_, left)) break;
      std::erase(inserted_, slot.id);
      if (std::find(inserted_.begin(), inserted_.end(), left_id) == inserted_.end()) inserted_.push_back(left_id);
      pool_.release(slot.id);
      slot = slots_[kept - 1];
    }
    slots_[kept++] = slot;
  }
  slots_.resize(kept);
}

void EdgeWindows::write_back(std::vector<Slot>& list, std::size_t first, std::size_t last, const Window& window) {
  // An old window keeps its id for its first part; further parts are copies. Those without a part are freed.
  slots_.clear();
  std::size_t old = first;
  Index last_old = no_index;
  for (const Part& part : parts_) {
    Index id = part.id;
    if (id == newcomer) {
      id = pool_.allocate(window);
      pool_[id].pending = window.halfedge != no_index;
      inserted_.push_back(id);
    } else if (id == last_old) {
      id = pool_.allocate(Window(pool_[id]));
      if (pool_[id].pending) inserted_.push_back(id);
    } else {
      last_old = id;
      while (list[old].id != id) pool_.release(list[old++].id);
      ++old;
    }
    pool_[id].begin = part.begin;
    pool_[id].end = part.end;
    slots_.push_back({part.begin, id});
  }
  for (; old < last; ++old) pool_.release(list[old].id);
  merge_neighbours();

  const std::size_t common = std::min(last - first, slots_.size());
  std::copy_n(slots_.begin(), common, list.begin() + first);
  if (slots_.size() > common) {
    list.insert(list.begin() + first + common, slots_.begin() + common, slots_.end());
  } else {
    list.erase(list.begin() + first + common, list.begin() + last);
  }
}

}  // namespace isopath
