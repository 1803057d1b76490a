#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "isopath/field/angles.cpp"
#include "isopath/field/angles.h"
#include "isopath/field/list_targets.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include <iterator>
#include <limits>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace isopath::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
constexpr D d;

/// (atan(t) / t - 1) / t² as a polynomial of t²: its interpolation at the Chebyshev nodes of [0, tan²(π/8)], off by
/// 5e-18 of atan(t).
constexpr double arc_tangent[] = {-0.3333333333333333,  0.1999999999999552,   -0.14285714284666534, 0.11111111015255669,
                                  -0.09090904578095735, 0.07692183190171728,  -0.06664511438164644, 0.05858148832731273,
                                  -0.05085449318930035, 0.039231646190551486, -0.019176872294336067};

V all(double value) { return hn::Set(d, value); }

/// Angles of vectors with y >= 0. The arcus tangent of the smaller coordinate by the larger one, which is in [0, π/4],
/// is found in [-π/8, π/8].
V angle_of(V x, V y) {
  const V run = hn::Abs(x);
  const V less = hn::Min(run, y);
  const V more = hn::Max(run, y);
  const auto turned = hn::Gt(less, hn::Mul(more, all(std::numbers::sqrt2 - 1)));  // by -π/4
  const V up = hn::IfThenElse(turned, hn::Sub(less, more), less);
  const V down = hn::IfThenElse(turned, hn::Add(less, more), hn::Max(more, all(std::numeric_limits<double>::min())));
  const V t = hn::Div(up, down);
  const V t2 = hn::Mul(t, t);
  V sum = all(0);
  for (auto c = std::rbegin(arc_tangent); c != std::rend(arc_tangent); ++c) sum = hn::Add(hn::Mul(sum, t2), all(*c));
  V angle = hn::Add(t, hn::Mul(t, hn::Mul(t2, sum)));
  angle = hn::IfThenElse(turned, hn::Add(all(0.25 * std::numbers::pi), angle), angle);
  angle = hn::IfThenElse(hn::Gt(y, run), hn::Sub(all(0.5 * std::numbers::pi), angle), angle);
  return hn::IfThenElse(hn::Lt(x, all(0)), hn::Sub(all(std::numbers::pi), angle), angle);
}

void angles_of(const double* vectors, std::size_t n, double* angles) {
  std::size_t i = 0;
  V x, y;
  for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
    hn::LoadInterleaved2(d, vectors + 2 * i, x, y);
    hn::StoreU(angle_of(x, y), d, angles + i);
  }
  for (; i < n; ++i) angles[i] = hn::GetLane(angle_of(all(vectors[2 * i]), all(vectors[2 * i + 1])));
}

}  // namespace
}  // namespace isopath::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isopath {

HWY_EXPORT(angles_of);

void angles_of(std::span<const Vec2> vectors, std::span<double> angles) {
  static_assert(sizeof(Vec2) == 2 * sizeof(double));
  if (vectors.empty()) return;
  HWY_DYNAMIC_DISPATCH(angles_of)(vectors.front().data(), vectors.size(), angles.data());
}

}  // namespace isopath
#endif
