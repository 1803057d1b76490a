#include "isopath/mesh/refine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "isopath/core/error.h"
#include "isopath/mesh/surface_walk.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

double smallest_angle(const TriangleMesh& mesh) {
  double smallest = std::numbers::pi;
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    const Vec3 a = mesh.position(mesh.to(h)) - mesh.position(mesh.from(h));
    const Vec3 b = mesh.position(mesh.from(TriangleMesh::prev(h))) - mesh.position(mesh.from(h));
    smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  return smallest;
}

double boundary_length(const TriangleMesh& mesh) {
  double length = 0;
  for (Index e = 0; e < mesh.n_edges(); ++e) length += mesh.is_boundary_edge(e) ? mesh.edge_length(e) : 0;
  return length;
}

/// What every refinement keeps. That the mesh could be made says that it is manifold; a T-junction would show as a
/// boundary that the old mesh does not have.
void expect_same_surface(const TriangleMesh& old, const RefinedMesh& fine) {
  EXPECT_NEAR(fine.mesh.area(), old.area(), 1e-11 * old.area());
  EXPECT_NEAR(boundary_length(fine.mesh), boundary_length(old), 1e-12 * (1 + boundary_length(old)));
  EXPECT_EQ(fine.mesh.boundary_loops().size(), old.boundary_loops().size());
  EXPECT_EQ(fine.mesh.n_vertices() - fine.mesh.n_edges() + fine.mesh.n_faces(),
            old.n_vertices() - old.n_edges() + old.n_faces());
  ASSERT_EQ(fine.on_old.size(), static_cast<std::size_t>(fine.mesh.n_vertices()));
  ASSERT_EQ(fine.old_face.size(), static_cast<std::size_t>(fine.mesh.n_faces()));
  for (Index v = 0; v < fine.mesh.n_vertices(); ++v) {
    EXPECT_LT((position_of(old, fine.on_old[v]) - fine.mesh.position(v)).norm(), 1e-13 * old.size());
  }
  for (Index v = 0; v < old.n_vertices(); ++v) {
    EXPECT_EQ(fine.mesh.position(v), old.position(v));
  }
  for (Index f = 0; f < fine.mesh.n_faces(); ++f) {
    EXPECT_LT((fine.mesh.face_normal(f) - old.face_normal(fine.old_face[f])).norm(), 1e-9);
  }
}

TEST(Refine, UniformSplitMakesFourOfEachAndKeepsTheSurface) {
  for (const TriangleMesh& mesh : {test::icosphere(2, 3), test::torus(9, 7, 5, 2), test::open_cylinder(8, 3, 2, 5)}) {
    const RefinedMesh fine = split_uniformly(mesh);
    EXPECT_EQ(fine.mesh.n_faces(), 4 * mesh.n_faces());
    EXPECT_EQ(fine.mesh.n_vertices(), mesh.n_vertices() + mesh.n_edges());
    EXPECT_NEAR(smallest_angle(fine.mesh), smallest_angle(mesh), 1e-12);
    expect_same_surface(mesh, fine);
  }
}

TEST(Refine, RandomMarksGiveAConformingMesh) {
  const TriangleMesh mesh = test::height_grid(9, 8, 9, 8, [](double x, double y) { return std::sin(x) * std::cos(y); });
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    const RefinedMesh fine = refine(
        mesh, [&](const RefineTriangle&) { return random() % 20 == 0; }, 3);
    EXPECT_GT(fine.mesh.n_faces(), mesh.n_faces());
    expect_same_surface(mesh, fine);
    if (HasFailure()) return;
  }
}

TEST(Refine, AnglesStayBoundedHoweverDeepItGoesAroundAPoint) {
  const TriangleMesh mesh = test::planar_grid(3, 3, 3, 3);
  const Vec2 centre(1.3, 1.6);
  const auto around = [&](const RefineTriangle& t) {
    for (int i = 0; i < 3; ++i) {
      const Vec2 a = t.position[i].head<2>();
      const Vec2 b = t.position[(i + 1) % 3].head<2>();
      if (cross(Vec2(b - a), Vec2(centre - a)) < 0) return false;
    }
    return true;
  };
  for (const int levels : {1, 3, 6, 15}) {
    const RefinedMesh fine = refine(mesh, around, levels);
    expect_same_surface(mesh, fine);
    // Right isosceles triangles; the worst half of one, across a leg, has tan(angle) = 1/3.
    EXPECT_GT(smallest_angle(fine.mesh), std::atan(1.0 / 3) - 1e-6);
    EXPECT_LT(fine.mesh.n_faces(), mesh.n_faces() + 30 * levels);
    double shortest = infinity;
    for (const double length : fine.mesh.edge_lengths()) shortest = std::min(shortest, length);
    EXPECT_LT(shortest, 1.5 * std::pow(0.5, levels));
  }
}

