#include "isopath/plan/gap_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "isopath/field/exact_distances.h"
#include "isopath/impact/cover_field.h"
#include "isopath/impact/gap_repair.h"
#include "isopath/impact/ridge_passes.h"
#include "isopath/mesh/normals.h"
#include "isopath/plan/level_density.h"
#include "isopath/plan/path_figures.h"

namespace isopath {
namespace {

constexpr double lift_over_spacing = 20;
/// Whoever asks for smoothing would rather go farther than stop.
constexpr double corner_over_spacing = 5;
/// Rounds of planning and measuring; each comes closer.
constexpr int most_rounds = 3;
/// Gaps are looked at in the vertices only: between them they may be this much wider.
constexpr double margin = 0.97;
/// What rounds aim at, so that a few of them get there.
constexpr double aim = 0.94;
/// A way whose estimated cost is that much above another one's is not worth a plan.
constexpr double hopeless = 1.05;

class Chooser {
 public:
  Chooser(const VertexField& function, const ImpactOptions& options, std::span<const std::vector<SurfacePoint>> ridges,
          Progress& progress)
      : mesh_(function.mesh()),
        function_(function),
        options_(options),
        ridges_(ridges),
        progress_(progress),
        limits_{options.spacing, widest_corner_gap, options.metric},
        allowed_(limits_.widest * options.spacing),
        even_(function, options.metric ? *options.metric : IntrinsicGeometry(mesh_), options.spacing),
        locator_(mesh_),
        normals_(mesh_),
        linker_(mesh_, locator_, progress) {
    options_.close_gaps = false;
  }

  RepairedPlan run() {
    RepairedPlan result;
    ImpactPlan plan = planned(even_, options_);
    const std::vector<double> gaps = gaps_of(plan.curve);
    result.gap_before = widest(gaps);
    if (result.gap_before <= margin * allowed_) {
      loop(plan);
      result.plan = std::move(plan);
      return result;
    }
    add_detours(plan);
    lower_spacing_by_level(gaps);
    lower_spacing(plan, result.gap_before);
    std::size_t best = 0;
    for (std::size_t i = 1; i < costs_.size(); ++i) {
      if (costs_[i].planned && cost_of(costs_[i]) < cost_of(costs_[best])) best = i;
    }
    result.chosen = costs_[best].repair;
    result.plan = std::move(plans_[best]);
    result.costs = std::move(costs_);
    return result;
  }

 private:
  ImpactPlan planned(const LevelDensity& density, const ImpactOptions& options) const {
    return plan_impact(mesh_, density.applied(), options, progress_);
  }

  /// At the vertices; without windows kept, this costs a fraction of a gap report.
  std::vector<double> gaps_of(const ImpactCurve& curve) const {
    const SourceSet source = cover_elements(mesh_, curve);
    std::vector<double> gaps = options_.metric ? exact_distances(mesh_, *options_.metric, source, infinity, progress_)
                                               : exact_distances(mesh_, source, infinity, progress_);
    for (double& gap : gaps) gap *= 2;
    return gaps;
  }

  /// Vertices that the function does not reach do not count.
  double widest(std::span<const double> gaps) const {
    double widest = 0;
    for (std::size_t v = 0; v < gaps.size(); ++v) {
      if (std::isfinite(function_.values()[v]) && std::isfinite(gaps[v])) widest = std::max(widest, gaps[v]);
    }
    return widest;
  }

  double cost_of(const GapRepairCost& way) const {
    return way.length + options_.spacing * (lift_over_spacing * way.lifts + corner_over_spacing * way.sharp_corners);
  }

  double least_cost() const {
    double least = infinity;
    for (const GapRepairCost& way : costs_) {
      if (way.planned) least = std::min(least, cost_of(way));
    }
    return least;
  }

  GapRepairCost figures_of(GapRepair repair, const ImpactPlan& plan, double spacing) const {
    const PathFigures figures = path_figures(plan.curve, options_.spacing);
    return {.repair = repair,
            .length = figures.cover_length + figures.links_length,
            .lifts = figures.lifts,
            .sharp_corners = figures.sharp_corners,
            .spacing = spacing};
  }

  void add(GapRepair repair, ImpactPlan plan, double spacing) {
    costs_.push_back(figures_of(repair, plan, spacing));
    plans_.push_back(std::move(plan));
  }

  void loop(ImpactPlan& plan) const {
    progress_.stage("wide gaps");
    close_wide_gaps(linker_, normals_, plan.curve, limits_, progress_);
  }

  void add_detours(const ImpactPlan& base) {
    ImpactPlan looped = base;
    loop(looped);
    add(GapRepair::bumps, std::move(looped), options_.spacing);
    ImpactPlan ridged = base;
    if (add_ridge_passes(linker_, normals_, ridges_, ridged.curve, limits_, progress_) == 0) return;
    loop(ridged);
    add(GapRepair::ridge_pass, std::move(ridged), options_.spacing);
  }

  void lower_spacing_by_level(std::vector<double> gaps) {
    LevelDensity density = even_;
    ImpactPlan plan;
    for (int round = 0; round < most_rounds && widest(gaps) > margin * allowed_; ++round) {
      if (!density.raise(gaps, aim * allowed_)) break;
      plan = planned(density, options_);
      GapRepairCost way = figures_of(GapRepair::levels, plan, options_.spacing);
      if (cost_of(way) > hopeless * least_cost()) {
        way.planned = false;
        costs_.push_back(way);
        plans_.emplace_back();
        return;
      }
      gaps = gaps_of(plan.curve);
    }
    loop(plan);
    add(GapRepair::levels, std::move(plan), options_.spacing);
  }

  /// Gaps go with the spacing where they come from corners; from tops they go with its root, which takes rounds.
  void lower_spacing(const ImpactPlan& base, double gap) {
    const double least = least_cost();
    GapRepairCost way = figures_of(GapRepair::spacing, base, options_.spacing);
    way.planned = false;
    ImpactPlan plan;
    for (int round = 0; round < most_rounds && gap > margin * allowed_; ++round) {
      const double factor = margin * allowed_ / gap;
      way.spacing *= factor;
      way.length /= factor;
      if (cost_of(way) > hopeless * least) break;
      ImpactOptions closer = options_;
      closer.spacing = way.spacing;
      plan = planned(even_, closer);
      gap = widest(gaps_of(plan.curve));
      way = figures_of(GapRepair::spacing, plan, way.spacing);
      way.planned = gap <= margin * allowed_;
    }
    costs_.push_back(way);
    plans_.push_back(std::move(plan));
  }

  const TriangleMesh& mesh_;
  const VertexField& function_;
  ImpactOptions options_;
  std::span<const std::vector<SurfacePoint>> ridges_;
  Progress& progress_;
  GapLimits limits_;
  double allowed_;
  LevelDensity even_;
  SurfaceLocator locator_;
  SmoothNormals normals_;
  SurfaceLinker linker_;
  std::vector<GapRepairCost> costs_;
  std::vector<ImpactPlan> plans_;
};

}  // namespace

std::string_view name_of(GapRepair repair) {
  switch (repair) {
    case GapRepair::bumps:
      return "bumps";
    case GapRepair::ridge_pass:
      return "ridge-pass";
    case GapRepair::levels:
      return "levels";
    case GapRepair::spacing:
      return "spacing";
  }
  return "";
}

RepairedPlan plan_with_repair(const VertexField& function, const ImpactOptions& options,
                              std::span<const std::vector<SurfacePoint>> ridges, Progress& progress) {
  options.validate();
  return Chooser(function, options, ridges, progress).run();
}

}  // namespace isopath
