#include "isopath/plan/whole_plan.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "isopath/contour/blend_mesh.h"
#include "isopath/core/error.h"
#include "isopath/core/side_by_side.h"
#include "isopath/field/vertex_field.h"
#include "isopath/impact/level_spiral.h"
#include "isopath/plan/auto_pattern.h"
#include "isopath/plan/gap_choice.h"
#include "isopath/plan/part_checks.h"
#include "isopath/plan/part_field.h"
#include "isopath/plan/spiral_choice.h"

namespace isopath {
namespace {

ImpactPlan plan_nested(const PlanResult& result, const PartField& field, Progress& progress) {
  return level_spiral(static_cast<const VertexField&>(*field.function),
                      {.arms = result.pattern == Pattern::double_spiral ? 2 : 1,
                       .spacing = field.spacing,
                       .asked_spacing = result.spacing,
                       .clearance = result.job.clearance,
                       .min_radius = result.job.min_radius},
                      progress);
}

ImpactOptions options_of(const PlanResult& result, const IntrinsicGeometry* metric) {
  return {.spacing = result.spacing,
          .clearance = result.job.clearance,
          .circle_radius = result.job.circle_radius,
          .circle_step = result.job.circle_step,
          .min_radius = result.job.min_radius,
          .metric = metric};
}

/// The impact curve, with the pattern the job names or one that suits the part.
void plan_curve(PlanResult& result, PartField& field, const IntrinsicGeometry* metric, Progress& progress) {
  const TriangleMesh& mesh = field.mesh_of(result.part);
  ImpactOptions options = options_of(result, field.fine ? field.fine->geometry() : metric);
  const bool smooth = result.job.smooth > 0;
  if (form_of(result.job.blend)) {
    const bool is_spiral = result.pattern == Pattern::spiral || result.pattern == Pattern::double_spiral;
    options.pattern = result.pattern;
    result.impact = field.spacing > 0 && is_spiral ? plan_nested(result, field, progress)
                                                   : plan_impact(mesh, *field.function, options, progress);
  } else if (result.job.pattern) {
    options.pattern = *result.job.pattern;
    if (!smooth) result.impact = plan_impact(mesh, *field.function, options, progress);
  } else {
    options.close_gaps = !smooth;  // plan_with_repair does
    PartField one_loop;
    const auto two_way_function = [&]() -> const SurfaceFunction& {
      if (smooth || mesh.boundary_loops().size() < 2) return *field.function;
      one_loop = exact_field_of(result, metric, AutoLoops::longest, progress);
      return *one_loop.function;
    };
    ChosenPlan chosen = plan_by_part(mesh, *field.function, field.at_vertices, options, progress, two_way_function);
    if (chosen.pattern == Pattern::two_way && one_loop.function) field = std::move(one_loop);
    options.pattern = chosen.pattern;
    result.impact = std::move(chosen.plan);
  }
  result.pattern = options.pattern;
  if (smooth) {
    options.metric = metric;
    RepairedPlan repaired = plan_with_repair(result.part.mesh, static_cast<const VertexField&>(*field.function),
                                             *field.fine, field.ridges, options, progress);
    result.impact = std::move(repaired.plan);
    result.smoothing = {repaired.gap_before, repaired.chosen, std::move(repaired.costs)};
  }
  result.warn_of(result.impact.warnings);
}

/// A blended spiral with the part it is planned on; none where its levels are not nested closed curves.
struct BlendedSpiral {
  Part part;
  RefinementTrail trail;
  ImpactPlan impact;
  std::vector<double> levels;  ///< the function at the vertices
  double spacing = 0;          ///< of its levels
};
std::optional<BlendedSpiral> blended_spiral(const PlanResult& result, const PartField& field, Progress& progress) {
  PlanResult trial;
  trial.job = result.job;
  trial.part = result.part;
  trial.trail = result.trail;
  trial.spacing = result.spacing;
  try {
    RefinedMesh fine = refine_for_blend(trial.part.mesh, *field.function, trial.spacing, progress);
    PartField nested = nested_field_on(std::move(fine), BlendForm::least, trial, progress);
    ImpactPlan impact = plan_nested(trial, nested, progress);
    return BlendedSpiral{std::move(trial.part), std::move(trial.trail), std::move(impact),
                         std::move(nested.at_vertices), nested.spacing};
  } catch (const Error& error) {
    if (error.code() != ErrorCode::no_plan) throw;
    return std::nullopt;
  }
}

/// Puts a blended spiral in the place of the part and field that it was made from.
void take(BlendedSpiral blended, PlanResult& result, PartField& field) {
  result.part = std::move(blended.part);
  result.trail = std::move(blended.trail);
  result.impact = std::move(blended.impact);
  result.pattern = Pattern::spiral;
  result.warn_of(result.impact.warnings);
  field.function = std::make_unique<VertexField>(result.part.mesh, blended.levels);
  field.at_vertices = std::move(blended.levels);
  field.spacing = blended.spacing;
}

/// Plans the spiral by the distance alone first, and a blended one if there is something to win. The curve is finished.
void choose_spiral(PlanResult& result, PartField& field, Progress& progress) {
  const double spacing = result.spacing;
  const double area = result.part.mesh.area();
  SpiralChoice& choice = *result.spiral;
  ImpactOptions options = options_of(result, nullptr);
  options.close_gaps = false;  // a curve with gaps is shorter: it need not be closed to lose
  {
    const ImpactPlan draft = plan_impact(result.part.mesh, *field.function, options, progress);
    choice.by_distance = cost_of(draft.curve, spacing, false);
  }
  std::optional<BlendedSpiral> blended;
  if (!is_good_spiral(*choice.by_distance, area, spacing)) blended = blended_spiral(result, field, progress);
  if (!blended) return plan_curve(result, field, nullptr, progress);

  choice.by_blend = cost_of(blended->impact.curve, spacing, true);
  if (!may_cover(*choice.by_blend, area, spacing)) return plan_curve(result, field, nullptr, progress);
  const double cost = as_length(*choice.by_blend, spacing);
  // where no pattern was named, a two-way curve may be shorter than either
  const bool is_long = !result.job.pattern && choice.by_blend->length * spacing > good_length_ratio * area;
  if (is_long || as_length(*choice.by_distance, spacing) < cost) {
    const std::size_t n_warnings = result.warnings.size();
    plan_curve(result, field, nullptr, progress);
    choice.by_distance = cost_of(result.impact.curve, spacing, true);
    if (as_length(*choice.by_distance, spacing) <= cost) return;
    result.warnings.resize(n_warnings);
  }
  choice.blended = true;
  take(*std::move(blended), result, field);
}

/// A picture of the finer mesh, as one of the part.
void carry_to_part(const RefinementTrail& trail, RefinedMesh& shown) {
  for (SurfacePoint& point : shown.on_old) point = trail.on_first(point);
  for (Index& face : shown.old_face) face = trail.on_first({face, Vec3::UnitX()}).face;
}

/// The two-way curve, which is closed as well. Passes need not be nested, and so follow the longest loop alone:
/// distances from holes add a loop to the medial axis for each of them.
PartField plan_closed_two_way(PlanResult& result, Progress& progress) {
  const std::vector<SourceSpec> asked = std::exchange(result.job.sources, {SourceSpec{}});
  PartField field = exact_field_of(result, nullptr, AutoLoops::longest, progress);
  result.job.sources = asked;
  ImpactOptions options = options_of(result, nullptr);
  options.pattern = Pattern::two_way;
  result.impact = plan_impact(result.part.mesh, *field.function, options, progress);
  result.pattern = Pattern::two_way;
  return field;
}

/// Plans the two-way curve and the double spiral on a part with holes, and takes the cheaper one. `field` is taken
/// over: the exact distances from the whole rim.
PartField choose_closed_curve(PlanResult& result, PartField field, Progress& progress) {
  const double spacing = result.spacing;
  const double area = result.part.mesh.area();
  SpiralChoice& choice = result.spiral.emplace();
  field.function.reset();  // one field in memory at a time
  field = plan_closed_two_way(result, progress);
  choice.by_two_way = cost_of(result.impact.curve, spacing, true);

  PlanResult trial;
  trial.job = result.job;
  trial.job.blend = Blending::least;
  trial.part = result.part;
  trial.trail = result.trail;
  trial.spacing = spacing;
  trial.pattern = Pattern::double_spiral;
  PartField nested;
  try {
    nested = nested_field_of(trial, field_of(trial, nullptr, progress), progress);
    trial.impact = plan_nested(trial, nested, progress);
    choice.by_blend = cost_of(trial.impact.curve, spacing, true);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::no_plan) throw;
  }
  const bool nested_is_better = choice.by_blend && may_cover(*choice.by_blend, area, spacing) &&
                                (!may_cover(*choice.by_two_way, area, spacing) ||
                                 as_length(*choice.by_blend, spacing) <= as_length(*choice.by_two_way, spacing));
  if (nested_is_better) {
    choice.blended = true;
    result.warn_of(trial.warnings);
    result.pattern = trial.pattern;
    result.impact = std::move(trial.impact);
    result.part = std::move(trial.part);
    result.trail = std::move(trial.trail);
    nested.function = std::make_unique<VertexField>(result.part.mesh, nested.at_vertices);
    field = std::move(nested);
  }
  result.warn_of(result.impact.warnings);
  return field;
}

}  // namespace

