#pragma once

#include <optional>
#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/impact/impact_plan.h"
#include "isopath/mesh/refine.h"
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
  std::vector<double> distances;          ///< at every vertex: from the border of its patch, or the height for planar
  std::vector<double> display_distances;  ///< at the vertices of `display`
};

struct PatchPlanOptions {
  std::optional<Pattern> pattern = {};  ///< none: for every patch what suits it (auto_pattern.h)
  Vec3 planar_direction = Vec3::UnitX();
  double spacing = 0;        ///< mm, > 0
  double clearance = 0;      ///< of lifts, mm; 0 takes the spacing
  double circle_radius = 0;  ///< see ImpactOptions
  double circle_step = 0;
  double min_radius = 0;  ///< of turns on the surface, mm; 0 takes the default of ImpactOptions
  /// Most that a distance may be off, mm; 0 for exact ones.
  double accuracy = 0;
};

/// Plans every patch with a field of its own, from its own border, and strings the curves together: the patches in an
/// order with short ways between them, each curve entered at either end (a closed one anywhere), joined by links on the
/// surface where these are short and by lifts elsewhere. `display` is a refinement of the mesh whose vertices are to
/// have distances, or null. A patch without any isoline is left out, with a warning. Throws what `plan_impact` does,
/// Error(no_plan) when no patch can be covered.
PatchedPlan plan_patches(const Partition& parts, const PatchPlanOptions& options, const RefinedMesh* display = nullptr,
                         Progress& progress = Progress::none());

/// The refinement with its vertices on borders of patches doubled, so that every patch has values of its own there.
RefinedMesh parted(const RefinedMesh& refined, std::span<const Index> patch_of_face);

}  // namespace isopath
