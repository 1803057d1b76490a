#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/vertex_field.h"
#include "isopath/impact/impact_plan.h"
#include "isopath/mesh/surface_point.h"
#include "isopath/plan/smooth_part.h"

namespace isopath {

/// The ways to narrow gaps that smoothing opens (paper ch. 9.3). What they leave is closed as in any other plan
/// (impact/finish_curve.h).
enum class GapRepair {
  bumps,       ///< bumps of the curve towards every wide place, the paper's fishtails, and loops round large ones
  ridge_pass,  ///< first hairpins along the medial axis where gaps are too wide
  levels,      ///< first passes closer together at the levels where gaps are too wide
  spacing,     ///< first passes closer together everywhere
};
std::string_view name_of(GapRepair repair);  ///< bumps, ridge-pass, levels, spacing

/// What one way costs.
struct GapRepairCost {
  GapRepair repair = GapRepair::bumps;
  double length = 0;  ///< on the surface, covering and links, mm
  Index lifts = 0;
  Index tight_turns = 0;  ///< see PathFigures
  double spacing = 0;     ///< that levels were chosen for, mm
  /// False for a way whose gaps were not closed, as it could not be the cheapest: figures are those before,
  /// with the tight turns that closing them would make at least.
  bool planned = true;
};

/// A plan without wide gaps, and what there was to choose from.
struct RepairedPlan {
  ImpactPlan plan;
  double gap_before = 0;             ///< the widest one that smoothing left, mm, at the mesh's vertices
  std::optional<GapRepair> chosen;   ///< none where no gap was wider than 1.15 spacings
  std::vector<GapRepairCost> costs;  ///< of all ways; empty where there was nothing to choose
};

/// Plans passes on levels of a smoothed function and takes the way to close their gaps that costs least. The cost is
/// the length of the path on the surface; a lift counts as 20 spacings more and a tight turn, where a machine slows
/// down, as five. Levels are first spread so that passes lie no farther than a spacing apart along most of their length
/// (LevelDensity). Corners are rounded as those of two-way curves. The function is one of the finer mesh, whose edges
/// should be no longer than half a spacing; the plan is on the part's own. `ridges` are the lines on the part that gaps
/// open along, as for `add_ridge_passes`; the metric of `options` is the part's. Throws what `plan_impact` does.
RepairedPlan plan_with_repair(const TriangleMesh& part, const VertexField& function, const FineSurface& fine,
                              const std::vector<std::vector<SurfacePoint>>& ridges, const ImpactOptions& options,
                              Progress& progress = Progress::none());

}  // namespace isopath
