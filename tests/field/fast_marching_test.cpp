#include "isopath/field/fast_marching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/graph_field.h"
#include "support/random_sources.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

double worst_error(const TriangleMesh& mesh, const std::vector<double>& distance,
                   const std::function<double(Index)>& truth) {
  double error = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) error = std::max(error, std::abs(distance[v] - truth(v)));
  return error;
}

TEST(FastMarching, IsExactForStraightFrontsOnAPlane) {
  const TriangleMesh mesh = planar_grid(13, 9, 13, 9, {.jitter = 0.24});
  SourceSet left;
  std::vector<SurfacePoint> line;
  for (Index j = 0; j <= 9; ++j) line.push_back(point_at_vertex(mesh, j * 14));
  left.add_polyline(mesh, line, false);
  const auto distance = fast_marching_distances(mesh, left);
  for (Index v = 0; v < mesh.n_vertices(); ++v) EXPECT_NEAR(distance[v], mesh.position(v).x(), 1e-12);
}

/// Error of the distance from the corner of a unit square, with edges of 1 / n.
double error_on_plane(int n, double jitter) {
  const TriangleMesh mesh = planar_grid(n, n, 1, 1, {.jitter = jitter});
  SourceSet corner;
  corner.add_vertex(mesh, 0);
  return worst_error(mesh, fast_marching_distances(mesh, corner), [&](Index v) { return mesh.position(v).norm(); });
}

TEST(FastMarching, ConvergesWithFirstOrderOnAPlane) {
  for (const double jitter : {0.0, 0.2}) {
    SCOPED_TRACE(jitter);
    // h (1 + ln(1 / h)) falls by 0.55 to 0.59 from one size to the next.
    for (int n = 16; n <= 128; n *= 2) {
      const double h = std::sqrt(2.0) / n;
      const double estimate = h * (1 + std::log(std::sqrt(2.0) / h)) / 8;
      EXPECT_LT(error_on_plane(n, jitter), estimate) << n;
      EXPECT_LT(error_on_plane(2 * n, jitter), 0.65 * error_on_plane(n, jitter)) << n;
    }
  }
}

TEST(FastMarching, ConvergesWithFirstOrderOnACylinder) {
  double before = infinity;
  for (const int n : {24, 48, 96, 192}) {
    const double radius = 1;
    const double height = 3;
    const TriangleMesh mesh = open_cylinder(n, n / 2, radius, height);
    SourceSet source;
    source.add_vertex(mesh, 0);
    const Vec3 start = mesh.position(0);
    const double error = worst_error(mesh, fast_marching_distances(mesh, source), [&](Index v) {
      const Vec3 p = mesh.position(v);
      const double turn =
          std::abs(std::remainder(std::atan2(p.y(), p.x()) - std::atan2(start.y(), start.x()), 2 * std::numbers::pi));
      return std::hypot(radius * turn, p.z() - start.z());
    });
    EXPECT_LT(error, 0.65 * before) << n;
    before = error;
  }
  EXPECT_LT(before, 0.05);
}

TEST(FastMarching, IsNeverBelowTheExactDistanceFromAPointOnAConvexPlane) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const TriangleMesh mesh = planar_grid(9, 7, random_real(rng, 1, 9), 7, {.jitter = 0.24, .seed = seed});
    SourceSet source;
    const SurfacePoint start = random_supported_point(rng, mesh);
    source.add_point(start);
    const auto distance = fast_marching_distances(mesh, source);
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      EXPECT_GE(distance[v], (mesh.position(v) - position_of(mesh, start)).norm() - 1e-12);
    }
  }
}

TEST(FastMarching, ReachesWhatEdgesReachAndIsNeverLongerThanTheWayAlongThem) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const auto [mesh, sources] = random_case(seed);
    const auto distance = fast_marching_distances(mesh, sources);
    const auto along_edges = graph_distances(mesh, sources);
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      EXPECT_GE(distance[v], 0);
      EXPECT_LE(distance[v], along_edges[v] * (1 + 1e-12));
      EXPECT_EQ(distance[v] == infinity, along_edges[v] == infinity);
    }
  }
}

TEST(FastMarching, IsMonotone) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const TriangleMesh mesh = planar_grid(8, 8, 1, random_real(rng, 0.5, 2), {.jitter = 0.1, .seed = seed});
    SourceSet sources;
    sources.add_vertex(mesh, random_index(rng, mesh.n_vertices()));
    const auto before = fast_marching_distances(mesh, sources);
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      if (before[v] == 0) continue;
      // a vertex without a nearer neighbour would be a source that nobody named
      double nearest = infinity;
      for (Index h = mesh.outgoing(v); h != no_index;) {
        nearest = std::min({nearest, before[mesh.to(h)], before[mesh.from(TriangleMesh::prev(h))]});
        h = mesh.next_outgoing(h);
        if (h == mesh.outgoing(v)) break;
      }
      EXPECT_LT(nearest, before[v]);
    }
    sources.add_vertex(mesh, random_index(rng, mesh.n_vertices()));
    const auto after = fast_marching_distances(mesh, sources);
    for (Index v = 0; v < mesh.n_vertices(); ++v) EXPECT_LE(after[v], before[v] + 1e-12);
  }
}

TEST(FastMarching, SplitsObtuseCorners) {
  // Sheared squares have corners of 162 degrees. Were fronts to enter these only along their sides, errors would not
  // shrink with the triangles.
  double before = infinity;
  for (const int n : {20, 40, 80}) {
    TriangleSoup soup = planar_grid(n, n, 1, 1).soup();
    for (Vec3& p : soup.positions) p.x() += 2 * p.y();
    const TriangleMesh mesh(soup);
    const Index middle = (n / 2) * (n + 1) + n / 2;
    SourceSet source;
    source.add_vertex(mesh, middle);
    const double error = worst_error(mesh, fast_marching_distances(mesh, source),
                                     [&](Index v) { return (mesh.position(v) - mesh.position(middle)).norm(); });
    EXPECT_LT(error, 0.65 * before) << n;
    before = error;
  }
}

TEST(FastMarching, ScalesWithTheMesh) {
  const TriangleMesh mesh = lofted_blade(12, 8);
  const auto distances = [](const TriangleMesh& m) {
    SourceSet source;
    source.add_vertex(m, 5);
    source.add_halfedges(m, m.boundary_loops().front(), true);
    return fast_marching_distances(m, source);
  };
  const auto reference = distances(mesh);
  for (const double factor : {1e-6, 1e6}) {
    const auto scaled_up = distances(scaled(mesh, factor));
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      EXPECT_NEAR(scaled_up[v], factor * reference[v], 1e-11 * factor * mesh.size());
    }
  }
}

TEST(FastMarching, StartsWithExactDistancesInTheFacesOfEverySource) {
  const TriangleMesh mesh = tetrahedron(2);
  SourceSet sources;
  sources.add_point({0, Vec3(0.2, 0.3, 0.5)});
  const Vec3 at = position_of(mesh, {0, Vec3(0.2, 0.3, 0.5)});
  const auto distance = fast_marching_distances(mesh, sources);
  for (const Index v : mesh.triangle(0)) EXPECT_DOUBLE_EQ(distance[v], (mesh.position(v) - at).norm());
}

TEST(FastMarching, SaysWhatIsWrong) { EXPECT_THROW(fast_marching_distances(tetrahedron(1), SourceSet{}), Error); }

}  // namespace
}  // namespace isopath::test
