#include "isopath/field/virtual_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <numbers>
#include <tuple>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/checked_distances.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/fan_layout.h"
#include "isopath/field/graph_field.h"
#include "isopath/mesh/read_mesh.h"
#include "support/random_sources.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

/// Rounding of single precision over the unfoldings of these meshes, relative to the distance.
constexpr double rounding = 2e-5;

SourceSet vertex_source(const TriangleMesh& mesh, Index vertex) {
  SourceSet source;
  source.add_vertex(mesh, vertex);
  return source;
}

struct RelativeErrors {
  double mean = 0;
  double lowest = 0;
  double highest = 0;
};

RelativeErrors errors_of(const std::vector<double>& distance, std::span<const double> truth) {
  RelativeErrors errors;
  std::size_t n = 0;
  for (std::size_t v = 0; v < distance.size(); ++v) {
    EXPECT_EQ(distance[v] == infinity, truth[v] == infinity) << v;
    if (!(truth[v] > 0) || truth[v] == infinity) continue;
    const double error = (distance[v] - truth[v]) / truth[v];
    errors.mean += std::abs(error);
    errors.lowest = std::min(errors.lowest, error);
    errors.highest = std::max(errors.highest, error);
    ++n;
  }
  errors.mean /= static_cast<double>(std::max<std::size_t>(n, 1));
  return errors;
}

RelativeErrors errors_against_exact(const TriangleMesh& mesh, const SourceSet& sources) {
  const ExactField exact = ExactField::compute(mesh, sources, {.accuracy = 1e-7 * mesh.size()});
  return errors_of(virtual_source_distances(mesh, sources), exact.vertex_distances());
}

TEST(FanLayout, HoldsTheFacesAroundEveryVertex) {
  constexpr float single = 1e-6F;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    const TriangleMesh mesh = random_case(seed).mesh;
    const FanLayout fans(mesh);
    FanBatch batch(fans);
    const std::vector<Arrival> arrivals(mesh.n_vertices());
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      batch.clear();
      batch.add(static_cast<std::uint32_t>(v), arrivals.data());
      const Fan& fan = batch[0];
      const Index start = mesh.outgoing(v);
      double sum = 0;
      std::size_t i = 0;
      for (Index h = start; h != no_index;) {
        ASSERT_LT(i + 1, fan.n_spokes);
        const Vec3 along = mesh.position(mesh.to(h)) - mesh.position(v);
        const Vec3 next = mesh.position(mesh.from(TriangleMesh::prev(h))) - mesh.position(v);
        const double product = along.norm() * next.norm();
        EXPECT_EQ(fan.ends[i], static_cast<std::uint32_t>(mesh.to(h)));
        EXPECT_EQ(fan.ends[i + 1], static_cast<std::uint32_t>(mesh.from(TriangleMesh::prev(h))));
        EXPECT_FLOAT_EQ(fan.length[i], static_cast<float>(along.norm() / fans.unit()));
        EXPECT_EQ(fan.next_length[i], fan.length[i + 1]);
        EXPECT_NEAR(fan.cosine[i], along.dot(next) / product, single);
        EXPECT_NEAR(fan.sine[i], along.cross(next).norm() / product, single);
        sum += std::atan2(along.cross(next).norm(), along.dot(next));
        ++i;
        h = mesh.next_outgoing(h);
        if (h == start) break;
      }
      if (start == no_index) {
        EXPECT_EQ(fan.n_spokes, 0);
        continue;
      }
      ASSERT_EQ(fan.n_spokes, i + 1);  // a closed fan ends with its first spoke, an open one with its last edge
      if (fan.closed) {
        const auto spoke = [&](std::size_t k) {
          return std::tie(fan.ends[k], fan.length[k], fan.cosine[k], fan.sine[k]);
        };
        EXPECT_EQ(spoke(i), spoke(0));
      }
      EXPECT_EQ(fan.closed, !mesh.is_boundary_vertex(v));
      const double excess = sum - (fan.closed ? 2 : 1) * std::numbers::pi;
      const auto is_told = [&](bool told, double limit) {
        return told == (excess > limit) || std::abs(excess - limit) < 1e-3;
      };
      EXPECT_TRUE(is_told(fan.bends, 0.03)) << excess;
      EXPECT_TRUE(is_told(fan.bends_sharply, 0.5)) << excess;
    }
  }
}

