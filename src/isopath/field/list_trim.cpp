#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "isopath/field/list_trim.cpp"
#include "isopath/field/list_trim.h"
#include "isopath/field/list_targets.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>
#include <algorithm>

#include "isopath/field/list_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace isopath::HWY_NAMESPACE {
namespace {

std::size_t trim_by_vertices(const WindowArrays& windows, std::size_t n, double length, double at_tail, double at_head,
                             double margin) {
  // D(tail) + x and D(head) + length - x against the window's distance at x: along the edge the latter changes by one
  // at most, so there is one tie, and what lies between it and the vertex is cut.
  const V tail = all(at_tail);
  const V head = all(at_head + length);
  const V slack = all(margin);
  const V two = all(2);
  const V one = all(1);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const M present = hn::FirstN(d, n - i);
    const Windows w(windows, i, present);
    const V to_begin = w.way_to(w.begin);
    const V to_end = w.way_to(w.end);
    const V rest_tail = hn::Sub(hn::Add(tail, slack), w.offset);
    const V rest_head = hn::Sub(hn::Add(head, slack), w.offset);
    const M lost = hn::Or(w.longer(to_end, hn::Add(rest_tail, w.end)), w.longer(to_begin, hn::Sub(rest_head, w.begin)));
    const M by_tail = w.longer(to_begin, hn::Add(rest_tail, w.begin));
    const M by_head = w.longer(to_end, hn::Sub(rest_head, w.end));
    V begin = w.begin;
    V end = w.end;
    const M present_and_cut = hn::AndNot(lost, hn::And(present, hn::Or(by_tail, by_head)));
    if (!hn::AllFalse(d, present_and_cut)) {
      // How far each tie is from its vertex. Of a source next to the vertex that is known only when measured from
      // there.
      const V far = all(length);
      const V beyond = hn::Sub(far, w.x);
      const V from_tail = hn::Sub(tail, w.offset);
      const V from_head = hn::Sub(all(at_head), w.offset);
      V tail_up = hn::Add(hn::Mul(hn::Sub(w.x, from_tail), hn::Add(w.x, from_tail)), square(w.y));
      V tail_down = hn::Mul(two, hn::Add(from_tail, w.x));
      V head_up = hn::Add(hn::Mul(hn::Sub(beyond, from_head), hn::Add(beyond, from_head)), square(w.y));
      V head_down = hn::Mul(two, hn::Add(from_head, beyond));
      if (w.any_line) {
        tail_up = hn::IfThenElse(w.line, hn::Neg(from_tail), tail_up);
        tail_down = hn::IfThenElse(w.line, hn::Sub(one, w.x), tail_down);
        head_up = hn::IfThenElse(w.line, hn::Sub(hn::Mul(w.x, far), from_head), head_up);
        head_down = hn::IfThenElse(w.line, hn::Add(one, w.x), head_down);
      }
      const M cut_tail = hn::And(by_tail, hn::Gt(tail_down, zero()));
      const M cut_head = hn::And(by_head, hn::Gt(head_down, zero()));
      const V tie_tail = hn::Div(tail_up, hn::IfThenElse(cut_tail, tail_down, one));
      const V tie_head = hn::Sub(far, hn::Div(head_up, hn::IfThenElse(cut_head, head_down, one)));
      begin = hn::IfThenElse(cut_tail, hn::Max(begin, hn::Min(tie_tail, end)), begin);
      end = hn::IfThenElse(cut_head, hn::Min(w.end, hn::Max(tie_head, w.begin)), end);
    }
    const M drop = hn::Or(lost, hn::Ge(begin, end));
    if (kept == i && hn::AllFalse(d, hn::And(present, drop))) {  // mostly; all stay where they are
      if (!hn::AllFalse(d, present_and_cut)) {
        hn::StoreU(begin, d, windows.begin + i);
        hn::StoreU(end, d, windows.end + i);
      }
      kept += std::min(n - i, hn::Lanes(d));
    } else {
      kept += store(windows + kept, hn::AndNot(drop, present), begin, end, w.x, w.y, w.offset, windows + i);
    }
  }
  return kept;
}

struct Winners {
  M a, b;
};
/// Which of two is nearer by more than the slack at a point of the half-edge.
Winners winners(const Windows& a, const Windows& b, V at, V slack, M present) {
  const V b_way = b.distance(at);
  const V rest = hn::Sub(b_way, a.offset);
  const V way = a.way_to(at);
  const V below = hn::Sub(rest, slack);
  const V above = hn::Add(rest, slack);
  return {hn::AndNot(a.longer_or_equal(way, below), present), hn::And(present, a.longer(way, above))};
}