void plan_whole(PlanResult& result, const IntrinsicGeometry* metric, StageClock& clock, Progress& progress,
                double display_share) {
  const TriangleMesh& mesh = result.part.mesh;
  PartField field = field_of(result, metric, progress);
  check_pass_count(field.at_vertices, result.spacing);
  check_reach(mesh, field.at_vertices, result.job);
  warn_of_unreached(mesh, field.at_vertices, result.warnings);
  const bool may_be_two_way = may_close_two_way(result.job, mesh, field.at_vertices);
  if (result.job.pattern == Pattern::double_spiral && result.job.blend == Blending::automatic && !may_be_two_way)
    result.job.blend = Blending::least;
  if (form_of(result.job.blend)) {
    result.pattern = result.job.pattern.value_or(Pattern::spiral);
    field = nested_field_of(result, std::move(field), progress);
  }
  clock.ends("field");

  if (may_be_two_way) field = choose_closed_curve(result, std::move(field), progress);
  double too_fine = 0;
  if (may_blend_spiral(result.job, mesh, field.at_vertices)) {
    const double triangles = triangles_for_blend(mesh, result.spacing);
    if (triangles > most_triangles_unasked) {
      too_fine = triangles;
    } else if (result.job.pattern ||
               pattern_by_isolines(mesh, *field.function, field.at_vertices, progress) == Pattern::spiral) {
      result.spiral.emplace();
      choose_spiral(result, field, progress);
    }
  }
  const TriangleMesh& shown = field.mesh_of(result.part);
  const bool is_planned = !result.impact.curve.points.empty();

  // a curve is made of one thing after the other: a second processor gets the picture ready meanwhile
  side_by_side(
      [&] {
        if (!is_planned) plan_curve(result, field, metric, progress);
      },
      [&] {
        if (result.job.report) result.display.refined = refine_for_display(shown, result.spacing, display_share);
      });
  if (too_fine > 0 && result.pattern == Pattern::spiral) result.spiral.emplace().too_fine = too_fine;
  if (result.job.report) {
    DisplaySurface& display = result.display;
    display.distances = values_at_vertices(*field.function, display.refined, field.at_vertices, progress);
    if (field.fine) carry_to_part(field.fine->trail, display.refined);
  }
  result.distances = std::move(field.at_vertices);
  result.distances.resize(mesh.n_vertices());  // finer meshes only add vertices
  // the field ends here: its windows are the largest thing in memory, and the gap needs windows of its own
  field.function.reset();
  clock.ends("impact");
}

}  // namespace isopath
