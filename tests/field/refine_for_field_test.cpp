// Refinement until linear interpolation is close to a field: the error at random points, and what the mesh keeps.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/refine_for_field.h"
#include "support/random_sources.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

/// The point of the old mesh that a point of the finer one is.
SurfacePoint on_old_mesh(const TriangleMesh& mesh, const RefinedMesh& refined, const SurfacePoint& p) {
  SurfacePoint old{refined.old_face[p.face], Vec3::Zero()};
  for (int i = 0; i < 3; ++i) {
    const SurfacePoint& corner = refined.on_old[refined.mesh.triangle(p.face)[i]];
    old.barycentric += p.barycentric[i] * express_in(mesh, corner, old.face).barycentric;
  }
  return old;
}

double interpolated(const RefinedField& field, const SurfacePoint& p) {
  double value = 0;
  for (int i = 0; i < 3; ++i) value += p.barycentric[i] * field.value[field.refined.mesh.triangle(p.face)[i]];
  return value;
}

void expect_close(Rng& rng, const TriangleMesh& mesh, const SourceSet& sources, double tolerance) {
  const ExactField exact = ExactField::compute(mesh, sources);
  const RefinedField refined = refine_for_field(mesh, exact, {.tolerance = tolerance, .max_levels = 12});
  EXPECT_LE(refined.largest_error, tolerance);
  EXPECT_NEAR(refined.refined.mesh.area(), mesh.area(), 1e-12 * mesh.area());
  // A hanging node would open the mesh.
  double rim = 0;
  double old_rim = 0;
  for (const auto& loop : mesh.boundary_loops()) {
    for (const Index h : loop) old_rim += mesh.edge_length(mesh.edge_of(h));
  }
  for (const auto& loop : refined.refined.mesh.boundary_loops()) {
    for (const Index h : loop) rim += refined.refined.mesh.edge_length(refined.refined.mesh.edge_of(h));
  }
  EXPECT_NEAR(rim, old_rim, 1e-12 * (mesh.size() + old_rim));
  for (int k = 0; k < 3000; ++k) {
    SurfacePoint p{random_index(rng, refined.refined.mesh.n_faces()), Vec3::Zero()};
    const double root = std::sqrt(random_real(rng, 0, 1));
    const double v = random_real(rng, 0, 1);
    p.barycentric = Vec3(1 - root, root * (1 - v), root * v);
    ASSERT_NEAR(interpolated(refined, p), exact.value(on_old_mesh(mesh, refined.refined, p)), tolerance)
        << "face " << p.face << " at " << p.barycentric.transpose();
  }
}

TEST(RefineForField, TheErrorIsWithinTheToleranceEverywhere) {
  const TriangleMesh meshes[] = {planar_grid(4, 4, 4, 4), cube(1, 2), wavy_sheet(8, 10, 1, 0.6, 0.5, 2),
                                 saddle_cone(10, 2, 2), torus(10, 6, 3, 1)};
  Rng rng(5);
  for (const TriangleMesh& mesh : meshes) {
    for (const double tolerance : {3e-2, 3e-3}) {
      SourceSet point;
      point.add_point(random_surface_point(rng, mesh));
      expect_close(rng, mesh, point, tolerance * mesh.size());
      expect_close(rng, mesh, random_sources(rng, mesh), tolerance * mesh.size());
    }
  }
}

TEST(RefineForField, FacesWhereTheFieldIsLinearStay) {
  const TriangleMesh mesh = planar_grid(6, 3, 6, 3);
  SourceSet left;  // the whole left side: the distance is x
  std::vector<Index> chain;
  for (const Index h : mesh.boundary_loops()[0]) {
    if (mesh.position(mesh.from(h)).x() == 0 && mesh.position(mesh.to(h)).x() == 0) chain.push_back(h);
  }
  ASSERT_EQ(chain.size(), 3);
  left.add_halfedges(mesh, chain, false);
  const RefinedField refined = refine_for_field(mesh, ExactField::compute(mesh, left), {.tolerance = 1e-9});
  EXPECT_EQ(refined.refined.mesh.n_faces(), mesh.n_faces());
  EXPECT_LE(refined.largest_error, 1e-12);
}

TEST(RefineForField, TrianglesGetSmallerTowardsTheSource) {
  const TriangleMesh mesh = planar_grid(8, 8, 8, 8);
  SourceSet centre;
  centre.add_vertex(mesh, 40);
  const double tolerance = 0.01;
  const RefinedField field = refine_for_field(mesh, ExactField::compute(mesh, centre), {.tolerance = tolerance});
  // Interpolation of |p| over a length h at distance r is off by h²/8r: so h may grow like the root of r.
  double near = 0;
  double far = 0;
  for (Index e = 0; e < field.refined.mesh.n_edges(); ++e) {
    const Index h = field.refined.mesh.halfedge_of(e);
    const double r = 0.5 * (field.value[field.refined.mesh.from(h)] + field.value[field.refined.mesh.to(h)]);
    if (r < 0.1) near = std::max(near, field.refined.mesh.edge_length(e));
    if (r > 3) far = std::max(far, field.refined.mesh.edge_length(e));
  }
  EXPECT_LT(near, 0.1 * far);
}

TEST(RefineForField, UnreachedPartsStay) {
  TriangleSoup soup = planar_grid(2, 2, 2, 2).soup();
  const auto shift = static_cast<Index>(soup.positions.size());
  for (const TriangleSoup other = soup; const auto& [a, b, c] : other.triangles)
    soup.triangles.push_back({a + shift, b + shift, c + shift});
  for (Index v = 0; v < shift; ++v) soup.positions.emplace_back(soup.positions[v] + Vec3(5, 0, 0));
  const TriangleMesh mesh(std::move(soup));
  SourceSet sources;
  sources.add_vertex(mesh, 0);
  const RefinedField refined = refine_for_field(mesh, ExactField::compute(mesh, sources), {.tolerance = 0.01});
  Index parts_of_other = 0;
  for (const Index face : refined.refined.old_face) parts_of_other += mesh.component_of(face) == 1;
  EXPECT_EQ(parts_of_other, 8);
  EXPECT_GT(refined.refined.mesh.n_faces(), 20);
}

TEST(RefineForField, LevelsAreLimitedAndTheRestIsReported) {
  const TriangleMesh mesh = planar_grid(2, 2, 2, 2);
  SourceSet sources;
  sources.add_vertex(mesh, 4);
  const ExactField exact = ExactField::compute(mesh, sources);
  const RefinedField refined = refine_for_field(mesh, exact, {.tolerance = 1e-6, .max_levels = 2});
  EXPECT_LE(refined.refined.mesh.n_faces(), 8 * 16);
  EXPECT_GT(refined.largest_error, 1e-3);
}

TEST(RefineForField, OptionsAreChecked) {
  const FieldRefinementOptions defaults;
  EXPECT_EQ(defaults.tolerance, 0);
  EXPECT_EQ(defaults.max_levels, 8);
  for (const FieldRefinementOptions& bad :
       {FieldRefinementOptions{}, FieldRefinementOptions{.tolerance = -1},
        FieldRefinementOptions{.tolerance = infinity}, FieldRefinementOptions{.tolerance = 1, .max_levels = -1},
        FieldRefinementOptions{.tolerance = 1, .max_levels = 21}}) {
    EXPECT_THROW(bad.validate(), Error);
  }
}

}  // namespace
}  // namespace isopath::test
