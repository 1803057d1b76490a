#include "isopath/plan/run_plan.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "isopath/contour/blend_mesh.h"
#include "isopath/core/error.h"
#include "isopath/core/quiet_progress.h"
#include "isopath/core/side_by_side.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/vertex_field.h"
#include "isopath/impact/cover_field.h"
#include "isopath/impact/finish_curve.h"
#include "isopath/impact/level_spiral.h"
#include "isopath/impact/min_radius.h"
#include "isopath/plan/auto_pattern.h"
#include "isopath/plan/gap_choice.h"
#include "isopath/plan/hole_bridges.h"
#include "isopath/plan/make_programs.h"
#include "isopath/plan/make_sources.h"
#include "isopath/plan/nested_plan.h"
#include "isopath/plan/part_checks.h"
#include "isopath/plan/planar_direction.h"
#include "isopath/plan/scallop_metric.h"
#include "isopath/plan/smooth_part.h"
#include "isopath/tool/make_tool_path.h"

namespace isopath {
namespace {

/// Shares of the part's size that are taken where the job names no spacing.
constexpr double passes_over_size = 60;

/// So many passes across a part of a metre lie 0.05 mm apart, finer than any finishing. More of them are a slip of the
/// keyboard or of the unit, and would run for days.
constexpr double most_passes = 20000;
/// The tool's path may leave out no more than this of the spacing, whatever tolerance the job allows: on a part of a
/// millimetre a hundredth of one is half the way to the next pass.
constexpr double most_chord_over_spacing = 0.02;
/// A ball that goes deeper into the part than this share of its radius is told of: facets of a mesh let it go a little.
constexpr double gouge_over_radius = 0.02;
/// Lifts higher than so many sizes of the part leave no digits for the part itself.
constexpr double most_clearance_over_size = 1000;

class StageClock {
 public:
  explicit StageClock(std::vector<StageTime>& times) : times_(times) {}
  /// The stage that ran since the last call ends.
  void ends(const char* stage) {
    const auto now = Clock::now();
    times_.push_back({stage, std::chrono::duration<double>(now - last_).count()});
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<StageTime>& times_;
  Clock::time_point last_ = Clock::now();
};

/// The most memory the process has held at once.
double peak_memory_mb() {
  struct rusage usage {};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;  // Linux counts in KiB
}

double spacing_of(const Job& job, const TriangleMesh& mesh, std::vector<std::string>& warnings) {
  if (job.spacing > 0) return job.spacing;
  if (job.scallop > 0) return scallop_pitch(job.scallop, 0.5 * job.tool.ball_diameter);
  const double spacing = mesh.size() / passes_over_size;
  warnings.push_back(
      fmt::format("no spacing was given: {:.4g} mm was taken, 1/{:.0f} of the part's size", spacing, passes_over_size));
  return spacing;
}

/// Refuses lengths that cannot be meant for a part of this size.
void check_against_size(const Job& job, double spacing, double size) {
  if (spacing > size) {
    throw Error(ErrorCode::no_plan, "the spacing is larger than the part",
                {.element = "spacing",
                 .value = fmt::format("{:.6g} mm, the part measures {:.6g} mm", spacing, size),
                 .advice = "give a smaller spacing, or the unit of the mesh file when that is not mm"});
  }
  if (job.clearance > most_clearance_over_size * size) {
    throw Error(ErrorCode::bad_usage, "lifts this high leave the part out of sight",
                {.element = "clearance",
                 .value = fmt::format("{:.6g} mm, limit {:.6g} mm: {} times the part's size", job.clearance,
                                      most_clearance_over_size * size, most_clearance_over_size)});
  }
}

/// Refuses a spacing that gives more passes than anybody wants.
void check_pass_count(const std::vector<double>& values, double spacing) {
  double low = infinity;
  double high = -infinity;
  for (const double value : values) {
    if (!(value < infinity)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(high - low > most_passes * spacing)) return;
  throw Error(
      ErrorCode::bad_usage, "the spacing is too small for the part",
      {.element = "spacing",
       .value = fmt::format("{:.6g} mm makes {:.3g} passes, limit {}", spacing, (high - low) / spacing, most_passes),
       .advice = fmt::format("give {:.3g} mm or more, or the unit of the mesh file when that is not mm",
                             1.001 * (high - low) / most_passes)});
}

/// Bound on the error of distances, as a part of the part's size: half of what isolines are promised to keep, and
/// far below any machine's; it saves most of the windows that fans of nearly flat vertices would cost.
constexpr double field_accuracy = 5e-7;

struct Field {
  std::unique_ptr<SurfaceFunction> function;
  std::vector<double> at_vertices;
  double spacing = 0;                                  ///< of nested levels; 0 where the function is not made for such
  std::vector<std::vector<SurfacePoint>> ridges = {};  ///< see FieldSamples; none where nothing was smoothed
};

/// A closed curve is crossed an even number of times between two places of the boundary, and so goes to and fro along
/// all of the medial axis. Each hole that distances are measured from adds a loop to that axis, longer than the hole's
/// edge; passes that end at the hole follow only half of this edge.
AutoLoops loops_for(const Job& job) {
  return job.pattern == Pattern::two_way && !form_of(job.blend) ? AutoLoops::longest : AutoLoops::all;
}

ExactField distances_on(const Part& part, const Job& job, const IntrinsicGeometry* metric, AutoLoops loops,
                        double accuracy, Progress& progress) {
  const SourceSet sources = make_sources(part.mesh, job.sources, part.vertex_of_file_vertex, progress, loops);
  const ExactFieldOptions options{.accuracy = accuracy, .many_questions = true};
  return metric ? ExactField::compute(part.mesh, *metric, sources, options, progress)
                : ExactField::compute(part.mesh, sources, options, progress);
}

/// Puts a finer mesh of the same surface in the part's place, and the metric's lengths on it.
void refine_part(RefinedMesh refined, Part& part, std::optional<IntrinsicGeometry>& metric) {
  std::vector<double> lengths;
  if (metric) lengths = lengths_in(part.mesh, *metric, refined);
  part.mesh = std::move(refined.mesh);
  if (metric) metric.emplace(part.mesh, lengths);
}

/// The smoothed distances, on a part that is made fine enough for them. The field of the part as it is must be exact,
/// for the medial axis.
Field smoothed_field(PlanResult& result, std::optional<IntrinsicGeometry>& metric, Progress& progress) {
  const double width = result.job.smooth;
  refine_part(refine_for_smoothing(result.part.mesh, result.spacing, width), result.part, metric);
  const IntrinsicGeometry* geometry = metric ? &*metric : nullptr;
  FieldSamples samples = sample_for_smoothing(
      distances_on(result.part, result.job, geometry, loops_for(result.job), 0, progress), result.spacing, progress);
  refine_part(std::move(samples.refined), result.part, metric);
  geometry = metric ? &*metric : nullptr;
  std::vector<double> values = smoothed_distances(result.part.mesh, geometry, samples.distances, width, progress);
  auto function = std::make_unique<VertexField>(result.part.mesh, values);
  return {.function = std::move(function), .at_vertices = std::move(values), .ridges = std::move(samples.ridges)};
}

Field exact_field(const PlanResult& result, const IntrinsicGeometry* metric, AutoLoops loops, Progress& progress) {
  auto exact = std::make_unique<ExactField>(
      distances_on(result.part, result.job, metric, loops, field_accuracy * result.part.mesh.size(), progress));
  std::vector<double> values(exact->vertex_distances().begin(), exact->vertex_distances().end());
  return {std::move(exact), std::move(values)};
}

Vec3 direction_of_planes(const Job& job, const TriangleMesh& mesh) {
  return job.planar_direction.isZero(0) ? planar_direction_of(mesh) : job.planar_direction;
}

Field field_of(PlanResult& result, std::optional<IntrinsicGeometry>& metric, Progress& progress) {
  progress.stage("distance field");
  const TriangleMesh& mesh = result.part.mesh;
  if (result.job.pattern == Pattern::planar) {
    auto height = std::make_unique<VertexField>(height_field(mesh, direction_of_planes(result.job, mesh)));
    std::vector<double> values(height->values().begin(), height->values().end());
    return {std::move(height), std::move(values)};
  }
  if (result.job.smooth > 0) return smoothed_field(result, metric, progress);
  return exact_field(result, metric ? &*metric : nullptr, loops_for(result.job), progress);
}

void warn_of_unreached(const TriangleMesh& mesh, const std::vector<double>& distances,
                       std::vector<std::string>& warnings) {
  std::vector<char> reached(mesh.n_components(), 0);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    for (const Index v : mesh.triangle(f)) {
      if (distances[v] < infinity) reached[mesh.component_of(f)] = 1;
    }
  }
  const auto unreached = std::count(reached.begin(), reached.end(), 0);
  if (unreached == 0) return;
  warnings.push_back(
      fmt::format("{} of the part's {} components hold no source and are not covered", unreached, mesh.n_components()));
}

void append(std::vector<std::string>& all, const std::vector<std::string>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

/// Cuts the part open where nested levels need it; its field is then that of the part cut open. False where there are
/// none to be had.
bool open_for_nesting(PlanResult& result, Field& field, Progress& progress) {
  TriangleMesh& mesh = result.part.mesh;
  const NestedShape shape = nested_shape_of(mesh);
  if (shape == NestedShape::disc) return true;
  std::optional<TriangleMesh> opened;
  if (shape == NestedShape::annulus && result.job.blend == Blending::least)
    opened = opened_annulus(mesh, result.spacing, progress);
  if (shape == NestedShape::holes) opened = opened_holes(mesh, result.spacing, progress);
  if (!opened) return shape == NestedShape::annulus;
  result.warnings.push_back(
      shape == NestedShape::annulus
          ? "the annulus is of uneven width: levels from loop to loop would be wasteful, so it was planned as if cut "
            "open where it is narrowest"
          : "the part has holes: no level goes round all of them, so it was planned as if cut open along the shortest "
            "ways between them");
  field.function.reset();
  mesh = *std::move(opened);
  std::optional<IntrinsicGeometry> in_space;
  field = field_of(result, in_space, progress);
  return true;
}

/// The function whose levels are nested closed curves, on a mesh that is fine enough for the distances and is made
/// finer where its levels need it.
Field nested_field_on(TriangleMesh fine, BlendForm form, PlanResult& result, Progress& progress) {
  const double spacing = result.spacing;
  const double radius = result.job.min_radius > 0 ? result.job.min_radius : default_radius_in_spacings * spacing;
  TriangleMesh& mesh = result.part.mesh;
  std::optional<IntrinsicGeometry> in_space;
  NestedField nested;
  for (int round = 0; round < 2; ++round) {
    mesh = std::move(fine);
    const Field field = field_of(result, in_space, progress);
    nested = nested_field(form, static_cast<const ExactField&>(*field.function), spacing, radius, progress);
    fine = refine_for_levels(mesh, nested.values, nested.spacing, progress);
    if (fine.n_faces() < 1.05 * mesh.n_faces()) break;  // single triangles are not worth it
  }
  std::vector<double> values = nested.values;
  return {std::make_unique<VertexField>(mesh, std::move(nested.values)), std::move(values), nested.spacing};
}

/// The function whose levels are nested closed curves, on a mesh made fine enough for it. A part that has none keeps
/// the field it has, and a two-way curve is planned.
Field nested_field_of(PlanResult& result, Field field, Progress& progress) {
  if (!open_for_nesting(result, field, progress)) {
    result.warnings.push_back(
        "the part has handles: no isoline goes round all of them, so nothing was blended and a two-way curve was "
        "planned");
    result.pattern = Pattern::two_way;
    return field;
  }
  TriangleMesh fine = refine_for_blend(result.part.mesh, *field.function, result.spacing, progress);
  field.function.reset();
  return nested_field_on(std::move(fine), *form_of(result.job.blend), result, progress);
}

ImpactPlan plan_nested(const PlanResult& result, const Field& field, Progress& progress) {
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
void plan_curve(PlanResult& result, Field& field, const IntrinsicGeometry* metric, Progress& progress) {
  const TriangleMesh& mesh = result.part.mesh;
  ImpactOptions options = options_of(result, metric);
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
    Field one_loop;
    const auto two_way_function = [&]() -> const SurfaceFunction& {
      if (smooth || mesh.boundary_loops().size() < 2) return *field.function;
      one_loop = exact_field(result, metric, AutoLoops::longest, progress);
      return *one_loop.function;
    };
    ChosenPlan chosen = plan_by_part(mesh, *field.function, field.at_vertices, options, progress, two_way_function);
    if (chosen.pattern == Pattern::two_way && one_loop.function) field = std::move(one_loop);
    options.pattern = chosen.pattern;
    result.impact = std::move(chosen.plan);
  }
  result.pattern = options.pattern;
  if (smooth) {
    RepairedPlan repaired =
        plan_with_repair(static_cast<const VertexField&>(*field.function), options, field.ridges, progress);
    result.impact = std::move(repaired.plan);
    result.smoothing = {repaired.gap_before, repaired.chosen, std::move(repaired.costs)};
  }
  append(result.warnings, result.impact.warnings);
}

/// A blended spiral with the part it is planned on; none where its levels are not nested closed curves.
struct BlendedSpiral {
  Part part;
  ImpactPlan impact;
  std::vector<double> levels;  ///< the function at the vertices
  double spacing = 0;          ///< of its levels
};
std::optional<BlendedSpiral> blended_spiral(const PlanResult& result, const Field& field, Progress& progress) {
  PlanResult trial;
  trial.job = result.job;
  trial.part = result.part;
  trial.spacing = result.spacing;
  try {
    TriangleMesh fine = refine_for_blend(trial.part.mesh, *field.function, trial.spacing, progress);
    Field nested = nested_field_on(std::move(fine), BlendForm::least, trial, progress);
    ImpactPlan impact = plan_nested(trial, nested, progress);
    return BlendedSpiral{std::move(trial.part), std::move(impact), std::move(nested.at_vertices), nested.spacing};
  } catch (const Error& error) {
    if (error.code() != ErrorCode::no_plan) throw;
    return std::nullopt;
  }
}

/// Puts a blended spiral in the place of the part and field that it was made from.
void take(BlendedSpiral blended, PlanResult& result, Field& field) {
  result.part = std::move(blended.part);
  result.impact = std::move(blended.impact);
  result.pattern = Pattern::spiral;
  append(result.warnings, result.impact.warnings);
  field.function = std::make_unique<VertexField>(result.part.mesh, blended.levels);
  field.at_vertices = std::move(blended.levels);
  field.spacing = blended.spacing;
}

/// Plans the spiral by the distance alone first, and a blended one if there is something to win. The curve is finished.
void choose_spiral(PlanResult& result, Field& field, Progress& progress) {
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

double length_ratio_of(const PlanResult& result, const IntrinsicGeometry* metric) {
  if (!metric) return result.figures.cover_length * result.spacing / result.gap.area;
  const TriangleMesh& mesh = result.part.mesh;
  return cover_length(mesh, result.impact.curve, *metric) * result.spacing / area_in(mesh, *metric);
}

/// Half a spacing is the size of what the path can be rounded by without leaving gaps.
void warn_of_axis_jumps(const PlanResult& result, std::vector<std::string>& warnings, const Progress& progress) {
  if (result.job.tool.axis_mode != AxisMode::surface_normal) return;
  const double reach = 0.5 * result.spacing;
  const AxisJumps jumps = axis_jumps(result.impact.curve, reach, progress);
  if (jumps.count == 0) return;
  warnings.push_back(
      fmt::format("the tool axis turns by more than 30 degrees within {:.3g} mm at {} places, by {:.0f} degrees at "
                  "({:.4g}, {:.4g}, {:.4g}): a machine slows down or swings out there; a fixed axis, or a part with "
                  "rounded edges, avoids it",
                  reach, jumps.count, jumps.worst * 180 / std::numbers::pi, jumps.at.x(), jumps.at.y(), jumps.at.z()));
}

/// Looks at the whole curve: links between patches have corners, too.
void find_tight_places(PlanResult& result, const Progress& progress) {
  const double wanted = result.job.min_radius;
  if (!(wanted > 0)) return;
  result.tight = tight_places(result.part.mesh, result.impact.curve, wanted, progress);
  if (result.tight.empty()) return;
  const auto worst = std::min_element(result.tight.begin(), result.tight.end(),
                                      [](const TightPlace& a, const TightPlace& b) { return a.radius < b.radius; });
  result.warnings.push_back(fmt::format(
      "the curve turns with less than the radius of {:.4g} mm at {} places, with {:.3g} mm at ({:.4g}, "
      "{:.4g}, {:.4g})",
      wanted, result.tight.size(), worst->radius, worst->position.x(), worst->position.y(), worst->position.z()));
}

std::optional<GougeReport> gouges_of(const PlanResult& result, const ToolOptions& tool, const Progress& progress) {
  if (tool.process == Process::spray) return std::nullopt;
  const double radius = 0.5 * tool.ball_diameter;
  const double tolerance = std::max(2 * tool.chord_tolerance, gouge_over_radius * radius);
  return measure_gouges(result.part.mesh, result.tool, radius, tolerance, progress);
}

void warn_of_gouges(PlanResult& result) {
  if (!result.gouge || result.gouge->deepest == 0) return;
  const Vec3& p = result.gouge->place;
  result.warnings.push_back(fmt::format(
      "the ball cuts into the part along {:.2g} % of its way, by {:.3g} mm at ({:.4g}, {:.4g}, {:.4g}): inner edges "
      "and "
      "hollows there are narrower than its radius of {:.4g} mm; take a smaller ball, or leave these places out",
      100 * result.gouge->share, result.gouge->deepest, p.x(), p.y(), p.z(), 0.5 * result.job.tool.ball_diameter));
}

/// The metric that gives constant scallops, with the part made fine enough for it; none where the job asks for none.
std::optional<IntrinsicGeometry> warp_for_scallop(const Job& job, PlanResult& result, Progress& progress) {
  if (!(job.scallop > 0)) return std::nullopt;
  result.scallop.emplace();
  if (job.pattern == Pattern::planar) return std::nullopt;
  ScallopMetric metric = scallop_metric(result.part.mesh, 0.5 * job.tool.ball_diameter, result.spacing, progress);
  append(result.warnings, metric.warnings);
  result.scallop->clamped_fraction = metric.clamped_fraction;
  result.scallop->gouged_fraction = metric.gouged_fraction;
  result.part.mesh = std::move(metric.mesh);
  return IntrinsicGeometry(result.part.mesh, metric.edge_lengths);
}

void measure(PlanResult& result, const IntrinsicGeometry* metric, Progress& progress) {
  progress.stage("gap");
  const TriangleMesh& mesh = result.part.mesh;
  const CoverField cover = distance_from_cover(mesh, result.impact.curve, result.spacing, progress, metric);
  result.gap = measure_gap(cover, result.spacing, progress);
  if (!result.job.report) return;
  DisplaySurface& display = result.display;
  display.gap = values_at_vertices(cover.field, display.refined, cover.field.vertex_distances(), progress);
  for (double& gap : display.gap) gap *= 2;
}

/// All of the part by one field.
void plan_whole(PlanResult& result, std::optional<IntrinsicGeometry>& metric, StageClock& clock, Progress& progress) {
  const TriangleMesh& mesh = result.part.mesh;
  Field field = field_of(result, metric, progress);
  check_pass_count(field.at_vertices, result.spacing);
  check_facing(mesh, field.at_vertices, result.job.tool);
  warn_of_unreached(mesh, field.at_vertices, result.warnings);
  if (form_of(result.job.blend)) {
    result.pattern = result.job.pattern.value_or(Pattern::spiral);
    field = nested_field_of(result, std::move(field), progress);
  }
  clock.ends("field");

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
  const bool is_planned = !result.impact.curve.points.empty();

  // a curve is made of one thing after the other: a second processor gets the picture ready meanwhile
  side_by_side(
      [&] {
        if (!is_planned) plan_curve(result, field, metric ? &*metric : nullptr, progress);
      },
      [&] {
        if (result.job.report) result.display.refined = refine_for_display(mesh, result.spacing);
      });
  if (too_fine > 0 && result.pattern == Pattern::spiral) result.spiral.emplace().too_fine = too_fine;
  result.distances = std::move(field.at_vertices);
  if (result.job.report) {
    DisplaySurface& display = result.display;
    display.distances = values_at_vertices(*field.function, display.refined, result.distances, progress);
  }
  // the field ends here: its windows are the largest thing in memory, and the gap needs windows of its own
  field.function.reset();
  clock.ends("impact");
}

/// Patch by patch, each with a field from its own border.
void plan_by_patches(PlanResult& result, StageClock& clock, Progress& progress) {
  const Job& job = result.job;
  check_pass_count({0, 0.5 * result.part.mesh.size()}, result.spacing);
  Partition parts = partition(std::move(result.part.mesh), result.spacing, job.partition, progress);
  clock.ends("partition");
  RefinedMesh shown;
  if (job.report) shown = parted(refine_for_display(parts.mesh, result.spacing), parts.patch_of_face);
  const PatchPlanOptions options{.pattern = job.pattern,
                                 .planar_direction = direction_of_planes(job, parts.mesh),
                                 .spacing = result.spacing,
                                 .clearance = job.clearance,
                                 .circle_radius = job.circle_radius,
                                 .circle_step = job.circle_step,
                                 .min_radius = job.min_radius,
                                 .accuracy = field_accuracy * parts.mesh.size()};
  PatchedPlan plan = plan_patches(parts, options, job.report ? &shown : nullptr, progress);
  result.part.mesh = std::move(parts.mesh);
  check_facing(result.part.mesh, plan.distances, job.tool);
  result.pattern = plan.patches.front().pattern;
  append(result.warnings, plan.impact.warnings);
  result.impact = std::move(plan.impact);
  result.patches = std::move(plan.patches);
  result.patch_of_face = std::move(plan.patch_of_face);
  result.distances = std::move(plan.distances);
  result.display = {std::move(shown), std::move(plan.display_distances), {}};
  clock.ends("impact");
}

}  // namespace

PlanResult run_plan(const Job& job, Progress& progress) {
  job.validate();
  PlanResult result;
  result.job = job;
  if (job.pattern == Pattern::double_spiral && !form_of(job.blend)) result.job.blend = Blending::least;
  StageClock clock(result.times);

  result.part = load_part(job.mesh, job.unit, progress);
  append(result.warnings, result.part.warnings);
  const TriangleMesh& mesh = result.part.mesh;
  clock.ends("read");

  if (auto warning = warning_of_size(mesh.size(), job.unit != LengthUnit::millimetre)) {
    result.warnings.push_back(*std::move(warning));
  }
  if (auto warning = warning_of_tool(job.tool, mesh.size())) result.warnings.push_back(*std::move(warning));
  result.spacing = spacing_of(job, mesh, result.warnings);
  check_against_size(job, result.spacing, mesh.size());
  if (job.min_radius > 0) check_min_radius(mesh, job.min_radius);
  std::optional<IntrinsicGeometry> warped = warp_for_scallop(job, result, progress);
  if (job.partition.by != PartitionBy::none) {
    plan_by_patches(result, clock, progress);
  } else {
    plan_whole(result, warped, clock, progress);
  }
  const IntrinsicGeometry* metric = warped ? &*warped : nullptr;

  ToolOptions tool = job.tool;
  tool.chord_tolerance = std::min(tool.chord_tolerance, most_chord_over_spacing * result.spacing);
  QuietProgress quiet(progress);
  side_by_side([&] { measure(result, metric, progress); },
               [&] {
                 result.figures = path_figures(result.impact.curve, result.spacing, result.impact.radius);
                 result.tool = make_tool_path(result.impact.curve, tool, quiet);
                 result.gouge = gouges_of(result, tool, quiet);
               });
  result.length_ratio = length_ratio_of(result, metric);
  clock.ends("gap");

  if (auto warning = warning_of_gap(mesh, result.gap, result.spacing)) result.warnings.push_back(*std::move(warning));
  warn_of_gouges(result);
  find_tight_places(result, progress);

  if (result.scallop) {
    result.scallop->measured =
        measure_scallop(mesh, result.impact.curve, 0.5 * job.tool.ball_diameter, result.spacing, progress);
    clock.ends("scallop");
  }

  progress.stage("tool path");
  warn_of_axis_jumps(result, result.warnings, progress);
  clock.ends("tool");

  progress.stage("program");
  result.programs = make_programs(result.tool, job, result.warnings);
  clock.ends("program");
  result.peak_memory_mb = peak_memory_mb();
  return result;
}

}  // namespace isopath
