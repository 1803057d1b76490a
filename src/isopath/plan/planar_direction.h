#pragma once

#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// The direction in which parallel planes cut a part into few long passes: the middle one of its principal axes, by
/// area, so that passes run along the longest. Where that one is not alone, as on squares, discs and balls, the one
/// of them next to x, or else y. Unit.
Vec3 planar_direction_of(const TriangleMesh& mesh);

}  // namespace isopath
