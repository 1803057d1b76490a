#pragma once

#include <vector>

#include "isopath/contour/isolines.h"
#include "isopath/core/geometry.h"
#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/impact/bump.h"
#include "isopath/impact/cover_field.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/impact/surface_curve.h"
#include "isopath/mesh/normals.h"

namespace isopath {

/// What counts as a wide gap where one curve is to cover everything, in spacings.
inline constexpr double widest_gap = 1.03;
/// The same where passes are to stay what they are: fronts that meet at a right angle leave less.
inline constexpr double widest_corner_gap = 1.15;

/// How wide gaps are closed.
enum class GapForm {
  bumps,  ///< and loops, which have corners
  round,  ///< the curve is round and is to stay so: by swells and full turns with at least the radius, or not at all
  swells  ///< as gently as can be: by swells with at least the radius, or not at all
};

struct GapLimits {
  double spacing = 0;                         ///< of the passes, in the lengths of the metric
  double widest = widest_gap;                 ///< gaps wider than this are closed, in spacings
  const IntrinsicGeometry* metric = nullptr;  ///< null for lengths in space
  double radius = 0;  ///< corners are rounded with this radius afterwards, mm: bumps go as far as that takes
  GapForm form = GapForm::bumps;
  int most_rounds = 12;  ///< what a bump leaves open beside it is closed in the next round
};

/// Closes what passes leave open where fronts meet: at saddles of the field, in sharp corners, inside the last pass
/// (paper ch. 9.3). Towards a small open spot the curve makes a bump, the paper's fishtail; around a wide one it makes
/// a loop: it leaves along the shortest way, goes round, and comes back. What is left or opened beside them is closed
/// in the next round. Returns the number of bumps and loops.
int close_wide_gaps(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactCurve& curve,
                    const GapLimits& limits, Progress& progress = Progress::none());

/// What was closed, and where to look next.
struct ClosedGaps {
  int count = 0;
  std::vector<Vec3> unsettled;  ///< where the curve has changed since gaps were looked for, and gaps that stayed open
};
/// The same, looking only beside some places, where the curve has changed.
ClosedGaps close_gaps_beside(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactCurve& curve,
                             const std::vector<Vec3>& places, const GapLimits& limits,
                             Progress& progress = Progress::none());
/// The same as `close_wide_gaps`, for a caller who will look again.
ClosedGaps close_gaps_everywhere(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactCurve& curve,
                                 const GapLimits& limits, Progress& progress = Progress::none());

/// A way out of the curve to a contour, along it, and back: round a closed one; along an open one as a link, or, with a
/// width, out on one side of it and back on the other, that far apart (mm). Its first point should be the one nearest
/// to the curve.
Replacement detour_along(const Contour& contour, const SurfaceLinker& linker, const SmoothNormals& normals,
                         const ImpactCurve& curve, const CoverField& cover, double width = 0);

/// Puts replacements into a curve; of those that overlap only the first. Returns how many were.
int replace(const TriangleMesh& mesh, ImpactCurve& curve, std::vector<Replacement> replacements);

}  // namespace isopath
