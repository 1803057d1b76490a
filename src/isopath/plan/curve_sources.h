#pragma once

#include <vector>

#include "isopath/contour/isolines.h"
#include "isopath/core/progress.h"
#include "isopath/mesh/surface_locator.h"
#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Curves that a few numbers determine, to measure distances from (paper ch. 1: a source with few degrees of freedom
/// is one that a search can vary). Lengths in mm, angles in radians.

/// The shortest path between two points of one component, from the first to the second. Throws Error(cancelled) on
/// request.
std::vector<SurfacePoint> shortest_way(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                       Progress& progress = Progress::none());

/// The shortest path between two points, continued beyond both straight on (mesh/straight_walk.h) to the boundary, or
/// to where it meets itself; on a component without boundary by no more than the part's size either way. Winding round
/// a part, it is given up after twenty times that size.
/// Throws Error(bad_usage) where the points are one or lie on different components, Error(cancelled) on request.
std::vector<SurfacePoint> geodesic_through(const TriangleMesh& mesh, const SurfacePoint& a, const SurfacePoint& b,
                                           Progress& progress = Progress::none());

/// The unit normal of a plane that runs in the direction at `angle` from x towards y, and whose other direction is z
/// leaned over by `tilt` towards the left of that: 0 is an upright plane, π/2 a level one.
Vec3 cut_normal(double angle, double tilt);

/// A place on a boundary loop.
struct BoundaryPlace {
  Index loop = no_index;  ///< in TriangleMesh::boundary_loops()
  double share = 0;       ///< of the loop's length from the start of its first half-edge, in [0, 1)
  double distance = 0;    ///< of the place from what it was looked for with
};

/// The place on the boundary nearest to a point. Throws Error(bad_usage) when the mesh has no boundary.
BoundaryPlace nearest_on_boundary(const TriangleMesh& mesh, const Vec3& point);

/// The part of a boundary loop between two shares of its length, walked with the surface on the left: over the loop's
/// start where `to` lies before `from`. Whole turns in a share do not matter, but a difference of one or more is all of
/// the loop, whose first point is then repeated at the end. Throws Error(bad_usage) when the shares are not finite or
/// are equal.
std::vector<SurfacePoint> boundary_segment(const TriangleMesh& mesh, Index loop, double from, double to);

}  // namespace isopath
