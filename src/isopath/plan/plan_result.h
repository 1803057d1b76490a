#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/impact/gap.h"
#include "isopath/impact/impact_plan.h"
#include "isopath/mesh/refine.h"
#include "isopath/plan/display_surface.h"
#include "isopath/plan/gap_choice.h"
#include "isopath/plan/job.h"
#include "isopath/plan/load_part.h"
#include "isopath/plan/output_folder.h"
#include "isopath/plan/patch_plans.h"
#include "isopath/plan/path_figures.h"
#include "isopath/plan/spiral_choice.h"
#include "isopath/tool/gouge.h"
#include "isopath/tool/scallop.h"
#include "isopath/tool/tool_path.h"

namespace isopath {

/// What a stage of a run cost.
struct StageTime {
  std::string stage;  ///< read, field, impact, gap, tool or program
  double seconds = 0;
};

/// What a ball leaves standing between passes.
struct ScallopFigures {
  ScallopReport measured;
  double clamped_fraction = 0;  ///< see ScallopMetric
  double gouged_fraction = 0;   ///< by curvature alone; see PlanResult::gouge
};

/// What smoothing did to the path, and what its gaps cost.
struct SmoothingFigures {
  double gap_before = 0;             ///< the widest one that smoothing left, mm
  std::optional<GapRepair> repair;   ///< the way they were closed; none where they were not too wide
  std::vector<GapRepairCost> costs;  ///< of all ways that were considered
};

/// All that a run found. Lengths in mm.
struct PlanResult {
  Job job;  ///< as it was given: where it leaves a choice to the planner, the choice is in this result
  Part part;
  RefinementTrail trail;  ///< from the part's mesh to that which was given, where planning made it finer or cut it open
  double spacing = 0;     ///< with a scallop: the pitch in the ball's metric, which is that on flat places
  Pattern pattern = Pattern::spiral;
  std::vector<double> distances;  ///< at every vertex: from the sources, smoothed where the job says so, or the height
                                  ///< for planar; infinity: unreached
  ImpactPlan impact;
  DisplaySurface display;             ///< empty where the job wants no report
  std::vector<PatchFigures> patches;  ///< in the order of work, where the job divides the part
  std::vector<Index> patch_of_face;   ///< for every face of the part
  GapReport gap;
  /// Covering length × spacing / area: 1 is the least that evenly spaced passes need. With a scallop, both in the
  /// ball's metric.
  double length_ratio = 0;
  std::optional<ScallopFigures> scallop;      ///< where the job asks for one
  std::optional<SpiralChoice> spiral;         ///< where the planner chose between spirals
  std::optional<SmoothingFigures> smoothing;  ///< where the job asks for it
  std::vector<TightPlace> tight;              ///< where the job asks for a smallest radius that could not be kept
  PathFigures figures;
  ToolPath tool;
  std::optional<GougeReport> gouge;  ///< where the tool is a ball
  std::vector<OutputFile> programs;  ///< of `make_programs`
  std::vector<StageTime> times;
  double peak_memory_mb = 0;          ///< of the process so far
  std::vector<std::string> warnings;  ///< what the user should know, of all stages

  /// Puts a finer mesh of the same surface in the place of the part's.
  void refine(RefinedMesh refined) {
    trail.add(part.mesh, refined);
    part.mesh = std::move(refined.mesh);
  }
  void warn_of(const std::vector<std::string>& more) { warnings.insert(warnings.end(), more.begin(), more.end()); }
};

}  // namespace isopath
