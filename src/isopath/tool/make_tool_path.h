#pragma once

#include "isopath/core/progress.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/tool/tool_model.h"
#include "isopath/tool/tool_path.h"

namespace isopath {

/// Lifts the impact curve to the path of the tool (paper ch. 3.2). With the impact point p, its normal n and the axis a
/// (n itself, or the fixed direction):
///  - spray: the tip is the nozzle, at p + a · stand_off;
///  - mill and grind: the ball of radius R touches at p, its centre is p + n · R and the tip, its lowest point, is
///    centre − a · R.
/// Lifts are offset the same way from their own position and normal. Feed follows the kind of move; the last move of a
/// lift, which comes down on to the surface, has the link's. Time adds up the tip's way over the feed. Points that the
/// remaining ones reproduce are left out (thin_path), and tangents are set last (set_tangents).
///
/// Throws Error(bad_usage) from validate(); Error(bad_input) when a point or normal is not finite or a normal not unit;
/// Error(no_plan) when the fixed axis would have to come through the surface, which then faces away from it;
/// Error(cancelled) on request.
ToolPath make_tool_path(const ImpactCurve& curve, const ToolOptions& options = {},
                        const Progress& progress = Progress::none());

}  // namespace isopath
