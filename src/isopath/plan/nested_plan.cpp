#include "isopath/plan/nested_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/impact/finish_curve.h"

namespace isopath {
namespace {

/// Levels of the function between two loops so close that they keep the spacing all but everywhere.
NestedField annulus_field(const TriangleMesh& mesh, double spacing, Progress& progress) {
  const ExactFieldOptions options{.accuracy = 1e-4 * spacing};
  const ExactField outer = ExactField::compute(mesh, boundary_source(mesh, 0), options, progress);
  const ExactField inner = ExactField::compute(mesh, boundary_source(mesh, 1), options, progress);
  NestedField nested{blend_between(outer, inner), spacing};
  const int n = levels_to_keep(mesh, nested.values, spacing);
  for (double& value : nested.values) value *= n * spacing;
  return nested;
}

}  // namespace

NestedShape nested_shape_of(const TriangleMesh& mesh) {
  // vertices - edges + faces of every component, and its loops
  std::vector<Index> characteristic(mesh.n_components(), 0);
  std::vector<Index> loops(mesh.n_components(), 0);
  for (Index f = 0; f < mesh.n_faces(); ++f) ++characteristic[mesh.component_of(f)];
  for (Index e = 0; e < mesh.n_edges(); ++e)
    --characteristic[mesh.component_of(TriangleMesh::face_of(mesh.halfedge_of(e)))];
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (mesh.outgoing(v) != no_index) ++characteristic[mesh.component_of(TriangleMesh::face_of(mesh.outgoing(v)))];
  }
  for (const auto& loop : mesh.boundary_loops()) ++loops[mesh.component_of(TriangleMesh::face_of(loop.front()))];
  if (mesh.n_components() == 1 && loops[0] == 2 && characteristic[0] == 0) return NestedShape::annulus;
  for (Index c = 0; c < mesh.n_components(); ++c) {
    if (loops[c] > 1 || characteristic[c] != (loops[c] == 1 ? 1 : 2)) return NestedShape::other;
  }
  return NestedShape::disc;
}

bool wants_nested_levels(const Job& job) { return job.blend || job.pattern == Pattern::double_spiral; }

NestedField nested_field(const Job& job, const ExactField& distance, double spacing, Progress& progress) {
  progress.stage("blending");
  const TriangleMesh& mesh = distance.mesh();
  if (job.blend) {
    const NestedShape shape = nested_shape_of(mesh);
    if (shape == NestedShape::annulus) return annulus_field(mesh, spacing, progress);
    if (shape == NestedShape::other) {
      throw Error(ErrorCode::no_plan, "a part with several holes or handles has no nested levels",
                  {.advice = "take the pattern two-way, which needs none, or part it first"});
    }
    const double radius = job.min_radius > 0 ? job.min_radius : default_radius_in_spacings * spacing;
    BlendedField blended = blend(distance, {.form = *job.blend, .spacing = spacing, .radius = radius}, progress);
    return {std::move(blended.values), blended.spacing};
  }
  NestedField nested{{distance.vertex_distances().begin(), distance.vertex_distances().end()}, spacing};
  const double top = distance.max_vertex_distance();
  nested.spacing = top / std::max(1.0, std::ceil(top / spacing - 0.02));
  return nested;
}

}  // namespace isopath
