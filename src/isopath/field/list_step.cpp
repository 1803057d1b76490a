#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "isopath/field/list_step.cpp"
#include "isopath/field/list_step.h"
#include "isopath/field/list_targets.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>
#include <algorithm>
#include <bit>
#include <cmath>

#include "isopath/field/list_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace isopath::HWY_NAMESPACE {
namespace {

double least_of(V v) { return hn::GetLane(hn::MinOfLanes(d, v)); }

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

HWY_EXPORT(reach_apex);
HWY_EXPORT(cross_to_left);
HWY_EXPORT(cross_to_right);

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
