#pragma once

#include <cmath>

#include "isopath/core/geometry.h"

namespace isopath {

/// Angle between two directions of any length, from 0 to pi; accurate at both ends, where the cosine is not. 0 where
/// one of them has no length.
inline double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace isopath
