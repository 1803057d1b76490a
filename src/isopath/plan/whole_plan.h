#pragma once

#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/plan/plan_result.h"
#include "isopath/plan/stage_clock.h"

namespace isopath {

/// Plans all of the part by one field: from `result.job`, `part` and `spacing` to the pattern, the impact curve, the
/// distances and the surface to show, which has that share of the triangles a picture may have. The part's mesh may
/// become a finer one. Null metric: in space. Throws Error(bad_usage) for a spacing of too many passes, Error(no_plan)
/// with the reason, Error(cancelled).
void plan_whole(PlanResult& result, const IntrinsicGeometry* metric, StageClock& clock, Progress& progress,
                double display_share = 1);

}  // namespace isopath