/// Most lists overlap only at ridges, two by two; there, the vertices do the work sooner or later.
bool lie_three_deep(const WindowArrays& windows, std::size_t n) {
  std::size_t crowded = 0;
  for (std::size_t i = 0; i + 2 < n; i += hn::Lanes(d)) {
    const M triples = hn::FirstN(d, n - 2 - i);
    crowded +=
        hn::CountTrue(d, hn::And(triples, hn::Gt(hn::LoadU(d, windows.end + i), hn::LoadU(d, windows.begin + i + 2))));
  }
  return 4 * crowded >= n;
}

bool trim_by_neighbours(const WindowArrays& windows, std::size_t n, double margin, double* begin, double* end) {
  if (!lie_three_deep(windows, n)) return false;
  const V slack = all(margin);
  begin[0] = windows.begin[0];
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const M pairs = hn::FirstN(d, n - 1 - i);
    const Windows a(windows, i, pairs);      // the left one of each pair
    const Windows b(windows, i + 1, pairs);  // the right one
    V end_a = a.end;
    V begin_b = b.begin;
    const V low = hn::Max(a.begin, b.begin);
    const V high = hn::Min(a.end, b.end);
    const M overlap = hn::And(pairs, hn::Lt(low, high));
    if (!hn::AllFalse(d, overlap)) {
      const auto [a_wins_low, b_wins_low] = winners(a, b, low, slack, overlap);
      const auto [a_wins_high, b_wins_high] = winners(a, b, high, slack, overlap);
      // positive where the ray of a comes from the left of that of b
      const V low_order = hn::Sub(hn::Mul(a.ray_x(low), b.ray_y()), hn::Mul(a.ray_y(), b.ray_x(low)));
      const V high_order = hn::Sub(hn::Mul(a.ray_x(high), b.ray_y()), hn::Mul(a.ray_y(), b.ray_x(high)));
      const M low_ordered = hn::Gt(low_order, zero());
      const M high_ordered = hn::Gt(high_order, zero());
      const M low_crossed = hn::Lt(low_order, zero());
      const M high_crossed = hn::Lt(high_order, zero());
      // Where the line through both sources meets the edge, rays of the lower source pass the upper one: the rays
      // beyond do not cross its way to the end of the overlap.
      const V passing = hn::Add(a.x, hn::Div(hn::Mul(hn::Sub(b.x, a.x), hn::Neg(a.y)), hn::Sub(b.y, a.y)));
      const M a_not_lower = hn::Ge(a.y, b.y);
      const M b_not_lower = hn::Ge(b.y, a.y);
      M cut_a = hn::And(hn::And(b_wins_low, low_ordered), hn::Or(a_not_lower, hn::Ge(passing, a.end)));
      M cut_b = hn::And(hn::And(a_wins_high, high_ordered), hn::Or(b_not_lower, hn::Le(passing, b.begin)));
      M lose_a = hn::And(hn::And(b_wins_high, high_crossed),
                         hn::And(hn::Eq(high, a.end), hn::Or(a_not_lower, hn::Le(passing, a.begin))));
      M lose_b = hn::And(hn::And(a_wins_low, low_crossed),
                         hn::And(hn::Eq(low, b.begin), hn::Or(b_not_lower, hn::Ge(passing, b.end))));
      if (a.any_line || b.any_line) {
        // The difference of the two grows along the overlap, or falls: who wins at one end then wins at both.
        const M line = hn::Or(a.line, b.line);
        const M grows = hn::And(low_ordered, high_ordered);
        const M falls = hn::And(low_crossed, high_crossed);
        const M b_wins = hn::Or(hn::And(grows, b_wins_low), hn::And(falls, b_wins_high));
        const M a_wins = hn::Or(hn::And(grows, a_wins_high), hn::And(falls, a_wins_low));
        cut_a = hn::Or(hn::AndNot(line, cut_a), hn::And(line, hn::And(b_wins, hn::Eq(high, a.end))));
        cut_b = hn::Or(hn::AndNot(line, cut_b), hn::And(line, hn::And(a_wins, hn::Eq(low, b.begin))));
        lose_a = hn::AndNot(line, lose_a);
        lose_b = hn::AndNot(line, lose_b);
      }
      end_a = hn::IfThenElse(cut_a, low, end_a);
      end_a = hn::IfThenElse(lose_a, a.begin, end_a);
      begin_b = hn::IfThenElse(cut_b, high, begin_b);
      begin_b = hn::IfThenElse(lose_b, b.end, begin_b);
    }
    hn::StoreU(end_a, d, end + i);
    hn::StoreU(begin_b, d, begin + i + 1);
  }
  return true;
}

