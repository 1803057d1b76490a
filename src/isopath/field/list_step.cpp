#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "isopath/field/list_step.cpp"
// One portable, one common and one wide instruction set on x86-64; more would only cost time to compile.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#include "isopath/field/list_step.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#ifndef ISOPATH_FIELD_SET_BITS
#define ISOPATH_FIELD_SET_BITS
namespace isopath {
namespace {

/// For each byte the places of its set bits in ascending order, four bits a place.
constexpr std::array<std::int64_t, 256> places_of_set_bits() {
  std::array<std::int64_t, 256> places{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    int count = 0;
    for (std::int64_t bit = 0; bit < 8; ++bit) {
      if ((byte >> bit & 1) != 0) places[byte] |= bit << 4 * count++;
    }
  }
  return places;
}
constexpr std::array<std::int64_t, 256> set_bits = places_of_set_bits();

}  // namespace
}  // namespace isopath
#endif

HWY_BEFORE_NAMESPACE();
namespace isopath::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Fixed for all targets: eight doubles at most, as WindowBlock::lanes promises. Sums are not fused (see the tests: all
// targets give the same bits).
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr D d;

V zero() { return hn::Zero(d); }
V all(double value) { return hn::Set(d, value); }
V square(V v) { return hn::Mul(v, v); }

/// Some windows side by side.
struct Windows {
  V begin, end, x, y, offset;
  M line;
  bool any_line;

  Windows(const WindowArrays& a, std::size_t i, M present)
      : begin(hn::LoadU(d, a.begin + i)),
        end(hn::LoadU(d, a.end + i)),
        x(hn::LoadU(d, a.x + i)),
        y(hn::LoadU(d, a.y + i)),
        offset(hn::LoadU(d, a.offset + i)),
        line(hn::And(present, hn::Gt(y, zero()))),
        any_line(!hn::AllFalse(d, line)) {}

  V distance(V at) const {
    const V circle = hn::Add(offset, hn::Sqrt(hn::Add(square(hn::Sub(at, x)), square(y))));
    return any_line ? hn::IfThenElse(line, hn::Add(offset, hn::Mul(x, at)), circle) : circle;
  }
  /// What longer() compares: the square of a circle's way from its source, the way of a straight front.
  V way_to(V at) const {
    const V circle = hn::Add(square(hn::Sub(at, x)), square(y));
    return any_line ? hn::IfThenElse(line, hn::Mul(x, at), circle) : circle;
  }
  M longer(V way, V than) const {
    const M circle = hn::Or(hn::Lt(than, zero()), hn::Gt(way, square(than)));
    return any_line ? hn::Or(hn::And(line, hn::Gt(way, than)), hn::AndNot(line, circle)) : circle;
  }
  M longer_or_equal(V way, V than) const {
    const M circle = hn::Or(hn::Le(than, zero()), hn::Ge(way, square(than)));
    return any_line ? hn::Or(hn::And(line, hn::Ge(way, than)), hn::AndNot(line, circle)) : circle;
  }
  /// Distance of a point beyond the half-edge, straight on.
  V straight_to(V px, V py) const {
    const V circle = hn::Add(offset, hn::Sqrt(hn::Add(square(hn::Sub(px, x)), square(hn::Sub(py, y)))));
    return any_line ? hn::IfThenElse(line, hn::Add(offset, hn::Add(hn::Mul(x, px), hn::Mul(y, py))), circle) : circle;
  }
  /// Direction of travel at a point of the half-edge, of any length.
  V ray_x(V at) const {
    const V circle = hn::Sub(at, x);
    return any_line ? hn::IfThenElse(line, x, circle) : circle;
  }
  V ray_y() const { return hn::Abs(y); }
  /// Length of that direction, within a factor of √2.
  V ray_length(V at) const { return hn::Add(hn::Abs(ray_x(at)), ray_y()); }
};

unsigned bits_of(M mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, mask, bits);
  return bits[0];
}

/// Place of the lowest set bit; past all places of any list when there is none.
std::size_t first_bit(unsigned bits) {
  return bits != 0 ? static_cast<std::size_t>(std::countr_zero(bits)) : std::numeric_limits<std::size_t>::max() / 2;
}

double least_of(V v) { return hn::GetLane(hn::MinOfLanes(d, v)); }

