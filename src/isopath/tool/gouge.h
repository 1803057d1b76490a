#pragma once

#include "isopath/core/geometry.h"
#include "isopath/core/progress.h"
#include "isopath/mesh/triangle_mesh.h"
#include "isopath/tool/tool_path.h"

namespace isopath {

/// Where a ball cuts into the part that it should only touch.
struct GougeReport {
  double deepest = 0;         ///< mm; 0 where the ball cuts nowhere deeper than the tolerance
  Vec3 place = Vec3::Zero();  ///< the point of the surface that is cut deepest
  double share = 0;           ///< of the length of covering moves and links, where it cuts deeper than the tolerance
};

/// Follows the centre of a tool's ball along covering moves and links, in steps of a quarter of its radius, and asks
/// how far the part reaches into it: radius less the distance to the surface. Lifts keep away. A mesh with facets is
/// cut a little on its edges, by the square of their angle times an eighth of the radius; the tolerance, mm, should be
/// above that. Throws Error(cancelled) on request.
GougeReport measure_gouges(const TriangleMesh& mesh, const ToolPath& path, double ball_radius, double tolerance,
                           const Progress& progress = Progress::none());

}  // namespace isopath
