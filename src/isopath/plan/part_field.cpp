#include "isopath/plan/part_field.h"

#include <utility>

#include "isopath/contour/blend_mesh.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/vertex_field.h"
#include "isopath/impact/finish_curve.h"
#include "isopath/plan/hole_bridges.h"
#include "isopath/plan/nested_plan.h"
#include "isopath/plan/planar_direction.h"
#include "isopath/plan/smooth_part.h"

namespace isopath {
namespace {

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
PartField smoothed_field(PlanResult& result, std::optional<IntrinsicGeometry>& metric, Progress& progress) {
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

/// Cuts the part open where nested levels need it; its field is then that of the part cut open. False where there are
/// none to be had.
bool open_for_nesting(PlanResult& result, PartField& field, Progress& progress) {
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

}  // namespace

Vec3 direction_of_planes(const Job& job, const TriangleMesh& mesh) {
  return job.planar_direction.isZero(0) ? planar_direction_of(mesh) : job.planar_direction;
}

PartField exact_field_of(const PlanResult& result, const IntrinsicGeometry* metric, AutoLoops loops,
                         Progress& progress) {
  auto exact = std::make_unique<ExactField>(
      distances_on(result.part, result.job, metric, loops, field_accuracy * result.part.mesh.size(), progress));
  std::vector<double> values(exact->vertex_distances().begin(), exact->vertex_distances().end());
  return {std::move(exact), std::move(values)};
}

PartField field_of(PlanResult& result, std::optional<IntrinsicGeometry>& metric, Progress& progress) {
  progress.stage("distance field");
  const TriangleMesh& mesh = result.part.mesh;
  if (result.job.pattern == Pattern::planar) {
    auto height = std::make_unique<VertexField>(height_field(mesh, direction_of_planes(result.job, mesh)));
    std::vector<double> values(height->values().begin(), height->values().end());
    return {std::move(height), std::move(values)};
  }
  if (result.job.smooth > 0) return smoothed_field(result, metric, progress);
  return exact_field_of(result, metric ? &*metric : nullptr, loops_for(result.job), progress);
}

PartField nested_field_on(TriangleMesh fine, BlendForm form, PlanResult& result, Progress& progress) {
  const double spacing = result.spacing;
  const double radius = result.job.min_radius > 0 ? result.job.min_radius : default_radius_in_spacings * spacing;
  TriangleMesh& mesh = result.part.mesh;
  std::optional<IntrinsicGeometry> in_space;
  NestedField nested;
  for (int round = 0; round < 2; ++round) {
    mesh = std::move(fine);
    const PartField field = field_of(result, in_space, progress);
    nested = nested_field(form, static_cast<const ExactField&>(*field.function), spacing, radius, progress);
    fine = refine_for_levels(mesh, nested.values, nested.spacing, progress);
    if (fine.n_faces() < 1.05 * mesh.n_faces()) break;  // single triangles are not worth it
  }
  std::vector<double> values = nested.values;
  return {std::make_unique<VertexField>(mesh, std::move(nested.values)), std::move(values), nested.spacing};
}

PartField nested_field_of(PlanResult& result, PartField field, Progress& progress) {
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

}  // namespace isopath