/// How to move the lanes of a mask together. (The library's own way is compiled into a copy of its table at every call,
/// and compressing stores take a hundred cycles on some processors.)
auto packing(M keep) {
  constexpr hn::RebindToSigned<D> ds;
  HWY_ALIGN static constexpr std::int64_t lane_shifts[8] = {0, 4, 8, 12, 16, 20, 24, 28};
  const auto places = hn::Shr(hn::Set(ds, set_bits[bits_of(keep)]), hn::Load(ds, lane_shifts));
  return hn::IndicesFromVec(d, hn::And(places, hn::Set(ds, 7)));
}

/// Stores the kept lanes; roots and errors are those of the windows from `tags` on.
HWY_INLINE std::size_t store(const WindowArrays& to, M keep, V begin, V end, V x, V y, V offset,
                             const WindowArrays& tags) {
  if (hn::AllTrue(d, keep)) {
    hn::StoreU(begin, d, to.begin);
    hn::StoreU(end, d, to.end);
    hn::StoreU(x, d, to.x);
    hn::StoreU(y, d, to.y);
    hn::StoreU(offset, d, to.offset);
    if (tags.root != nullptr) {
      hn::StoreU(hn::LoadU(d, tags.root), d, to.root);
      hn::StoreU(hn::LoadU(d, tags.error), d, to.error);
    }
    return hn::Lanes(d);
  }
  const auto packed = packing(keep);
  hn::StoreU(hn::TableLookupLanes(begin, packed), d, to.begin);
  hn::StoreU(hn::TableLookupLanes(end, packed), d, to.end);
  hn::StoreU(hn::TableLookupLanes(x, packed), d, to.x);
  hn::StoreU(hn::TableLookupLanes(y, packed), d, to.y);
  hn::StoreU(hn::TableLookupLanes(offset, packed), d, to.offset);
  if (tags.root != nullptr) {
    hn::StoreU(hn::TableLookupLanes(hn::LoadU(d, tags.root), packed), d, to.root);
    hn::StoreU(hn::TableLookupLanes(hn::LoadU(d, tags.error), packed), d, to.error);
  }
  return hn::CountTrue(d, keep);
}

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

std::size_t drop_empty(const WindowArrays& windows, std::size_t n) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const M present = hn::FirstN(d, n - i);
    const Windows w(windows, i, present);
    const M keep = hn::And(present, hn::Lt(w.begin, w.end));
    if (kept == i && hn::AllFalse(d, hn::AndNot(keep, present))) {
      kept += std::min(n - i, hn::Lanes(d));
    } else {
      kept += store(windows + kept, keep, w.begin, w.end, w.x, w.y, w.offset, windows + i);
    }
  }
  return kept;
}

double distance(const WindowArrays& w, std::size_t i, double at) {
  return w.y[i] > 0 ? w.offset[i] + w.x[i] * at
                    : w.offset[i] + std::sqrt((at - w.x[i]) * (at - w.x[i]) + w.y[i] * w.y[i]);
}

V indices(std::size_t first) { return hn::Iota(d, static_cast<double>(first)); }

