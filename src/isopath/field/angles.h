#pragma once

#include <span>

#include "isopath/core/geometry.h"

namespace isopath {

/// The angle in [0, π] of each vector from the x axis, for vectors with y >= 0: what std::atan2 says, to 5e-16, many at
/// a time; 0 for a zero vector. All instruction sets give the same bits. `angles` has as many places as `vectors`.
void angles_of(std::span<const Vec2> vectors, std::span<double> angles);

}  // namespace isopath
