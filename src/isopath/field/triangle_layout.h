#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "isopath/core/geometry.h"

namespace isopath {

/// Where the corner opposite `base` lies when the base runs along x from the origin, with the corner at y >= 0; `left`
/// joins it to the base's start and `right` to its end. The area by Kahan ("Miscalculating area and angles of a
/// needle-like triangle"): stable for needles; zero where the lengths make no triangle.
inline Vec2 apex_of(double base, double right, double left) {
  std::array<double, 3> s = {base, right, left};
  if (s[0] < s[1]) std::swap(s[0], s[1]);
  if (s[1] < s[2]) std::swap(s[1], s[2]);
  if (s[0] < s[1]) std::swap(s[0], s[1]);
  const double product =
      (s[0] + (s[1] + s[2])) * (s[2] - (s[0] - s[1])) * (s[2] + (s[0] - s[1])) * (s[0] + (s[1] - s[2]));
  return {0.5 * (base + (left - right) * ((left + right) / base)), 0.5 * std::sqrt(std::max(0.0, product)) / base};
}

}  // namespace isopath
