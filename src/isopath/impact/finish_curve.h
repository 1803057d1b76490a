#pragma once

#include "isopath/core/progress.h"
#include "isopath/impact/gap_repair.h"
#include "isopath/impact/impact_plan.h"
#include "isopath/impact/surface_curve.h"
#include "isopath/mesh/normals.h"

namespace isopath {

/// Corners of curves that are to have none are rounded with this radius, in spacings: a right angle loses 0.03
/// spacings.
inline constexpr double default_radius_in_spacings = 0.08;

struct FinishOptions {
  bool radius_first = false;  ///< the radius was asked for: it comes before the last gaps
  bool gently = false;        ///< passes are smooth: gaps that wide, gentle swells can close are closed by these first
  bool taut = false;          ///< draw the curve tight in the end (taut_curve.h), unless the radius comes first
};

/// Closes a plan's gaps and rounds its corners with `limits.radius`: bumps first, after gentle swells where these are
/// asked for; they may have corners. What rounding opens is closed by swells and full turns; unless the radius comes
/// first, what these do not reach by bumps and loops again. Corners stay where the radius is 0. Sets the plan's radius
/// and its tight places.
void finish_curve(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactPlan& plan, GapLimits limits,
                  const FinishOptions& options, Progress& progress = Progress::none());

}  // namespace isopath