TEST(VirtualSource, IsNeverTooShortAndAlmostAlwaysExactFromAPointOnAConvexPlane) {
  // Once in a few hundred grids a vertex is served when a neighbour is not yet final.
  int exact = 0;
  const int n_cases = 120;
  for (std::uint64_t seed = 0; seed < n_cases; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const TriangleMesh mesh = planar_grid(23, 17, random_real(rng, 5, 60), 17, {.jitter = 0.24, .seed = seed});
    const SurfacePoint start = random_supported_point(rng, mesh);
    SourceSet source;
    source.add_point(start);
    const auto distance = virtual_source_distances(mesh, source);
    double worst = 0;
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      const double truth = (mesh.position(v) - position_of(mesh, start)).norm();
      EXPECT_GE(distance[v], truth - rounding * mesh.size());
      worst = std::max(worst, distance[v] - truth);
    }
    EXPECT_LT(worst, 0.001 * mesh.size());
    exact += worst < rounding * mesh.size() ? 1 : 0;
  }
  EXPECT_GE(exact, 0.98 * n_cases);
}

TEST(VirtualSource, BringsStraightFrontsOverAPlane) {
  const TriangleMesh mesh = planar_grid(13, 9, 13, 9, {.jitter = 0.24});
  SourceSet left;
  std::vector<SurfacePoint> line;
  for (Index j = 0; j <= 9; ++j) line.push_back(point_at_vertex(mesh, j * 14));
  left.add_polyline(mesh, line, false);
  const auto distance = virtual_source_distances(mesh, left);
  for (Index v = 0; v < mesh.n_vertices(); ++v) EXPECT_NEAR(distance[v], mesh.position(v).x(), rounding * 13);
}

TEST(VirtualSource, BendsAtReflexCorners) {
  const int n = 12;
  const TriangleMesh mesh = l_shape(n);
  Index start = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if ((mesh.position(v) - Vec3(2 * n, 2, 0)).norm() < 1e-9) start = v;
  }
  const auto distance = virtual_source_distances(mesh, vertex_source(mesh, start));
  const Vec3 s = mesh.position(start);
  const Vec3 corner(n, n, 0);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 p = mesh.position(v);
    const bool in_shadow = p.x() <= n && (p.y() - n) * n > (n - 2) * (n - p.x());
    const double truth = in_shadow ? (s - corner).norm() + (p - corner).norm() : (p - s).norm();
    EXPECT_GE(distance[v], truth - rounding * mesh.size()) << p.transpose();
    // beside the edge of the shadow one of two fronts may lose half-edges to the other
    EXPECT_LE(distance[v], 1.02 * truth + rounding * mesh.size()) << p.transpose();
  }
}

TEST(VirtualSource, IsLittleTooShortOnFlatParts) {
  // Too short it is only where two fronts meet within a face, and these faces are few and large.
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const TriangleMesh mesh = seed % 3 == 0   ? notched_square(11)
                              : seed % 3 == 1 ? l_shape(8)
                                              : planar_star(static_cast<int>(3 + seed % 7), 5, 1);
    const SourceSet sources = random_sources(rng, mesh);
    const RelativeErrors errors = errors_against_exact(mesh, sources);
    EXPECT_GT(errors.lowest, -5e-3);
  }
}

TEST(VirtualSource, IsExactOnCoarseStars) {
  // Faces as long as the star: all is next to a source, or to a reflex corner that a way bends at.
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const TriangleMesh mesh = planar_star(static_cast<int>(3 + seed % 7), 5, 1);
    const RelativeErrors errors = errors_against_exact(mesh, random_sources(rng, mesh));
    EXPECT_LT(errors.highest, rounding);
    EXPECT_GT(errors.lowest, -1e-3);
  }
}

TEST(VirtualSource, UnfoldsACylinder) {
  const int n = 96;
  const double radius = 2;
  const TriangleMesh mesh = open_cylinder(n, 40, radius, 6);
  const auto distance = virtual_source_distances(mesh, vertex_source(mesh, 0));
  const double chord = 2 * radius * std::sin(std::numbers::pi / n);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const int side = static_cast<int>(v) % n;
    const double around = chord * std::min(side, n - side);
    const double truth = std::hypot(around, mesh.position(v).z() - mesh.position(0).z());
    // where the fronts from both sides meet, half-way round, what passes is held up by an edge at most
    const bool apart = std::abs(2 * side - n) > 8;
    EXPECT_NEAR(distance[v], truth, (apart ? rounding : 1e-3) * truth + rounding) << v;
  }
}

