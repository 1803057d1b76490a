#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/impact/surface_curve.h"
#include "isopath/mesh/normals.h"

namespace isopath {

struct TautLimits {
  double spacing = 0;   ///< of the passes, mm
  double widest = 1.0;  ///< what is covered at this gap, in spacings, stays so
  double radius = 0;    ///< the curve is not to turn with less than this radius on the surface, mm
};

/// Draws a curve tight where it turns with a radius below a spacing, as far as what it covers allows: every point in
/// turn goes towards the middle of its neighbours, unless that uncovers a place or makes the curve turn too tightly. So
/// bumps and joints become as short as they can be. Straight stretches, ends, links and lifts stay. Gaps should be
/// looked for once more beside the places that are returned: points of the curve that have moved, and where they were.
/// Throws Error(cancelled) on request.
std::vector<Vec3> draw_taut(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactCurve& curve,
                            const TautLimits& limits, const Progress& progress = Progress::none());

}  // namespace isopath
