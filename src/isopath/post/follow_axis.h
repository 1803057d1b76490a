#pragma once

#include "isopath/post/rotary_axes.h"
#include "isopath/tool/tool_path.h"

namespace isopath {

/// The path with points put in where a control that moves A and C evenly from one point to the next would lead the tool
/// axis further than `axis_tolerance` (rad) from the great circle between their axes. That happens near +Z, where a
/// small change of the axis is a large turn of C. Lifts stay as they are. A move is halved at most 10 times: its parts
/// are then a thousandth of it, and so is the error's bound, the angle between the axes at their ends.
/// Throws what rotary_angles() throws.
ToolPath follow_axis(const ToolPath& path, const RotaryLimits& limits, double axis_tolerance);

}  // namespace isopath
