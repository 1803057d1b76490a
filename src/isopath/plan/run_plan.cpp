#include "isopath/plan/run_plan.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/core/quiet_progress.h"
#include "isopath/core/side_by_side.h"
#include "isopath/impact/cover_field.h"
#include "isopath/impact/min_radius.h"
#include "isopath/plan/make_programs.h"
#include "isopath/plan/part_checks.h"
#include "isopath/plan/part_field.h"
#include "isopath/plan/patch_plans.h"
#include "isopath/plan/scallop_metric.h"
#include "isopath/plan/stage_clock.h"
#include "isopath/plan/whole_plan.h"
#include "isopath/tool/make_tool_path.h"

namespace isopath {
namespace {

/// Shares of the part's size that are taken where the job names no spacing.
constexpr double passes_over_size = 60;

/// The tool's path may leave out no more than this of the spacing, whatever tolerance the job allows: on a part of a
/// millimetre a hundredth of one is half the way to the next pass.
constexpr double most_chord_over_spacing = 0.02;
/// A ball that goes deeper into the part than this share of its radius is told of: facets of a mesh let it go a little.
constexpr double gouge_over_radius = 0.02;
/// Lifts higher than so many sizes of the part leave no digits for the part itself.
constexpr double most_clearance_over_size = 1000;

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
  if (job.smooth > 0 && job.smooth < least_smoothing_over_spacing * spacing) {
    throw Error(ErrorCode::bad_usage, "smoothing over so little rounds no corner that the tool would notice",
                {.element = "smooth",
                 .value = fmt::format("{:.6g} mm, limit {:.6g} mm: a quarter of the spacing", job.smooth,
                                      least_smoothing_over_spacing * spacing),
                 .advice = "give a spacing or two, or leave it out"});
  }
  if (job.clearance > most_clearance_over_size * size) {
    throw Error(ErrorCode::bad_usage, "lifts this high leave the part out of sight",
                {.element = "clearance",
                 .value = fmt::format("{:.6g} mm, limit {:.6g} mm: {} times the part's size", job.clearance,
                                      most_clearance_over_size * size, most_clearance_over_size)});
  }
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
std::optional<IntrinsicGeometry> warp_for_scallop(const std::optional<FittedPart>& fitted, PlanResult& result,
                                                  std::vector<Index>& patch_of_face, Progress& progress) {
  const Job& job = result.job;
  if (!fitted) return std::nullopt;
  result.scallop.emplace();
  if (job.pattern == Pattern::planar) return std::nullopt;
  ScallopMetric metric =
      scallop_metric(fitted->mesh, fitted->fit.curvatures, 0.5 * job.tool.ball_diameter, result.spacing, progress);
  result.warn_of(metric.warnings);
  result.scallop->clamped_fraction = metric.clamped_fraction;
  result.scallop->gouged_fraction = metric.gouged_fraction;
  result.part.mesh = std::move(metric.mesh);
  if (!patch_of_face.empty()) {
    for (Index& face : metric.old_face) face = patch_of_face[face];
    patch_of_face = std::move(metric.old_face);
  }
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

/// Patch by patch, each with a field from its own border.
void plan_by_patches(PlanResult& result, Partition parts, const IntrinsicGeometry* metric, StageClock& clock,
                     Progress& progress) {
  Job job = result.job;
  job.planar_direction = direction_of_planes(job, result.part.mesh);
  parts.mesh = std::move(result.part.mesh);
  PatchedPlan plan = plan_patches(parts, job, result.spacing, metric, progress);
  result.part.mesh = std::move(parts.mesh);
  check_reach(result.part.mesh, plan.distances, job);
  result.pattern = plan.patches.front().pattern;
  result.warn_of(plan.impact.warnings);
  result.impact = std::move(plan.impact);
  result.patches = std::move(plan.patches);
  result.patch_of_face = std::move(plan.patch_of_face);
  result.distances = std::move(plan.distances);
  result.display = std::move(plan.display);
  clock.ends("impact");
}

}  // namespace

PlanResult run_plan(const Job& job, Progress& progress) {
  job.validate();
  PlanResult result;
  result.job = job;
  StageClock clock(result.times);

  result.part = load_part(job.mesh, job.unit, progress);
  result.warn_of(result.part.warnings);
  const TriangleMesh& mesh = result.part.mesh;
  clock.ends("read");

  if (auto warning = warning_of_size(mesh.size(), job.unit != LengthUnit::millimetre)) {
    result.warnings.push_back(*std::move(warning));
  }
  if (auto warning = warning_of_pieces(mesh)) result.warnings.push_back(*std::move(warning));
  if (auto warning = warning_of_tool(job.tool, mesh.size())) result.warnings.push_back(*std::move(warning));
  result.spacing = spacing_of(job, mesh, result.warnings);
  check_against_size(job, result.spacing, mesh.size());
  if (job.min_radius > 0) check_min_radius(mesh, job.min_radius);
  // all of a connected part is reached: what the tool or a program cannot do there need not wait for the field
  if (mesh.n_components() == 1) check_reach(mesh, std::vector<double>(mesh.n_vertices(), 0.0), job);
  Partition parts;
  if (job.partition.by != PartitionBy::none) {
    check_pass_count(std::array{0.0, 0.5 * mesh.size()}, result.spacing);
    parts = partition(std::move(result.part.mesh), result.spacing, job.partition, progress);
    result.part.mesh = std::move(parts.mesh);
    clock.ends("partition");
  }
  std::optional<FittedPart> fitted;
  if (job.scallop > 0) fitted.emplace(mesh, result.spacing);
  const std::optional<IntrinsicGeometry> warped = warp_for_scallop(fitted, result, parts.patch_of_face, progress);
  const IntrinsicGeometry* metric = warped ? &*warped : nullptr;
  if (job.partition.by != PartitionBy::none) {
    plan_by_patches(result, std::move(parts), metric, clock, progress);
  } else {
    plan_whole(result, metric, clock, progress);
  }
  std::optional<CurvedSurface> curved;
  if (fitted) {
    curved = surface_over(*fitted, mesh);
    take_normals(*curved, result.impact.curve);
  }

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
        measure_scallop(mesh, *curved, result.impact.curve, 0.5 * job.tool.ball_diameter, result.spacing, progress);
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
