#pragma once

#include <array>
#include <vector>

#include "isopath/core/geometry.h"

namespace isopath {

using Triangle = std::array<Index, 3>;

/// Triangles as a file holds them: nothing is promised about how they hang together, or that coordinates are finite.
/// Readers make it, `check` describes it, `repair` mends it, and `TriangleMesh` is made from it.
struct TriangleSoup {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};

/// Bounding box of the finite positions.
Box3 bounding_box(const TriangleSoup& soup);

}  // namespace isopath
