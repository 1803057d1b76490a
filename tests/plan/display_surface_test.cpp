#include "isopath/plan/display_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "isopath/field/exact_field.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

TEST(DisplaySurface, HoldsTheFunctionAtEveryVertexAndShowsARidgeInsideACoarseFace) {
  // two triangles: seen at its four vertices, a distance from the rim would be zero everywhere
  const TriangleMesh square = test::planar_grid(1, 1, 10, 10);
  const ExactField field = ExactField::compute(square, boundary_source(square));
  const double spacing = 2;
  const RefinedMesh refined = refine_for_display(square, spacing);
  const std::vector<double> values = values_at_vertices(field, refined, field.vertex_distances(), Progress::none());
  ASSERT_EQ(values.size(), static_cast<std::size_t>(refined.mesh.n_vertices()));
  for (Index v = 0; v < refined.mesh.n_vertices(); ++v) {
    const Vec3& p = refined.mesh.position(v);
    EXPECT_NEAR(values[v], std::min({p.x(), p.y(), 10 - p.x(), 10 - p.y()}), 1e-9);
  }
  const double longest = *std::max_element(refined.mesh.edge_lengths().begin(), refined.mesh.edge_lengths().end());
  EXPECT_LT(longest, spacing / 3);
  EXPECT_NEAR(*std::max_element(values.begin(), values.end()), 5, longest);
}

TEST(DisplaySurface, InterpolatesWhatIsKnownAtTheVerticesOnly) {
  const TriangleMesh mesh = test::planar_grid(2, 2, 10, 10);
  std::vector<double> values(mesh.n_vertices());
  for (Index v = 0; v < mesh.n_vertices(); ++v) values[v] = 2 * mesh.position(v).x() - mesh.position(v).y();
  const RefinedMesh refined = refine_for_display(mesh, 3);
  const std::vector<double> all = interpolated(mesh, values, refined);
  ASSERT_EQ(all.size(), static_cast<std::size_t>(refined.mesh.n_vertices()));
  for (Index v = 0; v < refined.mesh.n_vertices(); ++v) {
    EXPECT_NEAR(all[v], 2 * refined.mesh.position(v).x() - refined.mesh.position(v).y(), 1e-12);
  }
}

TEST(DisplaySurface, StaysWithinItsBudget) {
  const TriangleMesh square = test::planar_grid(1, 1, 10, 10);
  const RefinedMesh refined = refine_for_display(square, 1e-3);
  EXPECT_LE(refined.mesh.n_faces(), 350000);
  EXPECT_GT(refined.mesh.n_faces(), 100000);
}

}  // namespace
}  // namespace isopath
