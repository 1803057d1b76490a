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

/// On the part's mesh or a finer one.
ExactField distances_on(const TriangleMesh& mesh, const PlanResult& result, const IntrinsicGeometry* metric,
                        AutoLoops loops, double accuracy, Progress& progress) {
  const SourceSet sources = make_sources(mesh, result.job.sources, result.part.vertex_of_file_vertex, progress, loops);
  const ExactFieldOptions options{.accuracy = accuracy, .many_questions = true};
  return metric ? ExactField::compute(mesh, *metric, sources, options, progress)
                : ExactField::compute(mesh, sources, options, progress);
}

/// The smoothed distances, on a mesh that is fine enough for them. The field must be exact, for the medial axis.
PartField smoothed_field(const PlanResult& result, const IntrinsicGeometry* metric, Progress& progress) {
  const double width = result.job.smooth;
  PartField field;
  field.fine = std::make_unique<FineSurface>();
  FineSurface& fine = *field.fine;
  fine.mesh = result.part.mesh;
  if (metric) fine.metric = *metric;
  fine.refine(refine_for_smoothing(fine.mesh, result.spacing, width));
  FieldSamples samples;
  {
    const ExactField exact = distances_on(fine.mesh, result, fine.geometry(), loops_for(result.job), 0, progress);
    samples = sample_for_smoothing(exact, result.spacing, progress);
  }
  field.ridges = std::move(samples.ridges);
  for (std::vector<SurfacePoint>& ridge : field.ridges) {
    for (SurfacePoint& point : ridge) point = fine.trail.on_first(point);
  }
  fine.refine(std::move(samples.refined));
  field.at_vertices = smoothed_distances(fine.mesh, fine.geometry(), samples.distances, width, progress);
  field.function = std::make_unique<VertexField>(fine.mesh, field.at_vertices);
  return field;
}

/// Cuts the part open where nested levels need it; its field is then that of the part cut open. False where there are
/// none to be had.
bool open_for_nesting(PlanResult& result, PartField& field, Progress& progress) {
  const TriangleMesh& mesh = result.part.mesh;
  const NestedShape shape = nested_shape_of(mesh);
  if (shape == NestedShape::disc) return true;
  std::optional<RefinedMesh> opened;
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
  result.refine(*std::move(opened));
  field = field_of(result, nullptr, progress);
  return true;
}

}  // namespace

Vec3 direction_of_planes(const Job& job, const TriangleMesh& mesh) {
  return job.planar_direction.isZero(0) ? planar_direction_of(mesh) : job.planar_direction;
}

PartField exact_field_of(const PlanResult& result, const IntrinsicGeometry* metric, AutoLoops loops,
                         Progress& progress) {
  auto exact = std::make_unique<ExactField>(
      distances_on(result.part.mesh, result, metric, loops, field_accuracy * result.part.mesh.size(), progress));
  std::vector<double> values(exact->vertex_distances().begin(), exact->vertex_distances().end());
  return {std::move(exact), std::move(values)};
}

PartField field_of(const PlanResult& result, const IntrinsicGeometry* metric, Progress& progress) {
  progress.stage("distance field");
  const TriangleMesh& mesh = result.part.mesh;
  if (result.job.pattern == Pattern::planar) {
    auto height = std::make_unique<VertexField>(height_field(mesh, direction_of_planes(result.job, mesh)));
    std::vector<double> values(height->values().begin(), height->values().end());
    return {std::move(height), std::move(values)};
  }
  if (result.job.smooth > 0) return smoothed_field(result, metric, progress);
  return exact_field_of(result, metric, loops_for(result.job), progress);
}

PartField nested_field_on(RefinedMesh fine, BlendForm form, PlanResult& result, Progress& progress) {
  const double spacing = result.spacing;
  const double radius = result.job.min_radius > 0 ? result.job.min_radius : default_radius_in_spacings * spacing;
  const TriangleMesh& mesh = result.part.mesh;
  NestedField nested;
  for (int round = 0; round < 2; ++round) {
    result.refine(std::move(fine));
    const PartField field = field_of(result, nullptr, progress);
    nested = nested_field(form, static_cast<const ExactField&>(*field.function), spacing, radius, progress);
    fine = refine_for_levels(mesh, nested.values, nested.spacing, progress);
    if (fine.mesh.n_faces() < 1.05 * mesh.n_faces()) break;  // single triangles are not worth it
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
  RefinedMesh fine = refine_for_blend(result.part.mesh, *field.function, result.spacing, progress);
  field.function.reset();
  return nested_field_on(std::move(fine), *form_of(result.job.blend), result, progress);
}

}  // namespace isopath
