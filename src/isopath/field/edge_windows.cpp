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
  double margin = rounding;
  if (window.filler && !old.filler) margin = filler_margin;
  if (!window.filler && old.filler) margin = -filler_margin;
  return mine < theirs - margin * theirs;
}

}  // namespace

EdgeWindows::EdgeWindows(std::vector<double> edge_length, std::vector<double> snap)
    : head_(edge_length.size(), no_index), length_(std::move(edge_length)), snap_(std::move(snap)) {}

Index EdgeWindows::allocate(const Window& window) {
  if (!free_.empty()) {
    const Index id = free_.back();
    free_.pop_back();
    windows_[id] = window;
    return id;
  }
  windows_.push_back(window);
  return static_cast<Index>(windows_.size()) - 1;
}

void EdgeWindows::append(double begin, double end, Index id) {
  if (end <= begin) return;
  if (!parts_.empty() && parts_.back().id == id && parts_.back().end == begin) {
    parts_.back().end = end;
  } else {
    parts_.push_back({begin, end, id});
  }
}

void EdgeWindows::divide_overlap(const Window& old, Index old_id, const Window& window, double low, double high,
                                 double snap) {
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
  const double snap = snap_[edge];
  Window w = window;
  if (w.begin < snap) w.begin = 0;
  if (w.end > length_[edge] - snap) w.end = length_[edge];
  if (w.end - w.begin < snap && w.end - w.begin < length_[edge]) return inserted_;

  Index before = no_index;
  Index current = head_[edge];
  while (current != no_index && windows_[current].end < w.begin - snap) {
    before = current;
    current = windows_[current].next;
  }
  parts_.clear();
  displaced_.clear();
  double x = w.begin;
  for (; current != no_index && windows_[current].begin <= w.end + snap; current = windows_[current].next) {
    const Window& old = windows_[current];
    displaced_.push_back(current);
    if (old.begin > x) append(x, old.begin, newcomer);
    if (old.begin < w.begin) append(old.begin, std::min(old.end, w.begin), current);
    const double low = std::max(old.begin, w.begin);
    const double high = std::min(old.end, w.end);
    if (low < high) divide_overlap(old, current, w, low, high, snap);
    if (old.end > w.end) append(std::max(old.begin, w.end), old.end, current);
    x = std::max(x, old.end);
  }
  if (x < w.end) append(x, w.end, newcomer);
  if (std::none_of(parts_.begin(), parts_.end(), [](const Part& p) { return p.id == newcomer; })) return inserted_;
  absorb_narrow_parts(snap);
  write_back(edge, before, current, w);
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

void EdgeWindows::write_back(Index edge, Index before, Index after, const Window& window) {
  // An old window keeps its id for its first part; further parts are copies.
  const auto link = [&](Index id) {
    (before == no_index ? head_[edge] : windows_[before].next) = id;
    before = id;
  };
  std::vector<Index>& unused = displaced_;
  std::size_t used_old = 0;
  Index last_old = no_index;
  for (const Part& part : parts_) {
    Index id = part.id;
    if (id == newcomer) {
      id = allocate(window);
      windows_[id].pending = window.halfedge != no_index;
      inserted_.push_back(id);
    } else if (id == last_old) {
      id = allocate(Window(windows_[id]));
      if (windows_[id].pending) inserted_.push_back(id);
    } else {
      last_old = id;
      // parts keep the order of the list, so the unused ids are those skipped over
      while (unused[used_old] != id) free_.push_back(unused[used_old++]);
      ++used_old;
    }
    windows_[id].begin = part.begin;
    windows_[id].end = part.end;
    link(id);
  }
  for (; used_old < unused.size(); ++used_old) free_.push_back(unused[used_old]);
  (before == no_index ? head_[edge] : windows_[before].next) = after;
}

}  // namespace isopath
