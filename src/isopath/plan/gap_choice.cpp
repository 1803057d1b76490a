#include "isopath/plan/gap_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "isopath/field/exact_distances.h"
#include "isopath/impact/cover_field.h"
#include "isopath/impact/gap_repair.h"
#include "isopath/impact/ridge_passes.h"
#include "isopath/mesh/disjoint_sets.h"
#include "isopath/mesh/normals.h"
#include "isopath/mesh/surface_walk.h"
#include "isopath/plan/level_density.h"
#include "isopath/plan/path_figures.h"

namespace isopath {
namespace {

using Ridges = std::vector<std::vector<SurfacePoint>>;

constexpr double lift_over_spacing = 20;
/// Whoever asks for smoothing would rather go farther than slow down.
constexpr double turn_over_spacing = 5;
/// Rounds of planning and measuring; each comes closer.
constexpr int most_rounds = 4;
/// Where no gap is wider than this, in spacings, there is nothing to choose, and a bump is low.
constexpr double wide = 1.15;
/// Hairpins along ridges go on through gaps wider than this, in spacings.
constexpr double wide_on_ridges = 1.1;
/// How far the curve may be moved when it is brought to the part's own mesh.
constexpr double chord_over_spacing = 1e-3;
/// Closing a draft's gaps adds so much to its length; one that could not save more is not worth a plan.
constexpr double least_added = 1.03;
/// Closer levels are to leave no more than what counts as wide anyway.
constexpr double aim = widest_gap;
/// A bump turns in, round its tip, and back: twice by more than 45 degrees at least.
constexpr Index turns_of_bump = 2;

double distance_from_chord(const Vec3& point, const Vec3& from, const Vec3& to) {
  const Vec3 chord = to - from;
  const double t = chord.squaredNorm() > 0 ? std::clamp(chord.dot(point - from) / chord.squaredNorm(), 0.0, 1.0) : 0;
  return (from + t * chord - point).norm();
}

/// Leaves out points inside faces that are no farther than the tolerance from the chord without them: the finer mesh's
/// edges put many of them there, and gaps are looked for from every move.
void thin(const TriangleMesh& mesh, double tolerance, ImpactCurve& curve) {
  std::vector<ImpactPoint> kept;
  std::vector<Vec3> left_out;  // since the last one kept
  const std::vector<ImpactPoint>& points = curve.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto is_near = [&](const Vec3& place) {
      return distance_from_chord(place, kept.back().position, points[i + 1].position) <= tolerance;
    };
    const bool idle = !kept.empty() && i + 1 < points.size() && points[i].kind == points[i + 1].kind &&
                      points[i].kind != MoveKind::lift && kept.back().at.valid() && points[i].at.valid() &&
                      common_face(mesh, kept.back().at, points[i + 1].at) == points[i].at.face &&
                      is_near(points[i].position) && std::all_of(left_out.begin(), left_out.end(), is_near);
    if (idle) {
      left_out.push_back(points[i].position);
      continue;
    }
    kept.push_back(points[i]);
    left_out.clear();
  }
  curve.points = std::move(kept);
}

class Chooser {
 public:
  Chooser(const TriangleMesh& part, const VertexField& function, const FineSurface& fine, const Ridges& ridges,
          const ImpactOptions& options, Progress& progress)
      : part_(part),
        function_(function),
        fine_(fine),
        ridges_(ridges),
        options_(options),
        progress_(progress),
        even_(function, fine.metric ? *fine.metric : IntrinsicGeometry(fine.mesh), options.spacing) {
    options_.close_gaps = false;
    options_.smooth_levels = true;
  }

  RepairedPlan run() {
    RepairedPlan result;
    const ImpactPlan plan = draft(even_, options_.spacing);
    const std::vector<double> gaps = gaps_of(plan.curve);
    result.gap_before = widest(gaps);
    if (result.gap_before <= wide * options_.spacing) {
      result.plan = carried(plan);
      finish_plan(part_, options_, result.plan, progress_);
      return result;
    }
    lower_spacing_by_level(gaps);
    ImpactPlan on_part = carried(plan);
    ImpactPlan ridged = on_part;
    if (has_ridge_passes(ridged)) consider(GapRepair::ridge_pass, std::move(ridged), options_.spacing);
    consider(GapRepair::bumps, std::move(on_part), options_.spacing, turns_of_bump * wide_places(gaps));
    lower_spacing(plan, result.gap_before);
    result.chosen = chosen_;
    result.costs = std::move(costs_);
    result.plan = std::move(best_);
    return result;
  }

 private:
  /// Passes on the finer mesh.
  ImpactPlan draft(const LevelDensity& density, double spacing) const {
    ImpactOptions options = options_;
    options.spacing = spacing;
    options.metric = fine_.geometry();
    return plan_impact(fine_.mesh, density.applied(), options, progress_);
  }

  /// The same on the part's own mesh, whose triangles are as large as its shape allows.
  ImpactPlan carried(ImpactPlan plan) const {
    for (ImpactPoint& point : plan.curve.points) point.at = fine_.trail.on_first(point.at);
    thin(part_, chord_over_spacing * options_.spacing, plan.curve);
    for (Contour& contour : plan.contours) {
      for (SurfacePoint& point : contour.points) point = fine_.trail.on_first(point);
    }
    return plan;
  }

