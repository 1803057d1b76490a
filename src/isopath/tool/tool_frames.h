#pragma once

#include <Eigen/Geometry>

#include "isopath/tool/tool_path.h"

namespace isopath {

/// Sets every point's tangent from the tips and axes: the mean of the directions of arrival and departure, made
/// perpendicular to the axis. Where there is none (a reversal, a move along the axis, coincident points) the
/// departure's direction is taken, then the nearest earlier tangent, then the nearest later one, then any
/// perpendicular.
void set_tangents(ToolPath& path);

/// Orientation of the tool: z is the axis, x the tangent, y = z × x.
Eigen::Quaterniond orientation_of(const ToolPoint& point);

}  // namespace isopath
