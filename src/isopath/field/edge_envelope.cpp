#include "isopath/field/edge_envelope.h"

#include <algorithm>
#include <cmath>

namespace isopath {
namespace {

/// Distances carry a rounding error of a few units in the last place; a difference below it decides nothing.
constexpr double tie_rounding = 1e-15;
/// A path along an edge must not displace a front that reaches the same points a hair's breadth beside it (see
/// Window::filler).
constexpr double filler_margin = 1e-12;
/// A source beside the edge sends many directions through a small part of it. A window is nothing only when it is also
/// this narrow as seen from its source.
constexpr double least_angle = 0.01;
/// Rounding moves the ray at which two fronts meet by at most this part of the edge.
constexpr double widest_hair = 1e-3;
/// Enough to find a place on an edge to a rounding error.
constexpr int halvings = 50;
/// Two fronts agree where they differ by less than this part of the distance, and by less than the snap width.
constexpr double agreement = 1e-10;

/// True when `window` is to replace `old` around x.
bool beats(const Window& window, const Window& old, double x) {
  const double mine = window.distance(x);
  const double theirs = old.distance(x);
  if (window.filler == old.filler) return mine < theirs - tie_rounding * theirs;
  const double margin = filler_margin * theirs + window.error + old.error;
  return mine < theirs - (window.filler ? margin : -margin);
}

/// True when `window` is to replace `old` all the way between two ties. Far from both sources they may seem equally far
/// where next to them they are not.
bool beats_between(const Window& window, const Window& old, double low, double high) {
  const double middle = 0.5 * (low + high);
  const double nothing = tie_rounding * old.distance(middle);
  const auto lead = [&](double x) { return old.distance(x) - window.distance(x); };
  double most = lead(middle);
  if (std::abs(most) > nothing) return most > 0;
  for (const double x : {low, high}) {
    if (const double here = lead(x); std::abs(here) > std::abs(most)) most = here;
  }
  return most > nothing;
}

}  // namespace

void EdgeEnvelope::reset(double length, double snap) {
  length_ = length;
  snap_ = snap;
  windows_.clear();
}

double EdgeEnvelope::least_width(const Window& window) const {
  if (window.filler || window.kind == Window::Kind::line) return snap_;
  return std::min(snap_, least_angle * std::abs(window.source.y()));
}

bool EdgeEnvelope::is_narrow(const Window& window, double width) const {
  return width < snap_ && width < least_width(window);
}

bool EdgeEnvelope::is_pinhole(const Window& window) const {
  return !window.filler && window.kind == Window::Kind::point && window.end - window.begin < snap_;
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
  if (is_pinhole(window) != is_pinhole(old)) {
    const double longer = is_pinhole(window) ? apart : -apart;
    return append(low, high, (longer < snap_) == is_pinhole(window) ? newcomer : old_id);
  }
  const Ties ties = ties_between(old, window, low + snap_, high - snap_);
  double from = low;
  for (int i = 0; i <= ties.count; ++i) {
    const double to = i < ties.count ? ties.x[i] : high;
    if (window.filler || old.filler) {
      divide_by_margin(old_id, window, from, to);
    } else {
      append(from, to, beats_between(window, old, from, to) ? newcomer : old_id);
    }
    from = to;
  }
}

void EdgeEnvelope::divide_by_margin(Index old_id, const Window& window, double low, double high) {
  const Window& old = windows_[old_id];
  const double middle = 0.5 * (low + high);
  const bool wins = beats(window, old, middle);
  // Where, going from the middle to this end, the winner changes with a jump.
  const auto change = [&](double end) {
    if (beats(window, old, end) == wins || std::abs(window.distance(end) - old.distance(end)) <= snap_) return end;
    double winning = middle;
    double losing = end;
    for (int k = 0; k < halvings; ++k) {
      const double x = 0.5 * (winning + losing);
      (beats(window, old, x) == wins ? winning : losing) = x;
    }
    return winning;
  };
  const double from = change(low);
  const double to = change(high);
  append(low, from, wins ? old_id : newcomer);
  append(from, to, wins ? newcomer : old_id);
  append(to, high, wins ? old_id : newcomer);
}

void EdgeEnvelope::insert(const Window& window) {
  Window w = window;
  const double reach = is_pinhole(window) ? 0 : snap_;
  if (w.begin < reach) w.begin = 0;
  if (w.end > length_ - reach) w.end = length_;
  if (!(w.begin < w.end) || w.end - w.begin < least_width(w)) return;
  if (windows_.empty() || w.begin > windows_.back().end + snap_) {
    windows_.push_back(w);
    return;
  }
  if (const Window& last = windows_.back(); w.begin >= last.end && !is_narrow(last, last.end - last.begin)) {
    w.begin = last.end;  // most come one after the other
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
  absorb_narrow_parts(w);
  write_back(first, past, w);
}

void EdgeEnvelope::absorb_narrow_parts(const Window& window) {
  // Close hair cracks between parts, then give parts below the snap width to a neighbour.
  for (std::size_t i = 1; i < parts_.size(); ++i) {
    const double crack = parts_[i].begin - parts_[i - 1].end;
    if (crack > 0 && crack <= snap_) parts_[i].begin = parts_[i - 1].end;
  }
  const auto is_narrow = [&](const Part& part) {
    return this->is_narrow(part.old == newcomer ? window : windows_[part.old], part.end - part.begin);
  };
  std::size_t kept = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part part = parts_[i];
    if (kept > 0 && parts_[kept - 1].end == part.begin) {
      Part& left = parts_[kept - 1];
      if (left.old == part.old || is_narrow(part)) {
        left.end = part.end;
        continue;
      }
      if (is_narrow(left)) {
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

Window along_edge(double place, double length, double distance, double error, Index root) {
  Window window;
  window.end = length;
  window.source = Vec2(place, 0);
  window.offset = distance;
  window.error = error;
  window.root = root;
  window.filler = true;
  return window;
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

bool EdgeEnvelope::jumps(const Window& left, const Window& right, double x) const {
  const double a = left.distance(x);
  const double b = right.distance(x);
  return std::abs(a - b) > agreement * std::min(a, b) + snap_ + left.error + right.error;
}

void EdgeEnvelope::close_jumps() {
  closing_.clear();
  for (std::size_t i = 1; i < windows_.size(); ++i) {
    const Window& left = windows_[i - 1];
    const Window& right = windows_[i];
    if (left.end == right.begin && !jumps(left, right, left.end)) continue;
    const auto closes = [&](const Window& a, const Window& b) {  // from the end of a to the begin of b
      return !a.filler && !b.filler && b.begin - a.end <= widest_hair * length_ && !jumps(a, b, a.end) &&
             !jumps(a, b, b.begin);
    };
    const bool left_is_nearer = left.distance(left.end) < right.distance(right.begin);
    if (left_is_nearer && i + 1 < windows_.size() && closes(left, windows_[i + 1])) {
      Window& on = closing_.emplace_back(left);
      on.begin = left.end;
      on.end = windows_[i + 1].begin;
    } else if (!left_is_nearer && i > 1 && closes(windows_[i - 2], right)) {
      Window& on = closing_.emplace_back(right);
      on.begin = windows_[i - 2].end;
      on.end = right.begin;
    }
    const Window& nearer = left_is_nearer ? left : right;
    const double x = left_is_nearer ? left.end : right.begin;
    closing_.push_back(along_edge(x, length_, nearer.distance(x), nearer.error, nearer.root));
  }
  for (const Window& window : closing_) insert(window);
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
