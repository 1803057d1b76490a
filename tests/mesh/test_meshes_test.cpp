#include "support/test_meshes.h"

#include <gtest/gtest.h>

#include <numbers>

namespace isopath::test {
namespace {

int euler(const TriangleMesh& mesh) { return mesh.n_vertices() - mesh.n_edges() + mesh.n_faces(); }

double angle_at(const TriangleMesh& mesh, Index vertex) {
  double angle = 0;
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    if (mesh.from(h) != vertex) continue;
    const Vec3 a = mesh.position(mesh.to(h)) - mesh.position(vertex);
    const Vec3 b = mesh.position(mesh.from(TriangleMesh::prev(h))) - mesh.position(vertex);
    angle += std::atan2(a.cross(b).norm(), a.dot(b));
  }
  return angle;
}

/// Volume by the divergence theorem: positive when the faces look outwards.
double volume(const TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.soup().triangles) {
    volume += mesh.position(a).dot(mesh.position(b).cross(mesh.position(c))) / 6;
  }
  return volume;
}

TEST(TestMeshes, ClosedShapesHaveTheirTopologyAndLookOutwards) {
  EXPECT_EQ(euler(cube(3, 1)), 2);
  EXPECT_EQ(euler(tetrahedron(1)), 2);
  EXPECT_EQ(euler(closed_pyramid(5, 1, 1)), 2);
  EXPECT_EQ(euler(icosphere(2, 1)), 2);
  EXPECT_EQ(euler(torus(12, 8, 3, 1)), 0);
  EXPECT_NEAR(volume(cube(3, 2)), 8, 1e-12);
  EXPECT_NEAR(volume(box({-1, 0, 1}, {1, 3, 2})), 6, 1e-12);
  EXPECT_NEAR(volume(tetrahedron(1)), 1 / (6 * std::sqrt(2)), 1e-12);
  EXPECT_NEAR(volume(icosphere(3, 2)), 32 * std::numbers::pi / 3, 0.5);
  EXPECT_NEAR(volume(closed_pyramid(4, 1, 3)), 2, 1e-12);
  EXPECT_GT(volume(torus(12, 8, 3, 1)), 0);
}

TEST(TestMeshes, AreasAreTheirs) {
  EXPECT_NEAR(planar_grid(7, 5, 3, 2, {.jitter = 0.24}).area(), 6, 1e-12);
  EXPECT_NEAR(planar_grid(7, 5, 3, 2, {.diagonal = Diagonal::union_jack}).area(), 6, 1e-12);
  EXPECT_NEAR(height_grid(7, 5, 3, 2, [](double x, double) { return x; }).area(), 6 * std::sqrt(2), 1e-12);
  EXPECT_NEAR(l_shape(2).area(), 12, 1e-12);
  EXPECT_NEAR(notched_square(5).area(), 21, 1e-12);
  EXPECT_NEAR(planar_star(5, 2, 1).area(), 10 * std::sin(std::numbers::pi / 5), 1e-12);
  EXPECT_NEAR(cube(2, 3).area(), 54, 1e-12);
  EXPECT_NEAR(open_cylinder(8, 3, 1, 5).area(), 8 * 2 * std::sin(std::numbers::pi / 8) * 5, 1e-12);
}

TEST(TestMeshes, OpenShapesHaveOneOrTwoBoundaryLoops) {
  EXPECT_EQ(open_cylinder(8, 3, 1, 5).boundary_loops().size(), 2u);
  EXPECT_EQ(open_cone(8, 3, 1, 5).boundary_loops().size(), 1u);
  EXPECT_EQ(hemisphere(4, 12, 1).boundary_loops().size(), 1u);
  EXPECT_EQ(notched_ellipse(6, 40, 3, 2).boundary_loops().size(), 1u);
  EXPECT_EQ(wavy_sheet(6, 3, 0.2, 2, 2, 1).boundary_loops().size(), 1u);
}

TEST(TestMeshes, ApexAngles) {
  EXPECT_NEAR(angle_at(open_cone(6, 2, 1, 2), 0), cone_angle(6, 1, 2), 1e-12);
  EXPECT_GT(angle_at(saddle_cone(6, 1, 0.5), 0), 2 * std::numbers::pi + 0.1);
}

TEST(TestMeshes, BladeTrianglesAreFiftyTimesAsLongAsWide) {
  const TriangleMesh mesh = lofted_blade(4, 20);
  double longest = 0;
  double shortest = infinity;
  for (double length : mesh.edge_lengths()) {
    longest = std::max(longest, length);
    shortest = std::min(shortest, length);
  }
  EXPECT_NEAR(longest / shortest, 60, 25);
}

TEST(TestMeshes, RandomMeshesAreManifoldAndOfTheAskedSize) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const RandomMeshOptions options{
        .min_faces = 6, .closed = seed % 2 == 0, .holes = seed % 3 == 0, .slivers = seed % 5 == 0};
    const TriangleMesh mesh = random_mesh(rng, options);
    EXPECT_LE(mesh.n_faces(), 30);
    EXPECT_EQ(mesh.boundary_loops().empty(), options.closed && !options.holes);
  }
}

TEST(TestMeshes, TransformsKeepWhatTheyShould) {
  const TriangleMesh mesh = closed_pyramid(5, 1, 1);
  const TriangleMesh turned = moved(mesh, {1, 2, 3}, 0.7, {5, 6, 7});
  const TriangleMesh big = scaled(mesh, 1e6);
  const TriangleMesh split = face_split(mesh, 3, {0.2, 0.3, 0.5});
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    EXPECT_NEAR(turned.edge_length(e), mesh.edge_length(e), 1e-14);
    EXPECT_NEAR(big.edge_length(e), 1e6 * mesh.edge_length(e), 1e-8);
  }
  EXPECT_EQ(split.n_faces(), mesh.n_faces() + 2);
  EXPECT_NEAR(split.area(), mesh.area(), 1e-13);
}

}  // namespace
}  // namespace isopath::test
