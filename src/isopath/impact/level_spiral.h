#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/vertex_field.h"
#include "isopath/impact/impact_plan.h"
#include "isopath/impact/surface_curve.h"

namespace isopath {

struct LevelSpiralOptions {
  int arms = 1;        ///< 1: a spiral, from the rim to the top; 2: a double spiral, which comes back to where it began
  double spacing = 0;  ///< between levels, mm; required, > 0
  /// The gap to keep, mm, for detours where the levels do not keep it; 0 takes `spacing`.
  double asked_spacing = 0;
  double clearance = 0;  ///< height of lifts between components, mm; 0 takes the spacing
  /// Smallest radius that the curve may turn with on the surface, mm. 0: corners are rounded with 0.08 spacings.
  double min_radius = 0;
  void validate() const;  ///< throws Error(bad_usage)
};

/// One curve through the nested closed levels of a function, as a level set on the surface cut open (paper ch. 7.1, by
/// level sets instead of strips): where the levels are (k - ½) spacings and τ counts turns, it is the set where the
/// function equals spacing × F(τ), with F constant over most of a turn and rising by one level for each arm in a
/// window of it. Neighbouring turns have levels a spacing apart everywhere, so that the gap is that of the levels.
/// At the rim and around the top, where levels end, the arms are squeezed in between, so that nothing is left open.
///
/// A component may have more tops than one. The levels around the lower ones are islands: closed curves that are
/// inserted into the curve one by one, by a joint as in two_way, so that no level has to go there and back.
///
/// Every component must be a disc with the function 0 on its boundary, a closed surface, or an annulus with the
/// function lowest on one loop and highest on the other. Throws Error(no_plan) when a level is not made of
/// closed curves or does not go round the part but for its islands, Error(bad_usage) for invalid options,
/// Error(cancelled) on request.
ImpactPlan level_spiral(const VertexField& function, const LevelSpiralOptions& options,
                        Progress& progress = Progress::none());

}  // namespace isopath