TEST(SplitLongEdges, KeepsTheSurfaceAndLeavesNoLongEdge) {
  for (const TriangleMesh& mesh : {test::icosphere(2, 1), test::torus(9, 7, 5, 2), test::open_cylinder(40, 1, 2, 50),
                                   test::planar_grid(1, 1, 9, 1)}) {
    for (const double longest : {100.0, 1.3, 0.4}) {
      const RefinedMesh fine = split_long_edges(mesh, longest, 1000000);
      expect_same_surface(mesh, fine);
      for (const double length : fine.mesh.edge_lengths()) EXPECT_LE(length, longest);
    }
  }
}

TEST(SplitLongEdges, DividesASliverMostlyAlongItsLength) {
  TriangleSoup soup;
  soup.positions = {{0, 0, 0}, {1000, 0, 0}, {500, 1, 0}};
  soup.triangles = {{0, 1, 2}};
  const RefinedMesh fine = split_long_edges(TriangleMesh(soup), 1.5, 1000000);
  // ten halvings of the long side; 1-to-4 splits would make 4^10 triangles, a million
  EXPECT_LT(fine.mesh.n_faces(), 60000);
}

TEST(SplitLongEdges, StopsAtTheBoundWithEdgesAboutAsLong) {
  const TriangleMesh mesh = test::planar_grid(3, 3, 9, 9);
  for (const Index most : {20, 100, 5000}) {
    const RefinedMesh fine = split_long_edges(mesh, 1e-6, most);
    EXPECT_LE(fine.mesh.n_faces(), most);
    EXPECT_GT(fine.mesh.n_faces(), most / 4);
    const auto [least, greatest] =
        std::minmax_element(fine.mesh.edge_lengths().begin(), fine.mesh.edge_lengths().end());
    EXPECT_LT(*greatest, 3 * *least);
  }
  EXPECT_EQ(split_long_edges(mesh, 1e-6, 0).mesh.n_faces(), mesh.n_faces());
  EXPECT_THROW(split_long_edges(mesh, 0, 100), Error);
}

TEST(RefinementTrail, LeadsBackToTheSamePlacesAndSharedFaces) {
  test::Rng rng(5);
  const TriangleMesh mesh = test::torus(6, 5, 4, 1);
  TriangleMesh finer = mesh;
  RefinementTrail trail;
  EXPECT_EQ(trail.on_first({2, Vec3::UnitY()}).face, 2);
  for (const double longest : {1.5, 0.7, 0.4}) {
    RefinedMesh refined = split_long_edges(finer, longest, 100000);
    trail.add(finer, refined);
    finer = std::move(refined.mesh);
  }
  EXPECT_FALSE(trail.on_first({}).valid());
  for (int n = 0; n < 1000; ++n) {
    const SurfacePoint a = test::random_supported_point(rng, finer);
    const SurfacePoint on_first = trail.on_first(a);
    EXPECT_NEAR((position_of(mesh, on_first) - position_of(finer, a)).norm(), 0, 1e-13 * mesh.size());
    // the other points of the faces around it, which may lie beyond an edge of the old mesh
    const Support support = support_of(finer, a);
    for (int i = 0; i < 3 && support.kind == Support::Kind::edge; ++i) {
      const Index twin = finer.twin(support.index);
      for (const Index face : {TriangleMesh::face_of(support.index), TriangleMesh::face_of(twin)})
        EXPECT_NE(common_face(mesh, on_first, trail.on_first({face, Vec3::Unit(i)})), no_index) << n;
    }
  }
}

TEST(Refine, WithoutWishesNothingChanges) {
  const TriangleMesh mesh = test::torus(6, 5, 4, 1);
  const RefinedMesh same = refine(
      mesh, [](const RefineTriangle&) { return false; }, 3);
  EXPECT_EQ(same.mesh.soup().triangles, mesh.soup().triangles);
  EXPECT_EQ(refine(
                mesh, [](const RefineTriangle&) { return true; }, 0)
                .mesh.n_faces(),
            mesh.n_faces());
  EXPECT_THROW(refine(
                   mesh, [](const RefineTriangle&) { return true; }, -1),
               Error);
}

}  // namespace
}  // namespace isopath
