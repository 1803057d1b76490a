#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/vertex_field.h"
#include "isopath/impact/impact_plan.h"
#include "isopath/mesh/surface_point.h"

namespace isopath {

/// The ways to close gaps that smoothing opens (paper ch. 9.3).
enum class GapRepair {
  bumps,       ///< bumps of the curve towards every wide place, the paper's fishtails, and loops round large ones
  ridge_pass,  ///< passes along the medial axis, and bumps towards what is left
  levels,      ///< passes closer together at the levels where gaps are too wide, and bumps towards what is left
  spacing,     ///< passes closer together everywhere
};
std::string_view name_of(GapRepair repair);  ///< bumps, ridge-pass, levels, spacing

/// What one way costs.
struct GapRepairCost {
  GapRepair repair = GapRepair::bumps;
  double length = 0;  ///< on the surface, covering and links, mm
  Index lifts = 0;
  Index sharp_corners = 0;  ///< see PathFigures
  double spacing = 0;       ///< that levels were chosen for, mm
  /// False for a way that was not planned, as it could not be the cheapest: figures are estimates.
  bool planned = true;
};

/// A plan without gaps above `widest_corner_gap`, as passes that were smoothed are to stay smooth, and what there was
/// to choose from.
struct RepairedPlan {
  ImpactPlan plan;
  double gap_before = 0;             ///< the widest one without repair, mm, at the mesh's vertices
  std::optional<GapRepair> chosen;   ///< none where there was nothing to repair
  std::vector<GapRepairCost> costs;  ///< of all ways; empty where there was nothing to repair
};

/// Plans passes on levels of a smoothed function, measures, and takes the cheapest way to close the gaps. The cost is
/// the length of the path on the surface; a lift counts as 20 spacings more and a sharp corner, where a machine stops,
/// as five. Levels are first spread so that passes lie a spacing apart along most of their length (LevelDensity).
/// `ridges` are the lines that gaps open along, as for `add_ridge_passes`. The mesh should have edges no longer than
/// half a spacing. Throws what `plan_impact` does.
RepairedPlan plan_with_repair(const VertexField& function, const ImpactOptions& options,
                              std::span<const std::vector<SurfacePoint>> ridges, Progress& progress = Progress::none());

}  // namespace isopath
