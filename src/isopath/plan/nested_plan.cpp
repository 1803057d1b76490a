#include "isopath/plan/nested_plan.h"

#include <utility>

#include <fmt/format.h>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/mesh/refine.h"
#include "isopath/plan/hole_bridges.h"

namespace isopath {
namespace {

/// Above this length ratio, an annulus is rather cut open, which costs some levels along the cut.
constexpr double most_length_ratio = 1.1;
/// The longest edges, in spacings, of the mesh that this is judged on.
constexpr double judged_in_spacings = 1;
constexpr Index most_faces = 1000000;

/// The distances from the two loops of an annulus.
struct LoopFields {
  ExactField outer;
  ExactField inner;

  LoopFields(const TriangleMesh& mesh, double spacing, Progress& progress)
      : outer(from_loop(mesh, 0, spacing, progress)), inner(from_loop(mesh, 1, spacing, progress)) {}

 private:
  static ExactField from_loop(const TriangleMesh& mesh, Index loop, double spacing, Progress& progress) {
    return ExactField::compute(mesh, boundary_source(mesh, loop), {.accuracy = 1e-4 * spacing}, progress);
  }
};

/// Levels of the function between two loops so close that they keep the spacing all but everywhere.
NestedField annulus_field(const LoopFields& fields, double spacing) {
  NestedField nested{blend_between(fields.outer, fields.inner), spacing};
  const int n = levels_to_keep(fields.outer.mesh(), nested.values, spacing);
  for (double& value : nested.values) value *= n * spacing;
  return nested;
}

/// The length of all levels, times their spacing, over the area: the mean slope of the function (coarea formula).
double length_ratio_of(const TriangleMesh& mesh, const std::vector<double>& values) {
  double sum = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const Triangle& t = mesh.triangle(f);
    const Vec3 ab = mesh.position(t[1]) - mesh.position(t[0]);
    const Vec3 ac = mesh.position(t[2]) - mesh.position(t[0]);
    sum += 0.5 * ((values[t[2]] - values[t[0]]) * ab - (values[t[1]] - values[t[0]]) * ac).norm();
  }
  return sum / mesh.area();
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
  NestedShape shape = NestedShape::disc;
  for (Index c = 0; c < mesh.n_components(); ++c) {
    if (characteristic[c] != 2 - loops[c]) return NestedShape::handles;
    if (loops[c] > 1) shape = NestedShape::holes;
  }
  return shape;
}

std::optional<RefinedMesh> opened_annulus(const TriangleMesh& mesh, double spacing, Progress& progress) {
  const TriangleMesh even = split_long_edges(mesh, judged_in_spacings * spacing, most_faces).mesh;
  const LoopFields fields(even, spacing, progress);
  if (length_ratio_of(even, annulus_field(fields, spacing).values) <= most_length_ratio) return std::nullopt;
  return opened_holes(mesh, spacing, progress);
}

NestedField nested_field(BlendForm form, const ExactField& distance, double spacing, double radius,
                         Progress& progress) {
  progress.stage("blending");
  const TriangleMesh& mesh = distance.mesh();
  const NestedShape shape = nested_shape_of(mesh);
  if (shape == NestedShape::annulus) return annulus_field(LoopFields(mesh, spacing, progress), spacing);
  if (shape != NestedShape::disc) {
    throw Error(ErrorCode::no_plan, "a part with several holes or handles has no nested levels",
                {.advice = "cut it open first, or take the pattern two-way, which needs none"});
  }
  BlendedField blended = blend(distance, {.form = form, .spacing = spacing, .radius = radius}, progress);
  return {std::move(blended.values), blended.spacing};
}

}  // namespace isopath
