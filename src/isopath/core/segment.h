#pragma once

#include <algorithm>

#include "isopath/core/geometry.h"

namespace isopath {

/// The point between `a` (t = 0) and `b` (t = 1).
inline Vec3 mix(const Vec3& a, const Vec3& b, double t) { return (1 - t) * a + t * b; }

/// The parameter in [0, 1] of the point of the segment from `a` to `b` that is nearest to a point; 0 where the segment
/// has no length.
inline double nearest_on_segment(const Vec3& a, const Vec3& b, const Vec3& point) {
  const Vec3 along = b - a;
  const double squared = along.squaredNorm();
  return squared > 0 ? std::clamp((point - a).dot(along) / squared, 0.0, 1.0) : 0.0;
}

inline double distance_to_segment(const Vec3& a, const Vec3& b, const Vec3& point) {
  return (a + nearest_on_segment(a, b, point) * (b - a) - point).norm();
}

}  // namespace isopath