TEST(VirtualSource, UnfoldsACone) {
  const int n = 64;
  const int rings = 24;
  const TriangleMesh mesh = open_cone(n, rings, 3, 5);
  const Index start = 1 + (rings - 1) * n;
  const double slant = (mesh.position(start) - mesh.position(0)).norm();
  const auto distance = virtual_source_distances(mesh, vertex_source(mesh, start));
  for (Index v = 1; v < mesh.n_vertices(); ++v) {
    const int side = static_cast<int>(v - 1) % n;
    const double turn = cone_angle(n, 3, 5) * std::min(side, n - side) / n;
    const double along = (mesh.position(v) - mesh.position(0)).norm();
    // the base of the unfolded cone is convex, and its apex no saddle: the straight line, or over the apex
    const double truth = turn < std::numbers::pi
                             ? std::sqrt(slant * slant + along * along - 2 * slant * along * std::cos(turn))
                             : slant + along;
    // between neighbours on the rim the way runs along chords, which the line through the base cuts off
    EXPECT_NEAR(distance[v], truth, 0.003 * truth + rounding) << v;
  }
}

TEST(VirtualSource, MeanErrorOnWavySheetsIsBelowAQuarterOfAPercent) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(seed);
    const TriangleMesh mesh = wavy_sheet(70, 1, 0.1, 6, 5, seed);
    Rng rng(seed);
    EXPECT_LT(errors_against_exact(mesh, vertex_source(mesh, random_index(rng, mesh.n_vertices()))).mean, 0.0025);
    EXPECT_LT(errors_against_exact(mesh, boundary_source(mesh)).mean, 0.0025);
  }
}

TEST(VirtualSource, MeanErrorOnRoughSurfacesIsBelowAQuarterOfAPercent) {
  // a ball with noise in all directions by a tenth of an edge
  TriangleSoup soup = icosphere(4, 1).soup();
  Rng rng(3);
  for (Vec3& p : soup.positions) {
    p *= 1 + 0.1 * std::sin(6 * p.x()) * std::cos(5 * p.y());
    for (int i = 0; i < 3; ++i) p[i] += random_real(rng, -0.007, 0.007);
  }
  const TriangleMesh mesh(std::move(soup));
  EXPECT_LT(errors_against_exact(mesh, vertex_source(mesh, 7)).mean, 0.0025);
}

TEST(VirtualSource, MeanErrorOnScansIsBelowAQuarterOfAPercent) {
  const std::filesystem::path folder = std::filesystem::path(ISOPATH_SHARED_DIR) / "surfaces";
  for (const char* name : {"lion_head_scan.off", "face_scan.ply"}) {
    if (!std::filesystem::exists(folder / name)) GTEST_SKIP() << "there is no " << folder / name;
    SCOPED_TRACE(name);
    const TriangleMesh mesh(read_mesh(folder / name).soup);
    EXPECT_LT(errors_against_exact(mesh, vertex_source(mesh, mesh.n_vertices() / 2)).mean, 0.0025);
    EXPECT_LT(errors_against_exact(mesh, boundary_source(mesh)).mean, 0.0025);
  }
}

TEST(VirtualSource, StaysAccurateOnThinTriangles) {
  const TriangleMesh mesh = lofted_blade(40, 40);
  EXPECT_LT(errors_against_exact(mesh, vertex_source(mesh, mesh.n_vertices() / 2)).mean, 0.003);
  EXPECT_LT(errors_against_exact(mesh, boundary_source(mesh)).mean, 0.003);
}

TEST(VirtualSource, ReachesWhatEdgesReachAndIsNeverLongerThanTheWayAlongThem) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const auto [mesh, sources] = random_case(seed);
    const auto distance = virtual_source_distances(mesh, sources);
    const auto along_edges = graph_distances(mesh, sources);
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      EXPECT_GE(distance[v], 0);
      EXPECT_LE(distance[v], along_edges[v] * (1 + rounding));
      EXPECT_EQ(distance[v] == infinity, along_edges[v] == infinity);
    }
  }
}

TEST(VirtualSource, DiffersAlongAnEdgeByItsLengthAtMost) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const auto [mesh, sources] = random_case(seed);
    const auto distance = virtual_source_distances(mesh, sources);
    for (Index h = 0; h < 3 * mesh.n_faces(); ++h) {
      const double least = distance[mesh.from(h)];
      EXPECT_LE(distance[mesh.to(h)], (least + mesh.edge_length(mesh.edge_of(h))) * (1 + rounding));
    }
  }
}

