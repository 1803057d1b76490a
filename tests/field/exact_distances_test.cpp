// Distances at the vertices alone: the same as the whole field's, for any number of threads and instruction set.

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/exact_distances.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/graph_field.h"
#include "isopath/field/list_propagation.h"
#include "support/random_sources.h"
#include "support/slow_exact.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

SourceSet one_vertex(const TriangleMesh& mesh, Index vertex) {
  SourceSet sources;
  sources.add_vertex(mesh, vertex);
  return sources;
}

void expect_same_as_field(const TriangleMesh& mesh, const SourceSet& sources, double tolerance) {
  const ExactField field = ExactField::compute(mesh, sources);
  const std::vector<double> distances = exact_distances(mesh, sources);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const double expected = field.value_at_vertex(v);
    if (expected == infinity) {
      ASSERT_EQ(distances[v], infinity);
    } else {
      ASSERT_NEAR(distances[v], expected, tolerance * mesh.size()) << "vertex " << v;
    }
  }
}

TEST(ExactDistances, AreThoseOfTheFieldOnRandomMeshes) {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const TriangleMesh mesh = random_mesh(rng, {.closed = seed % 3 == 0, .holes = seed % 5 == 0});
    expect_same_as_field(mesh, random_sources(rng, mesh), 1e-9);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(ExactDistances, AreThoseOfTheFieldOnSurfaces) {
  const TriangleMesh wavy = wavy_sheet(50, 1, 0.1, 6, 5, 1);
  expect_same_as_field(wavy, one_vertex(wavy, 0), 1e-11);
  expect_same_as_field(wavy, boundary_source(wavy), 1e-11);
  const TriangleMesh blade = lofted_blade(8, 100);
  expect_same_as_field(blade, one_vertex(blade, 0), 1e-11);
  const TriangleMesh ring = torus(60, 30, 5, 2);
  expect_same_as_field(ring, one_vertex(ring, 7), 1e-11);
}

/// Neither ties nor thin windows lose a vertex of a flat grid: where peers fail.
TEST(ExactDistances, AreStraightOnAFlatRegularGrid) {
  const TriangleMesh grid = planar_grid(100, 100, 1, 1);
  for (const Index source : {Index(0), Index(50 * 101 + 50)}) {
    const std::vector<double> distances = exact_distances(grid, one_vertex(grid, source));
    for (Index v = 0; v < grid.n_vertices(); ++v)
      ASSERT_NEAR(distances[v], (grid.position(v) - grid.position(source)).norm(), 1e-13);
  }
}

/// Calls work with n threads, however many processors there are.
template <class Work>
auto with_threads(int n, Work&& work) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(n));
  return tbb::task_arena(n).execute(work);
}

TEST(ExactDistances, DoNotDependOnTheNumberOfThreads) {
  const TriangleMesh wavy = wavy_sheet(60, 1, 0.1, 6, 5, 2);
  const auto distances = [&] { return exact_distances(wavy, one_vertex(wavy, 100)); };
  const std::vector<double> alone = with_threads(1, distances);
  for (const int n : {2, 3, 8}) EXPECT_EQ(with_threads(n, distances), alone) << n << " threads";
}

/// A square of n by n unit cells, n even: its left half and the mirror image of that.
TriangleMesh mirrored_square(Index n) {
  TriangleSoup soup = planar_grid(n, n, n, n).soup();
  for (std::size_t f = 0; f < soup.triangles.size(); f += 2) {
    const Index corner = soup.triangles[f][0];
    if (corner % (n + 1) < n / 2) continue;
    soup.triangles[f] = {corner, corner + 1, corner + n + 1};
    soup.triangles[f + 1] = {corner + 1, corner + n + 2, corner + n + 1};
  }
  return TriangleMesh(std::move(soup));
}

TEST(ExactDistances, TiesDoNotDependOnTheNumberOfThreads) {
  constexpr Index n = 96;  // its fronts are long enough to be shared
  const TriangleMesh square = mirrored_square(n);
  const IntrinsicGeometry geometry(square);
  SourceSet sides;
  for (const Index column : {0, n}) {
    for (Index row = 0; row <= n; row += 12) sides.add_vertex(square, row * (n + 1) + column);
  }
  const auto roots = [&] {
    ListPropagation propagation(square, geometry, true);
    propagation.start(source_fronts(square, geometry, sides));
    propagation.run(infinity, Progress::none());
    return propagation.vertex_roots();
  };
  const std::vector<Index> alone = with_threads(1, roots);
  for (int again = 0; again < 3; ++again) {
    for (const int threads : {2, 8}) ASSERT_EQ(with_threads(threads, roots), alone) << threads << " threads";
  }
}