std::size_t set_intervals(const WindowArrays& windows, std::size_t n, const double* begin, const double* end) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const M present = hn::FirstN(d, n - i);
    const V low = hn::LoadU(d, begin + i);
    const V high = hn::LoadU(d, end + i);
    const M keep = hn::And(present, hn::Lt(low, high));
    if (kept == i && hn::AllFalse(d, hn::AndNot(keep, present))) {
      hn::StoreU(low, d, windows.begin + i);
      hn::StoreU(high, d, windows.end + i);
      kept += std::min(n - i, hn::Lanes(d));
    } else {
      const Windows w(windows, i, present);
      kept += store(windows + kept, keep, low, high, w.x, w.y, w.offset, windows + i);
    }
  }
  return kept;
}

/// Copies n windows, and up to a vector's places behind them in each array.
void copy(const WindowArrays& from, std::size_t n, const WindowArrays& to) {
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const auto copy_lanes = [i](const double* a, double* b) { hn::StoreU(hn::LoadU(d, a + i), d, b + i); };
    copy_lanes(from.begin, to.begin);
    copy_lanes(from.end, to.end);
    copy_lanes(from.x, to.x);
    copy_lanes(from.y, to.y);
    copy_lanes(from.offset, to.offset);
    if (from.root == nullptr) continue;
    copy_lanes(from.root, to.root);
    copy_lanes(from.error, to.error);
  }
}

/// How many of the n numbers from `first` on come before one that reaches the limit; with `or_equal`, that exceeds it.
std::size_t count_below(const double* first, std::size_t n, double limit, bool or_equal) {
  const V border = all(limit);
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const V at = hn::LoadU(d, first + i);
    const M behind = hn::And(hn::FirstN(d, n - i), or_equal ? hn::Gt(at, border) : hn::Ge(at, border));
    if (!hn::AllFalse(d, behind)) return i + first_bit(bits_of(behind));
  }
  return n;
}

void merge_lists(const WindowArrays& a, std::size_t n_a, const WindowArrays& b, std::size_t n_b,
                 const WindowArrays& to) {
  // Lists from two sides hardly interleave: they are merged run by run, a few in all.
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < n_a && j < n_b) {
    const std::size_t from_a = count_below(a.begin + i, n_a - i, b.begin[j], true);
    copy(a + i, from_a, to + (i + j));
    i += from_a;
    if (i == n_a) break;
    const std::size_t from_b = count_below(b.begin + j, n_b - j, a.begin[i], false);
    copy(b + j, from_b, to + (i + j));
    j += from_b;
  }
  copy(a + i, n_a - i, to + (i + j));
  copy(b + j, n_b - j, to + (n_a + j));
}

}  // namespace
}  // namespace isopath::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isopath {

HWY_EXPORT(merge_lists);
HWY_EXPORT(trim_by_vertices);
HWY_EXPORT(trim_by_neighbours);
HWY_EXPORT(set_intervals);

std::size_t trim_by_vertices(const WindowArrays& windows, std::size_t n, double length, double at_tail, double at_head,
                             double margin) {
  return HWY_DYNAMIC_DISPATCH(trim_by_vertices)(windows, n, length, at_tail, at_head, margin);
}
bool trim_by_neighbours(const WindowArrays& windows, std::size_t n, double margin, double* begin, double* end) {
  return HWY_DYNAMIC_DISPATCH(trim_by_neighbours)(windows, n, margin, begin, end);
}
std::size_t set_intervals(const WindowArrays& windows, std::size_t n, const double* begin, const double* end) {
  return HWY_DYNAMIC_DISPATCH(set_intervals)(windows, n, begin, end);
}
void merge_lists(const WindowArrays& a, std::size_t n_a, const WindowArrays& b, std::size_t n_b,
                 const WindowArrays& to) {
  return HWY_DYNAMIC_DISPATCH(merge_lists)(a, n_a, b, n_b, to);
}

}  // namespace isopath
#endif
