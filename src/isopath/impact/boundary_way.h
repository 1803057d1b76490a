#pragma once

#include <optional>

#include "isopath/impact/surface_curve.h"

namespace isopath {

/// The way along the boundary between two points of one boundary loop, if it is at most `longest` (paper ch. 7.2: a
/// segment of the boundary replaces the geodesic). None when a point is not on the boundary or the way is longer.
std::optional<SurfaceCurve> boundary_way(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                         double longest);

}  // namespace isopath
