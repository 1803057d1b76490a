#pragma once

#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/tool/tool_path.h"

namespace isopath {

/// Angles of a tilting rotary table (A tilts about X and carries the table C that turns about Z), degrees.
struct RotaryAngles {
  double a = 0;
  double c = 0;
};

/// How far the table can tilt, degrees.
struct RotaryLimits {
  double a_min = -100;
  double a_max = 50;
};

/// The tool axis in the part's frame while the tool stands along the machine's +Z:
/// (sin C sin A, cos C sin A, cos A). This is LinuxCNC's xyzac-trt-kins with its default directions.
Vec3 axis_of(const RotaryAngles& angles);

/// Whether the table can give a point this axis (unit).
bool can_tilt_to(const Vec3& axis, const RotaryLimits& limits);

/// Angles that give every point its axis. Each axis but ±Z has two solutions, (A, C) and (−A, C + 180°): of all
/// sequences the one with the least rotation while the tool is on the surface is taken (a shortest path through two
/// states a point). C is continuous, so it may count many turns; where the axis is Z, C stays where it was.
/// Throws Error(no_plan) naming the point when neither solution is within the limits.
std::vector<RotaryAngles> rotary_angles(const ToolPath& path, const RotaryLimits& limits);

}  // namespace isopath
