#pragma once

#include "isopath/core/geometry.h"
#include "isopath/core/progress.h"
#include "isopath/tool/tool_path.h"

namespace isopath {

/// Unit vector at the fraction u of the great circle from a to b; of two opposite vectors, the nearer one.
Vec3 axis_between(const Vec3& a, const Vec3& b, double u);

/// Leaves out points that the moves between the remaining ones reproduce: each dropped tip is within
/// `chord_tolerance` (mm) of the new move, and its axis within `axis_tolerance` (rad) of the axis there. The first
/// and last point of every run of one kind and piece stay. A subset of the points, in order; a chord tolerance of 0
/// keeps all. Feeds, times and tangents are not touched. Throws Error(cancelled) on request.
/// Source: Douglas and Peucker, "Algorithms for the reduction of the number of points", Cartographica 10 (1973).
ToolPath thin_path(const ToolPath& path, double chord_tolerance, double axis_tolerance,
                   const Progress& progress = Progress::none());

}  // namespace isopath
