#pragma once

#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/impact/surface_curve.h"
#include "isopath/mesh/normals.h"

namespace isopath {

/// Gaps wider than this, in spacings, are closed by detours.
inline constexpr double widest_gap = 1.15;

/// Closes what passes leave open where fronts meet: at saddles of the field, in sharp corners, inside the last pass
/// (paper ch. 9.3). Around every place whose gap exceeds `widest_gap` the curve makes a loop: it leaves along the
/// shortest way, goes round, and comes back. In a metric, distances and the spacing are lengths in it. Returns the
/// number of loops.
int close_wide_gaps(const SurfaceLinker& linker, const SmoothNormals& normals, double spacing, ImpactCurve& curve,
                    Progress& progress, const IntrinsicGeometry* metric = nullptr);

}  // namespace isopath
