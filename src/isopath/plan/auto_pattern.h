#pragma once

#include <functional>
#include <span>

#include "isopath/core/progress.h"
#include "isopath/impact/impact_plan.h"

namespace isopath {

/// A plan, and the pattern it was made with.
struct ChosenPlan {
  Pattern pattern = Pattern::spiral;
  ImpactPlan plan;
};

/// A spiral or meander within this of area / spacing leaves a two-way curve nothing to win.
inline constexpr double good_length_ratio = 1.08;

/// Spiral where most of the isolines' length is in closed ones, else meander. A few levels tell. `values` are the
/// function's at the vertices. Throws Error(cancelled) on request.
Pattern pattern_by_isolines(const TriangleMesh& mesh, const SurfaceFunction& function, std::span<const double> values,
                            Progress& progress = Progress::none());

/// The plan for a user who names no pattern: a spiral where most of the isolines' length is in closed ones, else a
/// meander. Where that lifts, or is longer than 1.12 area / spacing, a two-way curve is planned besides, and taken if
/// it lifts less often and is at most 5 % longer, or lifts as often and the other one is more than 10 % longer; lengths
/// are those on the surface, where the first one lifts before gaps are closed. `values` are the function's at the
/// vertices; the pattern in `options` is not looked at. `two_way_function` gives another function for the two-way
/// curve, if it is not empty. Throws what `plan_impact` does.
ChosenPlan plan_by_part(const TriangleMesh& mesh, const SurfaceFunction& function, std::span<const double> values,
                        const ImpactOptions& options, Progress& progress = Progress::none(),
                        const std::function<const SurfaceFunction&()>& two_way_function = {});

}  // namespace isopath