TEST(VirtualSource, SolverServesManySources) {
  const TriangleMesh mesh = wavy_sheet(20, 1, 0.1, 6, 5, 4);
  const VirtualSourceSolver solver(mesh);
  for (const SourceSet& sources : {vertex_source(mesh, 7), boundary_source(mesh), vertex_source(mesh, 300)}) {
    EXPECT_EQ(solver.distances(sources), virtual_source_distances(mesh, sources));
  }
}

TEST(VirtualSource, FollowsTheMesh) {
  const TriangleMesh mesh = wavy_sheet(24, 1, 0.1, 6, 5, 4);
  const auto distances = [](const TriangleMesh& m) {
    SourceSet source = boundary_source(m);
    source.add_vertex(m, 300);
    return virtual_source_distances(m, source);
  };
  const auto reference = distances(mesh);
  for (const double factor : {std::ldexp(1.0, -40), std::ldexp(1.0, 40)}) {
    const auto other = distances(scaled(mesh, factor));
    for (Index v = 0; v < mesh.n_vertices(); ++v) EXPECT_DOUBLE_EQ(other[v], factor * reference[v]);
  }
  const auto other = distances(moved(mesh, Vec3(1, 2, 3), 0.7, Vec3(5, -4, 3)));
  for (Index v = 0; v < mesh.n_vertices(); ++v) EXPECT_NEAR(other[v], reference[v], 1e-3 * mesh.size());
}

TEST(VirtualSource, IsTheSameFromRunToRun) {
  const TriangleMesh mesh = wavy_sheet(30, 1, 0.1, 6, 5, 4);
  EXPECT_EQ(virtual_source_distances(mesh, boundary_source(mesh)),
            virtual_source_distances(mesh, boundary_source(mesh)));
}

TEST(VirtualSource, LeavesUnusedVerticesUnreached) {
  TriangleSoup soup = tetrahedron(1).soup();
  soup.positions.push_back(Vec3(5, 5, 5));
  const TriangleMesh mesh(std::move(soup));
  const auto distance = virtual_source_distances(mesh, vertex_source(mesh, 0));
  ASSERT_EQ(distance.size(), 5);
  EXPECT_EQ(distance[0], 0);
  for (int v = 1; v < 4; ++v) EXPECT_NEAR(distance[v], 1, std::numeric_limits<float>::epsilon()) << v;
  EXPECT_EQ(distance[4], infinity);
}

class Cancelled : public Progress {
  bool cancelled() const override { return true; }
};

TEST(VirtualSource, StopsOnRequest) {
  const TriangleMesh mesh = tetrahedron(1);
  Cancelled progress;
  EXPECT_THROW(virtual_source_distances(mesh, vertex_source(mesh, 0), progress), Error);
}

TEST(VirtualSource, SaysWhatIsWrong) { EXPECT_THROW(virtual_source_distances(tetrahedron(1), SourceSet{}), Error); }

TEST(CheckedDistances, KeepsToTheBoundEitherWay) {
  const TriangleMesh mesh = wavy_sheet(30, 1, 0.1, 6, 5, 1);
  const SourceSet source = vertex_source(mesh, 17);
  const ExactField exact = ExactField::compute(mesh, source);
  for (const double bound : {1e-6, 0.5}) {
    const CheckedDistances found = checked_distances(mesh, source, {.max_error = bound, .sample = 1});
    const RelativeErrors errors = errors_of(found.at_vertices, exact.vertex_distances());
    EXPECT_LE(std::max(errors.highest, -errors.lowest), bound * (1 + 1e-6));
    EXPECT_EQ(found.exact, found.estimated_error > bound);
  }
  EXPECT_TRUE(checked_distances(mesh, source, {.max_error = 1e-6}).exact);
  EXPECT_FALSE(checked_distances(mesh, source, {.max_error = 0.5}).exact);
}

TEST(CheckedDistances, RefusesBadOptions) {
  EXPECT_EQ(CheckedDistancesOptions{}.max_error, 0.01);
  for (const double bad : {0.0, -1.0, 1.0, infinity}) {
    EXPECT_THROW((CheckedDistancesOptions{.max_error = bad}.validate()), Error);
  }
  EXPECT_THROW((CheckedDistancesOptions{.sample = 0}.validate()), Error);
  EXPECT_THROW((CheckedDistancesOptions{.sample = 1.5}.validate()), Error);
}

}  // namespace
}  // namespace isopath::test