  /// At the vertices of the finer mesh; without windows kept, this costs a fraction of a gap report.
  std::vector<double> gaps_of(const ImpactCurve& curve) const {
    const SourceSet source = cover_elements(fine_.mesh, curve);
    std::vector<double> gaps = fine_.metric ? exact_distances(fine_.mesh, *fine_.metric, source, infinity, progress_)
                                            : exact_distances(fine_.mesh, source, infinity, progress_);
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

  /// Connected sets of vertices that lie in wide gaps.
  Index wide_places(std::span<const double> gaps) const {
    const auto is_open = [&](Index v) {
      return std::isfinite(function_.values()[v]) && std::isfinite(gaps[v]) && gaps[v] > wide * options_.spacing;
    };
    const TriangleMesh& mesh = fine_.mesh;
    DisjointSets places(mesh.n_vertices());
    for (Index e = 0; e < mesh.n_edges(); ++e) {
      const Index h = mesh.halfedge_of(e);
      if (is_open(mesh.from(h)) && is_open(mesh.to(h))) places.join(mesh.from(h), mesh.to(h));
    }
    Index count = 0;
    for (Index v = 0; v < mesh.n_vertices(); ++v) count += is_open(v) && places.root(v) == v;
    return count;
  }

  double cost_of(const GapRepairCost& way) const {
    return way.length + options_.spacing * (lift_over_spacing * way.lifts + turn_over_spacing * way.tight_turns);
  }

  /// Closing the gaps of a draft only adds to it, or hardly less.
  bool can_be_cheapest(GapRepairCost draft, Index turns_to_come = 0) const {
    draft.length *= least_added;
    draft.tight_turns += turns_to_come;
    return cost_of(draft) < least_;
  }

  GapRepairCost figures_of(GapRepair repair, const ImpactPlan& plan, double spacing) const {
    const PathFigures figures = path_figures(plan.curve, options_.spacing);
    return {.repair = repair,
            .length = figures.cover_length + figures.links_length,
            .lifts = figures.lifts,
            .tight_turns = figures.tight_turns,
            .spacing = spacing,
            .planned = false};
  }

  /// Closes the gaps of a draft on the part's mesh, unless it costs more than another way already. Closing them makes
  /// at least so many tight turns.
  void consider(GapRepair repair, ImpactPlan plan, double spacing, Index turns_to_come = 0) {
    GapRepairCost& way = costs_.emplace_back(figures_of(repair, plan, spacing));
    if (!can_be_cheapest(way, turns_to_come)) {
      way.tight_turns += turns_to_come;
      return;
    }
    finish_plan(part_, options_, plan, progress_);
    way = figures_of(repair, plan, spacing);
    way.planned = true;
    if (cost_of(way) >= least_) return;
    least_ = cost_of(way);
    chosen_ = repair;
    best_ = std::move(plan);
  }

  bool has_ridge_passes(ImpactPlan& plan) const {
    const SurfaceLocator locator(part_);
    const SmoothNormals normals(part_);
    const SurfaceLinker linker(part_, locator, progress_);
    const GapLimits limits{.spacing = options_.spacing, .widest = wide_on_ridges, .metric = options_.metric};
    return add_ridge_passes(linker, normals, ridges_, plan.curve, limits, progress_) > 0;
  }

  void lower_spacing_by_level(std::vector<double> gaps) {
    LevelDensity density = even_;
    ImpactPlan plan;
    for (int round = 0; round < most_rounds && widest(gaps) > aim * options_.spacing; ++round) {
      if (!density.raise(gaps, aim * options_.spacing)) break;
      plan = draft(density, options_.spacing);
      if (!can_be_cheapest(figures_of(GapRepair::levels, plan, options_.spacing))) break;
      if (round + 1 < most_rounds) gaps = gaps_of(plan.curve);
    }
    if (!plan.curve.points.empty()) consider(GapRepair::levels, carried(std::move(plan)), options_.spacing);
  }

  void lower_spacing(const ImpactPlan& base, double gap) {
    const double factor = aim * options_.spacing / gap;
    GapRepairCost way = figures_of(GapRepair::spacing, base, factor * options_.spacing);
    way.length /= factor;
    if (can_be_cheapest(way)) return consider(way.repair, carried(draft(even_, way.spacing)), way.spacing);
    costs_.push_back(way);
  }

  const TriangleMesh& part_;
  const VertexField& function_;
  const FineSurface& fine_;
  const Ridges& ridges_;
  ImpactOptions options_;
  Progress& progress_;
  LevelDensity even_;
  std::vector<GapRepairCost> costs_;
  double least_ = infinity;
  GapRepair chosen_ = GapRepair::bumps;
  ImpactPlan best_;
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

RepairedPlan plan_with_repair(const TriangleMesh& part, const VertexField& function, const FineSurface& fine,
                              const std::vector<std::vector<SurfacePoint>>& ridges, const ImpactOptions& options,
                              Progress& progress) {
  options.validate();
  return Chooser(part, function, fine, ridges, options, progress).run();
}

}  // namespace isopath
