#pragma once

#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/impact/gap_repair.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/impact/surface_curve.h"
#include "isopath/mesh/normals.h"

namespace isopath {

/// Closes wide gaps by passes along ridges, which are lines such as the arcs of a medial axis (paper ch. 9.3). A
/// stretch of a ridge with wide gaps that follow each other closely is covered by a hairpin: from the curve, out on
/// one side of the ridge and back on the other, a spacing apart. Gaps off the ridges stay. Returns the number of
/// stretches. Throws Error(no_plan) when the curve covers nothing, Error(cancelled) on request.
int add_ridge_passes(const SurfaceLinker& linker, const SmoothNormals& normals,
                     std::span<const std::vector<SurfacePoint>> ridges, ImpactCurve& curve, const GapLimits& limits,
                     Progress& progress = Progress::none());

}  // namespace isopath
