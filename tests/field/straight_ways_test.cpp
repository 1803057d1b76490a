#include "isopath/field/straight_ways.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "isopath/field/exact_field.h"
#include "support/random_sources.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

/// The shortest way to each vertex, infinity where none comes.
std::vector<double> shortest(const TriangleMesh& mesh, std::span<const StraightWays::Way> ways) {
  std::vector<double> shortest(mesh.n_vertices(), infinity);
  for (const StraightWays::Way& way : ways) shortest[way.to] = std::min(shortest[way.to], way.length);
  return shortest;
}

TEST(StraightWays, SeeAConvexPlane) {
  const TriangleMesh mesh = planar_grid(7, 6, 7, 6, {.jitter = 0.24});
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    StraightWays ways(mesh);
    const SurfacePoint start = random_surface_point(rng, mesh);
    const auto from_point = shortest(mesh, ways.from_element({.a = start, .b = start}, 10'000));
    const Index vertex = random_index(rng, mesh.n_vertices());
    const auto from_vertex = shortest(mesh, ways.from_vertex(vertex, 10'000));
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      EXPECT_NEAR(from_point[v], (mesh.position(v) - position_of(mesh, start)).norm(), 1e-9);
      // neighbours are reached along edges, which are no ways through faces
      if (from_vertex[v] < infinity) {
        EXPECT_NEAR(from_vertex[v], (mesh.position(v) - mesh.position(vertex)).norm(), 1e-9);
      } else {
        EXPECT_LT((mesh.position(v) - mesh.position(vertex)).norm(), 2.2);
      }
    }
  }
}

TEST(StraightWays, LeaveASegmentAtRightAnglesToBothSides) {
  const TriangleMesh mesh = planar_grid(7, 6, 7, 6, {.jitter = 0.24});
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    SurfacePoint a = random_surface_point(rng, mesh);
    SurfacePoint b = random_surface_point(rng, mesh);
    b.face = a.face;
    const Vec3 start = position_of(mesh, a);
    const Vec3 along = position_of(mesh, b) - start;
    StraightWays ways(mesh);
    const auto found =
        shortest(mesh, ways.from_element({.kind = SourceElement::Kind::segment, .a = a, .b = b}, 10'000));
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      const Vec3 way = mesh.position(v) - start;
      const double at = way.dot(along) / along.squaredNorm();
      if (std::min(at, 1 - at) < 1e-6 && std::max(at, 1 - at) < 1 + 1e-6) continue;  // either answer is right
      if (at < 0 || at > 1) {
        EXPECT_EQ(found[v], infinity);
      } else {
        EXPECT_NEAR(found[v], (way - at * along).norm(), 1e-9);
      }
    }
  }
}

TEST(StraightWays, AreNeverShorterThanTheShortest) {
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const TriangleMesh mesh = random_mesh(rng, {.closed = seed % 2 == 0, .holes = seed % 5 == 0});
    StraightWays ways(mesh);
    const SourceSet sources = random_sources(rng, mesh);
    const ExactField exact = ExactField::compute(mesh, sources);
    for (const SourceElement& element : sources.elements()) {
      for (const auto& way : ways.from_element(element, 200)) {
        EXPECT_GE(way.length, exact.vertex_distances()[way.to] - 1e-7 * mesh.size());
      }
    }
    SourceSet vertex;
    const Index v = mesh.from(random_index(rng, mesh.n_halfedges()));
    vertex.add_vertex(mesh, v);
    const ExactField from_vertex = ExactField::compute(mesh, vertex);
    for (const auto& way : ways.from_vertex(v, 200)) {
      EXPECT_GE(way.length, from_vertex.vertex_distances()[way.to] - 1e-7 * mesh.size());
    }
  }
}

TEST(StraightWays, CrossNoMoreFacesThanAllowed) {
  const TriangleMesh mesh = planar_grid(20, 20, 20, 20);
  StraightWays ways(mesh);
  const Index middle = 10 * 21 + 10;
  for (const std::size_t most : {0, 1, 7, 30}) EXPECT_LE(ways.from_vertex(middle, most).size(), most);
  EXPECT_EQ(ways.from_vertex(middle, 6).size(), 6);  // one behind each of its six faces
}

}  // namespace
}  // namespace isopath::test
