#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/source.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Distances in mm at every vertex by fast marching (R. Kimmel, J. A. Sethian: Computing geodesic paths on manifolds,
/// PNAS 95, 1998); infinity where no source reaches. The corners of a face that holds a source start with their exact
/// distance to it. In order of distance, every vertex then takes the least value that a straight front brings through
/// the triangles around it: the minimum, over the points of the opposite edge, of the linearly interpolated distance
/// and the way from there. Obtuse corners are split by a vertex of the faces unfolded beyond the opposite edge.
///
/// The error is of first order in the edge length h. It is nothing for straight fronts on a flat part. Away from a
/// point source, at distance d, the front is bent, and the errors add up to about h (1 + ln(d / h)) / 8 on triangles
/// that are nearly equilateral: an estimate, not a bound, and more on slivers. Values are never above those of
/// `graph_distances` without virtual vertices or pairs. On a flat convex part with one point source they are never
/// below the exact distance; elsewhere they may be.
///
/// Takes O(n log n) time and no windows. Throws Error(bad_usage) for an empty source set, Error(cancelled) on request.
std::vector<double> fast_marching_distances(const TriangleMesh& mesh, const SourceSet& sources,
                                            Progress& progress = Progress::none());

}  // namespace isopath
