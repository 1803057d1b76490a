#include "isopath/mesh/local_numbering.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "support/hard_meshes.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

/// Every vertex and face has one number here and is the one of that number; corners stay in order.
void expect_one_to_one(const TriangleMesh& mesh, const LocalNumbering& numbering) {
  std::vector<int> seen(mesh.n_vertices(), 0);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Index here = numbering.vertex_here(v);
    ASSERT_TRUE(0 <= here && here < mesh.n_vertices());
    ASSERT_EQ(seen[here]++, 0);
    ASSERT_EQ(numbering.vertex_in_mesh(here), v);
  }
  seen.assign(mesh.n_halfedges(), 0);
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    const Index here = numbering.halfedge_here(h);
    ASSERT_TRUE(0 <= here && here < mesh.n_halfedges());
    ASSERT_EQ(seen[here]++, 0);
    ASSERT_EQ(numbering.halfedge_in_mesh(here), h);
    ASSERT_EQ(numbering.halfedge_here(TriangleMesh::next(h)), TriangleMesh::next(here));
  }
  EXPECT_EQ(numbering.halfedge_here(no_index), no_index);
  EXPECT_EQ(numbering.halfedge_in_mesh(no_index), no_index);
}

/// Mean difference of the numbers of neighbours, in parts of all there are: of half-edges and of vertices.
std::pair<double, double> apart(const TriangleMesh& mesh, const LocalNumbering& numbering) {
  double halfedges = 0;
  double vertices = 0;
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    const Index twin = mesh.twin(h);
    if (twin != no_index) halfedges += std::abs(numbering.halfedge_here(h) - numbering.halfedge_here(twin));
    vertices += std::abs(numbering.vertex_here(mesh.from(h)) - numbering.vertex_here(mesh.to(h)));
  }
  const double n = mesh.n_halfedges();
  return {halfedges / n / n, vertices / n / mesh.n_vertices()};
}

TEST(LocalNumbering, IsThatOfTheMeshWhereNeighboursAreNear) {
  for (const TriangleMesh& mesh : {wavy_sheet(150, 1, 0.1, 6, 5, 1), planar_grid(20000, 2, 1, 1), icosphere(6, 1),
                                   lofted_blade(50, 400), TriangleMesh{}}) {
    const LocalNumbering numbering(mesh);
    EXPECT_TRUE(numbering.is_that_of_mesh());
    expect_one_to_one(mesh, numbering);
  }
}

/// Whichever of a grid's half-edges the sample happens to meet: those to the next row are far from their twins.
TEST(LocalNumbering, IsThatOfGridsWithLongRows) {
  for (int rows = 20; rows < 32; ++rows) {
    EXPECT_TRUE(LocalNumbering(planar_grid(5000, rows, 1, 1)).is_that_of_mesh()) << rows << " rows";
  }
}

TEST(LocalNumbering, LeavesMeshesAloneThatFitIntoACache) {
  Rng rng(1);
  EXPECT_TRUE(LocalNumbering(renumbered(rng, wavy_sheet(40, 1, 0.1, 6, 5, 1)).mesh).is_that_of_mesh());
}

TEST(LocalNumbering, BringsNeighboursTogether) {
  Rng rng(2);
  for (const TriangleMesh& mesh :
       {wavy_sheet(150, 1, 0.1, 6, 5, 1), icosphere(6, 1), lofted_blade(50, 400), planar_grid(20000, 1, 1e4, 1)}) {
    const TriangleMesh scattered = renumbered(rng, mesh).mesh;
    const LocalNumbering numbering(scattered);
    ASSERT_FALSE(numbering.is_that_of_mesh());
    expect_one_to_one(scattered, numbering);
    const auto [halfedges, vertices] = apart(scattered, numbering);
    EXPECT_LT(halfedges, 0.04);  // of random numbers a third
    EXPECT_LT(vertices, 0.04);
  }
}

TEST(LocalNumbering, LooksAtFacesAndVerticesAlike) {
  Rng rng(3);
  // faces in order, vertices not
  TriangleSoup soup = wavy_sheet(200, 1, 0.1, 6, 5, 1).soup();
  std::vector<Index> number(soup.positions.size());
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), rng);
  const std::vector<Vec3> positions = soup.positions;
  for (std::size_t v = 0; v < number.size(); ++v) soup.positions[number[v]] = positions[v];
  for (Triangle& triangle : soup.triangles) {
    for (Index& v : triangle) v = number[v];
  }
  EXPECT_FALSE(LocalNumbering(TriangleMesh(soup)).is_that_of_mesh());
  // vertices in order, faces not
  TriangleSoup other = wavy_sheet(200, 1, 0.1, 6, 5, 1).soup();
  std::shuffle(other.triangles.begin(), other.triangles.end(), rng);
  EXPECT_FALSE(LocalNumbering(TriangleMesh(other)).is_that_of_mesh());
}

TEST(LocalNumbering, TakesBoxesOfAnyShape) {
  Rng rng(4);
  const TriangleMesh scattered = renumbered(rng, icosphere(6, 1)).mesh;
  for (const Vec3& scale : {Vec3(1, 1, 0), Vec3(0, 1, 0), Vec3(0, 0, 0), Vec3(1e50, 1, 1), Vec3(1e-60, 1e-60, 0)}) {
    TriangleSoup soup = scattered.soup();
    soup.positions.push_back(Vec3::Zero());  // no face uses it
    for (Vec3& p : soup.positions) p = p.cwiseProduct(scale);
    const TriangleMesh mesh(soup);
    const LocalNumbering numbering(mesh);
    EXPECT_FALSE(numbering.is_that_of_mesh());
    expect_one_to_one(mesh, numbering);
  }
}

}  // namespace
}  // namespace isopath::test
