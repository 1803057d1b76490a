#include "isopath/field/graph_field.h"

#include <gtest/gtest.h>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "support/random_sources.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

TEST(GraphField, IsNeverBelowTheExactDistanceAndMoreArcsDoNotLengthenIt) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const TriangleMesh mesh = random_mesh(rng, {.closed = seed % 2 == 0, .holes = seed % 5 == 0});
    const SourceSet sources = random_sources(rng, mesh);
    const ExactField exact = ExactField::compute(mesh, sources);
    const auto plain = graph_distances(mesh, sources);
    const auto across = graph_distances(mesh, sources, {.across_pairs = true});
    const auto dense = graph_distances(mesh, sources, {.virtual_vertices = 3, .across_pairs = true});
    const double tolerance = 1e-10 * mesh.size();
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      if (exact.value_at_vertex(v) == infinity) {
        EXPECT_EQ(plain[v], infinity);
        continue;
      }
      EXPECT_GE(dense[v], exact.value_at_vertex(v) - tolerance);
      EXPECT_LE(dense[v], across[v] + tolerance);
      EXPECT_LE(across[v], plain[v] + tolerance);
    }
  }
}

TEST(GraphField, FollowsTheEdgesOfAGrid) {
  const TriangleMesh mesh = planar_grid(4, 4, 4, 4);
  SourceSet sources;
  sources.add_vertex(mesh, 0);
  const auto distance = graph_distances(mesh, sources);
  // The diagonals run from lower left to upper right.
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3& p = mesh.position(v);
    const double both = std::min(p.x(), p.y());
    EXPECT_NEAR(distance[v], both * std::sqrt(2.0) + std::max(p.x(), p.y()) - both, 1e-13);
  }
  // Over one pair of faces: a knight's move.
  EXPECT_NEAR(graph_distances(mesh, sources, {.across_pairs = true})[7], std::sqrt(5.0), 1e-13);
}

TEST(GraphField, VirtualVerticesApproachTheExactDistance) {
  const TriangleMesh mesh = planar_grid(8, 8, 1, 1, {.jitter = 0.2});
  SourceSet sources;
  sources.add_vertex(mesh, 0);
  const auto worst = [&](int n) {
    const auto distance = graph_distances(mesh, sources, {.virtual_vertices = n});
    double error = 0;
    for (Index v = 1; v < mesh.n_vertices(); ++v) error = std::max(error, distance[v] / mesh.position(v).norm() - 1);
    return error;
  };
  EXPECT_LT(worst(9), 0.1 * worst(0));
}

TEST(GraphField, SaysWhatIsWrong) {
  const TriangleMesh mesh = tetrahedron(1);
  SourceSet sources;
  EXPECT_THROW(graph_distances(mesh, sources), Error);
  sources.add_vertex(mesh, 0);
  EXPECT_THROW(graph_distances(mesh, sources, {.virtual_vertices = -1}), Error);
  EXPECT_THROW(graph_distances(mesh, sources, {.virtual_vertices = 101}), Error);
}

}  // namespace
}  // namespace isopath::test
