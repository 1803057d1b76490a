#pragma once

#include <array>

#include "isopath/core/geometry.h"

namespace isopath {

/// Size and shape of a single triangle, free of overflow and underflow of squares.
struct TriangleShape {
  double longest = 0;   ///< longest edge
  double shortest = 0;  ///< shortest edge
  double height = 0;    ///< over the longest edge; the triangle has no area when it is within the tolerance
  int apex = 0;         ///< corner opposite the longest edge

  double area() const { return 0.5 * longest * height; }
  /// Longest edge over height: 1.15 for an equilateral triangle, infinite without area.
  double aspect() const { return height > 0 ? longest / height : infinity; }
};

inline TriangleShape shape_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const std::array<double, 3> opposite = {(c - b).stableNorm(), (a - c).stableNorm(), (b - a).stableNorm()};
  TriangleShape shape{opposite[0], opposite[0], 0, 0};
  for (int i = 1; i < 3; ++i) {
    if (opposite[i] > shape.longest) {
      shape.longest = opposite[i];
      shape.apex = i;
    }
    if (opposite[i] < shape.shortest) shape.shortest = opposite[i];
  }
  if (shape.longest > 0) {
    // From the apex, where the edges are shortest, cancellation is least.
    const std::array<const Vec3*, 3> p = {&a, &b, &c};
    const Vec3& tip = *p[shape.apex];
    const Vec3 u = (*p[(shape.apex + 1) % 3] - tip) / shape.longest;
    const Vec3 v = (*p[(shape.apex + 2) % 3] - tip) / shape.longest;
    shape.height = u.cross(v).norm() * shape.longest;
  }
  return shape;
}

}  // namespace isopath