ApexReach reach_apex(const WindowArrays& windows, std::size_t n, const StepGeometry& triangle, double margin,
                     double* side_of_begin, double* side_of_end) {
  ApexReach reach;
  reach.first_right = n;
  const V apex_x = all(triangle.apex.x());
  const V apex_y = all(triangle.apex.y());
  const V rounding = all(triangle.rounding);
  const auto bend = [&](std::size_t i, double at) {
    const double aside = triangle.apex.x() - at;
    const double way = distance(windows, i, at) + std::sqrt(aside * aside + triangle.apex.y() * triangle.apex.y());
    if (way < reach.distance) {
      reach.distance = way;
      reach.x = at;
      reach.window = static_cast<Index>(i);
    }
  };
  // Without branches, which short lists would mispredict one after the other.
  V nearest_lanes = all(infinity);
  V nearest_at = zero();
  std::size_t last_left = 0;  // counted from one: whose beam passes left of the apex
  std::size_t first_right = n;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const M present = hn::FirstN(d, n - i);
    const Windows w(windows, i, present);
    const V at_begin = hn::Sub(hn::Mul(w.ray_x(w.begin), apex_y), hn::Mul(w.ray_y(), hn::Sub(apex_x, w.begin)));
    const V at_end = hn::Sub(hn::Mul(w.ray_x(w.end), apex_y), hn::Mul(w.ray_y(), hn::Sub(apex_x, w.end)));
    hn::StoreU(at_begin, d, side_of_begin + i);
    hn::StoreU(at_end, d, side_of_end + i);
    const M left = hn::And(present, hn::Le(at_begin, zero()));
    const M right = hn::And(present, hn::Ge(at_end, zero()));
    const unsigned left_bits = bits_of(left);
    const unsigned right_bits = bits_of(right);
    reach.n_left += static_cast<std::size_t>(std::popcount(left_bits));
    reach.n_right += static_cast<std::size_t>(std::popcount(right_bits));
    reach.past_left = left_bits != 0 ? i + std::bit_width(left_bits) : reach.past_left;
    const unsigned only_left = left_bits & ~right_bits;
    const unsigned only_right = right_bits & ~left_bits;
    last_left = only_left != 0 ? i + std::bit_width(only_left) : last_left;
    first_right = std::min(first_right, i + first_bit(only_right));
    reach.first_right = std::min(reach.first_right, i + first_bit(right_bits));
    // In lists that overlap, the beams on the two sides of the apex need not be neighbours: each that an apex divides
    // within rounding is bent round.
    const M grazes =
        hn::Or(hn::And(hn::Gt(at_begin, zero()), hn::Le(at_begin, hn::Mul(rounding, w.ray_length(w.begin)))),
               hn::And(hn::Lt(at_end, zero()), hn::Ge(at_end, hn::Neg(hn::Mul(rounding, w.ray_length(w.end))))));
    for (unsigned bits = bits_of(hn::And(present, grazes)); bits != 0; bits &= bits - 1) {
      const std::size_t k = i + first_bit(bits);
      bend(k, side_of_begin[k] > 0 ? windows.begin[k] : windows.end[k]);
    }
    const V way = hn::IfThenElse(hn::And(left, right), w.straight_to(apex_x, apex_y), all(infinity));
    const M nearer = hn::Lt(way, nearest_lanes);
    nearest_at = hn::IfThenElse(nearer, indices(i), nearest_at);
    nearest_lanes = hn::IfThenElse(nearer, way, nearest_lanes);
  }
  const double nearest = least_of(nearest_lanes);
  if (nearest < infinity) {  // the first of those that are equally near
    const V at = hn::IfThenElse(hn::Eq(nearest_lanes, all(nearest)), nearest_at, all(infinity));
    reach.direct = static_cast<Index>(least_of(at));
  }
  if (reach.direct >= 0) {
    const double x = windows.x[reach.direct];
    const double y = windows.y[reach.direct];
    const double ax = triangle.apex.x();
    const double ay = triangle.apex.y();
    const double crossing = y > 0 ? ax - x * (ay / y) : x + (ax - x) * (-y / (ay - y));
    reach.direct_x = std::clamp(crossing, windows.begin[reach.direct], windows.end[reach.direct]);
    reach.beaten_from = nearest + margin;
    if (nearest <= reach.distance) {
      reach.distance = nearest;
      reach.x = reach.direct_x;
      reach.window = reach.direct;
    }
  }
  if (last_left > 0) bend(last_left - 1, windows.end[last_left - 1]);
  if (first_right < n) bend(first_right, windows.begin[first_right]);
  return reach;
}

/// The frame behind one of the two edges that windows leave by: its origin and the direction of its x axis.
struct Frame {
  V x, y, cos, sin, rounding;
  V along(V px, V py) const { return hn::Add(hn::Mul(px, cos), hn::Mul(py, sin)); }
  V across(V px, V py) const { return hn::Sub(hn::Mul(py, cos), hn::Mul(px, sin)); }
};

/// Where the rays through (at, 0) meet the x axis of the frame; `otherwise` where they do not.
V hit(const Windows& w, V at, const Frame& frame, V otherwise) {
  const V px = hn::Sub(at, frame.x);
  const V py = hn::Neg(frame.y);
  const V rx = w.ray_x(at);
  const V ry = w.ray_y();
  const V rise = frame.across(rx, ry);
  const V meets = hn::Sub(frame.along(px, py), hn::Mul(frame.along(rx, ry), hn::Div(frame.across(px, py), rise)));
  return hn::IfThenElse(hn::Gt(rise, zero()), meets, otherwise);
}

