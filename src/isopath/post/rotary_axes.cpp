#include "isopath/post/rotary_axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "isopath/core/error.h"

namespace isopath {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

// Nearer to Z than this the axis is Z: three decades below the accuracy of the angles in a program.
constexpr double pole = 1e-9;

// Turning costs this much less in the air, where it leaves no mark, so that it is put there.
constexpr double weight_in_air = 0.01;

struct State {
  RotaryAngles angles;
  double cost = infinity;
  int from = 0;        // the state before it
  bool has_c = false;  // C is known, here or from before
};
using States = std::array<State, 2>;

// The angle nearest to `near` that equals c up to whole turns.
double unwrapped(double c, double near) { return c + 360 * std::round((near - c) / 360); }

// Both solutions for the axis, C still in one turn.
States solutions(const Vec3& axis) {
  const double tilt = std::hypot(axis.x(), axis.y());
  if (tilt < pole) {
    const double a = axis.z() > 0 ? 0 : 180;
    return {State{.angles = {-a, 0}}, State{.angles = {a, 0}}};
  }
  const double a = std::atan2(tilt, axis.z()) * degrees;
  return {State{.angles = {-a, std::atan2(-axis.x(), -axis.y()) * degrees}, .has_c = true},
          State{.angles = {a, std::atan2(axis.x(), axis.y()) * degrees}, .has_c = true}};
}

bool is_within(const State& state, const RotaryLimits& limits) {
  return state.angles.a >= limits.a_min && state.angles.a <= limits.a_max;
}

// The cheaper way to a solution from the states before it.
State reached(const State& solution, const States& before, double weight) {
  State best;
  for (int k = 0; k < 2; ++k) {
    const State& from = before[k];
    if (!(from.cost < infinity)) continue;
    double c = solution.has_c ? solution.angles.c : from.angles.c;
    if (from.has_c) c = unwrapped(c, from.angles.c);
    const double turn = from.has_c ? std::abs(c - from.angles.c) : 0;
    const double cost = from.cost + weight * (turn + std::abs(solution.angles.a - from.angles.a));
    if (!(cost < best.cost)) continue;
    best = {.angles = {solution.angles.a, c}, .cost = cost, .from = k, .has_c = solution.has_c || from.has_c};
  }
  return best;
}

[[noreturn]] void refuse(std::size_t i, const Vec3& axis, const RotaryLimits& limits) {
  throw Error(
      ErrorCode::no_plan, "the table cannot tilt to the tool axis",
      {.element = fmt::format("tool path point {}", i),
       .value = fmt::format("{:.2f} degrees from +Z; A reaches from {} to {}",
                            std::atan2(std::hypot(axis.x(), axis.y()), axis.z()) * degrees, limits.a_min, limits.a_max),
       .advice = "turn the part, cover only what the tool can reach, or export poses for a robot"});
}

std::vector<RotaryAngles> traced_back(const std::vector<States>& all) {
  std::vector<RotaryAngles> result(all.size());
  int k = all.back()[1].cost < all.back()[0].cost ? 1 : 0;
  for (std::size_t i = all.size(); i-- > 0;) {
    const State& state = all[i][k];
    result[i] = state.angles;
    // Before the first tilt C is free: it waits where it will be needed.
    if (!state.has_c && i + 1 < all.size()) result[i].c = result[i + 1].c;
    k = state.from;
  }
  return result;
}

}  // namespace

Vec3 axis_of(const RotaryAngles& angles) {
  const double a = angles.a / degrees;
  const double c = angles.c / degrees;
  return {std::sin(c) * std::sin(a), std::cos(c) * std::sin(a), std::cos(a)};
}

bool can_tilt_to(const Vec3& axis, const RotaryLimits& limits) {
  const States states = solutions(axis);
  return std::any_of(states.begin(), states.end(), [&](const State& state) { return is_within(state, limits); });
}

std::vector<RotaryAngles> rotary_angles(const ToolPath& path, const RotaryLimits& limits) {
  std::vector<States> all(path.points.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const ToolPoint& point = path.points[i];
    const double weight = point.kind == MoveKind::lift ? weight_in_air : 1;
    States states = solutions(point.axis);
    for (State& state : states) {
      if (!is_within(state, limits)) continue;
      if (i > 0) {
        state = reached(state, all[i - 1], weight);
      } else {
        state.cost = 0;
      }
    }
    if (!(std::min(states[0].cost, states[1].cost) < infinity)) refuse(i, point.axis, limits);
    all[i] = states;
  }
  return all.empty() ? std::vector<RotaryAngles>() : traced_back(all);
}

}  // namespace isopath
