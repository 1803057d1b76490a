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

/// Coordinates beyond this cannot be used: squared lengths, and products of them, must stay finite.
inline constexpr double largest_coordinate = 1e75;
/// A mesh that is smaller, but larger than a point, has areas whose squares vanish. In mm.
inline constexpr double smallest_size = 1e-70;

/// True when all coordinates are finite and not beyond largest_coordinate.
inline bool is_usable(const Vec3& position) {
  return position.allFinite() && position.cwiseAbs().maxCoeff() <= largest_coordinate;
}

/// Bounding box of the finite positions.
Box3 bounding_box(const TriangleSoup& soup);

/// Throws Error(bad_input) when the bounds of a mesh are below smallest_size, and no point.
void require_usable_size(const Box3& bounds);

}  // namespace isopath
