#pragma once

#include <numbers>
#include <string_view>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// What a part is divided by into patches that are planned one by one (paper ch. 12).
enum class PartitionBy {
  none,
  creases,  ///< edges whose faces meet at an angle: each smooth side becomes a patch
  medial,   ///< where the medial axis's distance from the boundary is uneven: rooms and the necks between them
  both,
};
std::string_view name_of(PartitionBy by);

struct PartitionOptions {
  PartitionBy by = PartitionBy::none;
  /// Edges whose faces' normals differ by more than this are borders; radians, in (0, π).
  double crease_angle = 40 * std::numbers::pi / 180;
  /// Greatest over least distance of a patch's medial axis from its border that is let be; above 1.
  double unevenness = 1.5;
  void validate() const;  ///< throws Error(bad_usage) naming the field, its value and its limit
};

/// A part and its patches.
struct Partition {
  TriangleMesh mesh;  ///< the part, its faces divided where a border runs through them; old vertices keep their numbers
  std::vector<Index> patch_of_face;  ///< counted from 0 by lowest face
  Index n_patches = 0;
};

/// Divides a part for passes a spacing apart. The medial axis divides no patch that has room for less than three passes
/// between it and the border. Creases that lead nowhere part nothing. A patch narrower than the spacing
/// (twice its area over its perimeter) has no room for a pass of its own and is joined to the neighbour that it shares
/// the longest border with. Throws Error(bad_usage) for invalid options or a spacing that is not positive,
/// Error(no_plan) where creases make more than 500 patches, Error(cancelled) on request.
Partition partition(TriangleMesh mesh, double spacing, const PartitionOptions& options,
                    Progress& progress = Progress::none());

}  // namespace isopath