/// Stores the children with the intervals [low, high] and returns their number.
std::size_t store_children(const Windows& w, M keep, const Frame& frame, V low, V high, const WindowArrays& tags,
                           const WindowArrays& to, V& least) {
  const V from_x = hn::Sub(w.x, frame.x);
  const V from_y = hn::Sub(w.y, frame.y);
  const V ahead = frame.across(from_x, from_y);
  V x = frame.along(from_x, from_y);
  V y = hn::Min(ahead, zero());
  V offset = w.offset;
  keep = hn::And(keep, hn::Lt(low, high));
  // Of a source ahead of the edge no ray goes through it, whatever tiny edges make of its beam.
  keep = hn::AndNot(hn::AndNot(w.line, hn::Gt(ahead, frame.rounding)), keep);
  const V beside = hn::Max(hn::Max(hn::Sub(low, x), hn::Sub(x, high)), zero());
  V nearest = hn::Add(offset, hn::Sqrt(hn::Add(square(beside), square(y))));
  if (w.any_line) {
    const V line_x = frame.along(w.x, w.y);
    const V line_y = frame.across(w.x, w.y);
    const V line_offset = hn::Add(offset, hn::Add(hn::Mul(w.x, frame.x), hn::Mul(w.y, frame.y)));
    keep = hn::AndNot(hn::And(w.line, hn::Le(line_y, zero())), keep);
    x = hn::IfThenElse(w.line, line_x, x);
    y = hn::IfThenElse(w.line, line_y, y);
    offset = hn::IfThenElse(w.line, line_offset, offset);
    const V front = hn::Add(offset, hn::Min(hn::Mul(x, low), hn::Mul(x, high)));
    nearest = hn::IfThenElse(w.line, front, nearest);
  }
  least = hn::Min(least, hn::IfThenElse(keep, nearest, all(infinity)));
  return store(to, keep, low, high, x, y, offset, tags);
}

std::size_t cross_to_left(const WindowArrays& windows, std::size_t n, const StepGeometry& triangle,
                          const ApexReach& apex, const double* side_of_begin, const double* side_of_end,
                          const WindowArrays& children, double& least) {
  const double length = triangle.left_length;
  const Frame frame{zero(), zero(), all(triangle.apex.x() / length), all(triangle.apex.y() / length),
                    all(triangle.rounding)};
  const V apex_x = all(triangle.apex.x());
  const V apex_y = all(triangle.apex.y());
  const V far = all(length);
  const V direct_x = all(apex.direct_x);
  const V direct = all(apex.direct < 0 ? infinity : apex.direct);
  V nearest = all(infinity);
  std::size_t count = 0;
  for (std::size_t i = 0; i < apex.past_left; i += hn::Lanes(d)) {
    M keep = hn::And(hn::FirstN(d, n - i), hn::Le(hn::LoadU(d, side_of_begin + i), zero()));
    const Windows w(windows, i, keep);
    M to_apex = hn::Ge(hn::LoadU(d, side_of_end + i), zero());
    V end = w.end;
    M beaten = hn::And(hn::And(keep, to_apex), hn::And(hn::Gt(indices(i), direct), hn::Lt(direct_x, end)));
    if (!hn::AllFalse(d, beaten)) {
      beaten = hn::And(beaten, hn::Gt(w.straight_to(apex_x, apex_y), all(apex.beaten_from)));
      end = hn::IfThenElse(beaten, direct_x, end);
      keep = hn::AndNot(hn::And(beaten, hn::Le(direct_x, w.begin)), keep);
      const V side = hn::Sub(hn::Mul(w.ray_x(end), apex_y), hn::Mul(w.ray_y(), hn::Sub(apex_x, end)));
      to_apex = hn::Ge(hn::IfThenElse(beaten, side, hn::LoadU(d, side_of_end + i)), zero());
    }
    const V low = hn::Max(hit(w, w.begin, frame, zero()), zero());
    const V high = hn::IfThenElse(to_apex, far, hn::Min(hit(w, end, frame, far), far));
    count += store_children(w, keep, frame, low, high, windows + i, children + count, nearest);
  }
  least = least_of(nearest);
  return count;
}

