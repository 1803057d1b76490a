#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/impact/impact_plan.h"
#include "isopath/plan/display_surface.h"
#include "isopath/plan/job.h"
#include "isopath/plan/partition.h"

namespace isopath {

/// A patch by itself. Lengths in mm.
struct PatchFigures {
  Pattern pattern = Pattern::spiral;
  double area = 0;
  double cover_length = 0;
  Index pieces = 0;     ///< stretches covered without leaving the surface
  double gap_max = 0;   ///< the widest gap that the patch's own curve leaves in it
  double gap_p99 = 0;   ///< 99 % of its area has at most this gap
  double evenness = 0;  ///< coefficient of variation of the gap, see GapReport
  double covered_fraction = 0;
};

/// The plan of a part from those of its patches.
struct PatchedPlan {
  ImpactPlan impact;                  ///< on the whole mesh
  std::vector<PatchFigures> patches;  ///< in the order of work
  /// For every face of the mesh its patch, in that order.
  std::vector<Index> patch_of_face;
  std::vector<double> distances;  ///< at every vertex: from the border of its patch, or the height for planar
  /// Distances on the surface to show; vertices on borders are doubled, so that every patch has values of its own
  /// there. Empty where the job wants no report.
  DisplaySurface display;
};

/// Plans every patch as a part of its own, from its own border, the way `job` asks for, and strings the curves
/// together: the patches in an order with short ways between them, each curve entered at either end (a closed one
/// anywhere), joined by links on the surface where these are short and by lifts elsewhere. The job's mesh, sources,
/// spacing and partition are not looked at. Null metric: in space. Where levels of a patch cannot be blended it is
/// planned without. A patch without any isoline is left out, with a warning. Throws what `plan_whole` does,
/// Error(no_plan) when no patch can be covered.
PatchedPlan plan_patches(const Partition& parts, const Job& job, double spacing,
                         const IntrinsicGeometry* metric = nullptr, Progress& progress = Progress::none());

}  // namespace isopath
