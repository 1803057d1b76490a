#include "isopath/field/edge_envelope.h"

#include <algorithm>

namespace isopath {
namespace {

/// Distances carry a rounding error of a few units in the last place; a difference below it decides nothing.
constexpr double tie_rounding = 1e-15;
/// A path along an edge must not displace a front that reaches the same points a hair's breadth beside it (see
/// Window::filler).
constexpr double filler_margin = 1e-12;

/// True when `window` is to replace `old` around x.
bool beats(const Window& window, const Window& old, double x) {
  const double mine = window.distance(x);
  const double theirs = old.distance(x);
  if (window.filler == old.filler) return mine < theirs - tie_rounding * theirs;
  const double margin = filler_margin * theirs + window.error + old.error;
  return mine < theirs - (window.filler ? margin : -margin);
}

}  // namespace

void EdgeEnvelope::reset(double length, double snap) {
  length_ = length;
  snap_ = snap;
  windows_.clear();
}

void EdgeEnvelope::append(double begin, double end, Index old) {
  if (end <= begin) return;
  if (!parts_.empty() && parts_.back().old == old && parts_.back().end == begin) {
    parts_.back().end = end;
  } else {
    parts_.push_back({begin, end, old});
  }
}

void EdgeEnvelope::divide_overlap(Index old_id, const Window& window, double low, double high) {
  const Window& old = windows_[old_id];
  // Both distances have slope at most 1: far enough apart at the ends, they do not meet in between.
  const double apart = 0.5 * (window.distance(low) - old.distance(low) + window.distance(high) - old.distance(high));
  if (std::abs(apart) > (high - low) + filler_margin * old.distance(low))
    return append(low, high, apart < 0 ? newcomer : old_id);
  const Ties ties = ties_between(old, window, low + snap_, high - snap_);
  double from = low;
  for (int i = 0; i <= ties.count; ++i) {
    const double to = i < ties.count ? ties.x[i] : high;
    append(from, to, beats(window, old, 0.5 * (from + to)) ? newcomer : old_id);
    from = to;
  }
}

void EdgeEnvelope::insert(const Window& window) {
  Window w = window;
  if (w.begin < snap_) w.begin = 0;
  if (w.end > length_ - snap_) w.end = length_;
  if (w.end - w.begin < std::min(snap_, length_)) return;
  if (windows_.empty() || w.begin > windows_.back().end + snap_) {
    windows_.push_back(w);
    return;
  }
  const auto starts_after = [](double x, const Window& other) { return x < other.begin; };
  auto first = static_cast<std::size_t>(
      std::upper_bound(windows_.begin(), windows_.end(), w.begin - snap_, starts_after) - windows_.begin());
  if (first > 0 && windows_[first - 1].end >= w.begin - snap_) --first;
  parts_.clear();
  double x = w.begin;
  std::size_t past = first;
  for (; past < windows_.size() && windows_[past].begin <= w.end + snap_; ++past) {
    const auto old = static_cast<Index>(past);
    const double old_begin = windows_[past].begin;
    const double old_end = windows_[past].end;
    if (old_begin > x) append(x, old_begin, newcomer);
    if (old_begin < w.begin) append(old_begin, std::min(old_end, w.begin), old);
    const double low = std::max(old_begin, w.begin);
    const double high = std::min(old_end, w.end);
    if (low < high) divide_overlap(old, w, low, high);
    if (old_end > w.end) append(std::max(old_begin, w.end), old_end, old);
    x = std::max(x, old_end);
  }
  if (x < w.end) append(x, w.end, newcomer);
  if (std::none_of(parts_.begin(), parts_.end(), [](const Part& p) { return p.old == newcomer; })) return;
  absorb_narrow_parts();
  write_back(first, past, w);
}

void EdgeEnvelope::absorb_narrow_parts() {
  // Close hair cracks between parts, then give parts below the snap width to a neighbour.
  for (std::size_t i = 1; i < parts_.size(); ++i) {
    const double crack = parts_[i].begin - parts_[i - 1].end;
    if (crack > 0 && crack <= snap_) parts_[i].begin = parts_[i - 1].end;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part part = parts_[i];
    if (kept > 0 && parts_[kept - 1].end == part.begin) {
      Part& left = parts_[kept - 1];
      if (left.old == part.old || part.end - part.begin < snap_) {
        left.end = part.end;
        continue;
      }
      if (left.end - left.begin < snap_) {
        left.old = part.old;
        left.end = part.end;
        continue;
      }
    }
    parts_[kept++] = part;
  }
  parts_.resize(kept);
}

void EdgeEnvelope::write_back(std::size_t first, std::size_t past, const Window& window) {
  replaced_.clear();
  for (const Part& part : parts_) {
    Window& w = replaced_.emplace_back(part.old == newcomer ? window : windows_[part.old]);
    w.begin = part.begin;
    w.end = part.end;
  }
  const std::size_t common = std::min(past - first, replaced_.size());
  std::copy_n(replaced_.begin(), common, windows_.begin() + first);
  if (replaced_.size() > common) {
    windows_.insert(windows_.begin() + first + common, replaced_.begin() + common, replaced_.end());
  } else {
    windows_.erase(windows_.begin() + first + common, windows_.begin() + past);
  }
}

bool EdgeEnvelope::is_continuous(double at_tail, double at_head) const {
  if (windows_.empty() || windows_.front().begin != 0 || windows_.back().end != length_) return false;
  const auto agree = [](double a, double b) { return std::abs(a - b) <= filler_margin * a; };
  if (!agree(windows_.front().distance(0), at_tail) || !agree(windows_.back().distance(length_), at_head)) return false;
  for (std::size_t i = 1; i < windows_.size(); ++i) {
    const double x = windows_[i].begin;
    if (windows_[i - 1].end != x || !agree(windows_[i - 1].distance(x), windows_[i].distance(x))) return false;
  }
  return true;
}

void EdgeEnvelope::merge(const MergeLimits& limits) {
  std::size_t kept = 0;
  for (const Window& next : windows_) {
    Window window = next;
    for (; kept > 0; --kept) {
      const Window& left = windows_[kept - 1];
      if (left.filler || window.filler || left.halfedge != window.halfedge || left.end != window.begin) break;
      if (!merge_windows(left, window, limits, window)) break;
    }
    windows_[kept++] = window;
  }
  windows_.resize(kept);
}

}  // namespace isopath
