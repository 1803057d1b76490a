#pragma once

#include <optional>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/mesh/refine.h"
#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Shortest paths that join the boundary loops of every component to one tree: the minimum spanning tree by geodesic
/// distance, so that no two of them cross. Loops whose regions of nearest points touch along an edge of the mesh are
/// neighbours, and only these are joined, from any point of the one to a vertex of the other. The mesh should have
/// edges no longer than narrow places are wide. Throws Error(cancelled) on request.
std::vector<std::vector<SurfacePoint>> hole_bridges(const TriangleMesh& mesh, Progress& progress = Progress::none());

/// The surface cut open along these bridges, so that every component without handles has one boundary loop at most;
/// edges are no longer than `spacing`, in mm. None where that does not come out, as there are handles. Throws
/// Error(cancelled) on request.
std::optional<RefinedMesh> opened_holes(const TriangleMesh& mesh, double spacing,
                                        Progress& progress = Progress::none());

}  // namespace isopath