std::size_t cross_to_right(const WindowArrays& windows, std::size_t n, const StepGeometry& triangle,
                           const ApexReach& apex, const double* side_of_begin, const double* side_of_end,
                           const WindowArrays& children, double& least) {
  const double length = triangle.right_length;
  const V apex_x = all(triangle.apex.x());
  const V apex_y = all(triangle.apex.y());
  const Frame frame{apex_x, apex_y, all(triangle.right_axis.x()), all(triangle.right_axis.y()), all(triangle.rounding)};
  const V far = all(length);
  const V head = all(triangle.length);
  const V direct_x = all(apex.direct_x);
  const V direct = all(apex.direct);
  V nearest = all(infinity);
  std::size_t count = 0;
  for (std::size_t i = apex.first_right / hn::Lanes(d) * hn::Lanes(d); i < n; i += hn::Lanes(d)) {
    M keep = hn::And(hn::FirstN(d, n - i), hn::Ge(hn::LoadU(d, side_of_end + i), zero()));
    const Windows w(windows, i, keep);
    M from_apex = hn::Le(hn::LoadU(d, side_of_begin + i), zero());
    V begin = w.begin;
    M beaten = hn::And(hn::And(keep, from_apex), hn::And(hn::Lt(indices(i), direct), hn::Gt(direct_x, begin)));
    if (!hn::AllFalse(d, beaten)) {
      beaten = hn::And(beaten, hn::Gt(w.straight_to(apex_x, apex_y), all(apex.beaten_from)));
      begin = hn::IfThenElse(beaten, direct_x, begin);
      keep = hn::AndNot(hn::And(beaten, hn::Ge(direct_x, w.end)), keep);
      const V side = hn::Sub(hn::Mul(w.ray_x(begin), apex_y), hn::Mul(w.ray_y(), hn::Sub(apex_x, begin)));
      from_apex = hn::Le(hn::IfThenElse(beaten, side, hn::LoadU(d, side_of_begin + i)), zero());
    }
    const V low = hn::IfThenElse(from_apex, zero(), hn::Max(hit(w, begin, frame, zero()), zero()));
    const V high = hn::IfThenElse(hn::Eq(w.end, head), far, hn::Min(hit(w, w.end, frame, far), far));
    count += store_children(w, keep, frame, low, high, windows + i, children + count, nearest);
  }
  least = least_of(nearest);
  return count;
}

}  // namespace
}  // namespace isopath::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isopath {

HWY_EXPORT(trim_by_vertices);
HWY_EXPORT(trim_by_neighbours);
HWY_EXPORT(drop_empty);
HWY_EXPORT(reach_apex);
HWY_EXPORT(cross_to_left);
HWY_EXPORT(cross_to_right);

std::size_t trim_by_vertices(const WindowArrays& windows, std::size_t n, double length, double at_tail, double at_head,
                             double margin) {
  return HWY_DYNAMIC_DISPATCH(trim_by_vertices)(windows, n, length, at_tail, at_head, margin);
}
bool trim_by_neighbours(const WindowArrays& windows, std::size_t n, double margin, double* begin, double* end) {
  return HWY_DYNAMIC_DISPATCH(trim_by_neighbours)(windows, n, margin, begin, end);
}
std::size_t drop_empty(const WindowArrays& windows, std::size_t n) {
  return HWY_DYNAMIC_DISPATCH(drop_empty)(windows, n);
}
ApexReach reach_apex(const WindowArrays& windows, std::size_t n, const StepGeometry& triangle, double margin,
                     double* side_of_begin, double* side_of_end) {
  return HWY_DYNAMIC_DISPATCH(reach_apex)(windows, n, triangle, margin, side_of_begin, side_of_end);
}
std::size_t cross_to_left(const WindowArrays& windows, std::size_t n, const StepGeometry& triangle,
                          const ApexReach& apex, const double* side_of_begin, const double* side_of_end,
                          const WindowArrays& children, double& least) {
  return HWY_DYNAMIC_DISPATCH(cross_to_left)(windows, n, triangle, apex, side_of_begin, side_of_end, children, least);
}
std::size_t cross_to_right(const WindowArrays& windows, std::size_t n, const StepGeometry& triangle,
                           const ApexReach& apex, const double* side_of_begin, const double* side_of_end,
                           const WindowArrays& children, double& least) {
  return HWY_DYNAMIC_DISPATCH(cross_to_right)(windows, n, triangle, apex, side_of_begin, side_of_end, children, least);
}

}  // namespace isopath
#endif