/// The boundary's corner (5, 4) of this grid is reached along the boundary and along the edge opposite, from two
/// sources, in the same length and by the same half-edge.
TEST(ExactDistances, TiesInACornerOfTheBoundaryDoNotDependOnTheNumberOfThreads) {
  TriangleSoup soup = planar_grid(5, 5, 5, 5).soup();
  std::vector<Triangle> triangles;
  for (Index row = 0; row < 5; ++row) {
    for (Index column = 0; column < 5; ++column) {
      if (column >= 3 && row >= 4) continue;
      const Index a = 6 * row + column;
      const bool odd = (row + column) % 2 == 1;
      triangles.push_back(odd ? Triangle{a, a + 1, a + 6} : Triangle{a, a + 1, a + 7});
      triangles.push_back(odd ? Triangle{a + 1, a + 7, a + 6} : Triangle{a, a + 7, a + 6});
    }
  }
  soup.triangles = triangles;
  const TriangleMesh mesh(std::move(soup));
  const IntrinsicGeometry geometry(mesh);
  SourceSet sources;
  sources.add_vertex(mesh, 1 * 6 + 5);
  sources.add_vertex(mesh, 5 * 6 + 3);
  const auto roots = [&] {
    ListPropagation propagation(mesh, geometry, true);
    propagation.start(source_fronts(mesh, geometry, sources));
    propagation.run(infinity, Progress::none());
    EXPECT_EQ(propagation.vertex_distances()[4 * 6 + 5], 3);
    return propagation.vertex_roots();
  };
  const std::vector<Index> alone = with_threads(1, roots);
  EXPECT_EQ(alone[4 * 6 + 5], 0);  // the first of the two
  for (const int threads : {2, 3, 8}) EXPECT_EQ(with_threads(threads, roots), alone) << threads << " threads";
}

TEST(ExactDistances, TheirReachAlongEdgesIsThatOfTheGraph) {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const TriangleMesh mesh = random_mesh(rng, {.closed = seed % 3 == 0, .holes = seed % 5 == 0});
    SourceSet sources;
    for (int i = 0; i < 2; ++i) sources.add_vertex(mesh, mesh.from(random_index(rng, mesh.n_halfedges())));
    const IntrinsicGeometry geometry(mesh);
    ListPropagation propagation(mesh, geometry, seed % 2 == 0);
    propagation.start(source_fronts(mesh, geometry, sources));
    const std::vector<double> distances = graph_distances(mesh, sources);
    const auto farthest = [&](double stop) {
      double found = 0;
      for (const double d : distances) found = d <= stop ? std::max(found, d) : found;
      return found;
    };
    const double all = farthest(1e3 * mesh.size());
    for (const double stop : {infinity, 0.6 * all}) {
      const double expected = stop < infinity ? farthest(stop) : all;
      EXPECT_NEAR(propagation.reach_along_edges(stop, Progress::none()), expected, 1e-12 * mesh.size());
    }
  }
}

TEST(ExactDistances, AreExactUpToTheStopDistance) {
  const TriangleMesh wavy = wavy_sheet(40, 1, 0.1, 6, 5, 3);
  const SourceSet source = one_vertex(wavy, 0);
  const std::vector<double> all = exact_distances(wavy, source);
  const std::vector<double> near = exact_distances(wavy, source, 0.5);
  int beyond = 0;
  for (Index v = 0; v < wavy.n_vertices(); ++v) {
    if (all[v] <= 0.5) {
      ASSERT_NEAR(near[v], all[v], 1e-13);
    }
    EXPECT_GE(near[v], all[v] - 1e-13);
    beyond += near[v] == infinity ? 1 : 0;
  }
  EXPECT_GT(beyond, wavy.n_vertices() / 4) << "it went on beyond the stop distance";
}

TEST(ExactDistances, ManySourcesInOneCoarseFaceDoNotMultiply) {
  // Fronts that overlap on edges without a vertex near them are cut by one another.
  Rng rng(5);
  const TriangleMesh block = cube(1, 1);
  SourceSet sources;
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 2000; ++i) {
    const double a = unit(rng);
    const double b = unit(rng) * (1 - a);
    sources.add_point({static_cast<Index>(i % 3), Vec3(a, b, 1 - a - b)});
  }
  expect_same_as_field(block, sources, 1e-12);
}

TEST(ExactDistances, RefuseAnEmptySourceAndStopOnRequest) {
  const TriangleMesh grid = planar_grid(4, 4, 1, 1);
  EXPECT_THROW(exact_distances(grid, SourceSet()), Error);
  struct Cancelled : Progress {
    bool cancelled() const override { return true; }
  } cancelled;
  EXPECT_THROW(exact_distances(grid, one_vertex(grid, 0), infinity, cancelled), Error);
}

}  // namespace
}  // namespace isopath::test
