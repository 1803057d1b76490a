#include "isopath/mesh/surface_walk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "isopath/mesh/surface_locator.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

/// A point of a random face: inside it, on an edge or on a vertex.
SurfacePoint random_point(const TriangleMesh& mesh, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  SurfacePoint point{static_cast<Index>(random() % mesh.n_faces()), {unit(random), unit(random), unit(random)}};
  const int kind = static_cast<int>(random() % 4);
  if (kind == 0) point.barycentric[random() % 3] = 0;
  if (kind == 1) point.barycentric = Vec3::Unit(static_cast<int>(random() % 3));
  point.barycentric /= point.barycentric.sum();
  return point;
}

void expect_valid(const TriangleMesh& mesh, const std::vector<SurfacePoint>& way, const SurfacePoint& from,
                  const SurfacePoint& to) {
  ASSERT_GE(way.size(), 2u);
  EXPECT_EQ(way.front().face, from.face);
  EXPECT_EQ(way.front().barycentric, from.barycentric);
  EXPECT_EQ(way.back().face, to.face);
  EXPECT_EQ(way.back().barycentric, to.barycentric);
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Index face = common_face(mesh, way[i - 1], way[i]);
    ASSERT_NE(face, no_index) << "between points " << i - 1 << " and " << i << " of " << way.size();
    EXPECT_LT((position_of(mesh, express_in(mesh, way[i], face)) - position_of(mesh, way[i])).norm(),
              1e-12 * mesh.size());
    if (i + 1 == way.size()) break;
    EXPECT_NE(support_of(mesh, way[i]).kind, Support::Kind::face);
  }
  const double chord = (position_of(mesh, to) - position_of(mesh, from)).norm();
  EXPECT_GE(test::length_of(mesh, way), chord * (1 - 1e-12));
  EXPECT_LE(test::length_of(mesh, way), 4.5 * chord + 1e-12 * mesh.size());
}

TEST(SurfaceWalk, OnAPlaneItIsTheStraightLine) {
  const TriangleMesh mesh = test::planar_grid(7, 5, 14, 10);
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    const SurfacePoint from = random_point(mesh, random);
    const SurfacePoint to = random_point(mesh, random);
    const auto way = surface_walk(mesh, from, to);
    expect_valid(mesh, way, from, to);
    const Vec3 a = position_of(mesh, from);
    const Vec3 b = position_of(mesh, to);
    EXPECT_NEAR(test::length_of(mesh, way), (b - a).norm(), 1e-10);
    for (const SurfacePoint& p : way) EXPECT_NEAR((position_of(mesh, p) - a).cross(b - a).norm(), 0, 1e-9);
    if (HasFailure()) return;
  }
}

TEST(SurfaceWalk, RunsAlongEdgesAndThroughVertices) {
  const TriangleMesh mesh = test::planar_grid(4, 4, 4, 4);
  // Along a grid line: from a vertex through three vertices to a vertex.
  const auto along = surface_walk(mesh, point_at_vertex(mesh, 5), point_at_vertex(mesh, 9));
  ASSERT_EQ(along.size(), 5u);
  // Along the diagonals of the squares.
  const auto diagonal = surface_walk(mesh, point_at_vertex(mesh, 0), point_at_vertex(mesh, 24));
  ASSERT_EQ(diagonal.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(support_of(mesh, along[i]).kind, Support::Kind::vertex);
    EXPECT_EQ(support_of(mesh, along[i]).index, 5 + i);
    EXPECT_EQ(support_of(mesh, diagonal[i]).kind, Support::Kind::vertex);
    EXPECT_EQ(support_of(mesh, diagonal[i]).index, 6 * i);
  }
}

TEST(SurfaceWalk, HitsVerticesExactlyInSpiteOfRounding) {
  const TriangleMesh flat = test::planar_grid(30, 30, 30, 30);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> part(-1, 1);
    const Vec3 axis = Vec3(part(random), part(random), part(random)).normalized();
    TriangleSoup soup = flat.soup();
    const Eigen::AngleAxisd turn(3 * part(random), axis);
    for (Vec3& p : soup.positions) p = turn * p;
    const TriangleMesh mesh(std::move(soup));
    const auto way = surface_walk(mesh, point_at_vertex(mesh, 0), point_at_vertex(mesh, 31 * 31 - 1));
    ASSERT_EQ(way.size(), 31u) << "seed " << seed;
    for (const SurfacePoint& p : way) EXPECT_EQ(support_of(mesh, p).kind, Support::Kind::vertex) << "seed " << seed;
  }
}

TEST(SurfaceWalk, OnACylinderItLiesInThePlaneOfBothPointsAndTheirMeanNormal) {
  const TriangleMesh mesh = test::open_cylinder(90, 20, 10, 30);
  const SurfaceLocator locator(mesh);
  for (const double angle : {0.2, 0.5, 1.0}) {
    const auto at = [&](double phi, double z) { return Vec3(10 * std::cos(phi), 10 * std::sin(phi), z); };
    const SurfacePoint from = locator.nearest(at(0.3, 4.1)).at;
    const SurfacePoint to = locator.nearest(at(0.3 + angle, 22.7)).at;
    const auto way = surface_walk(mesh, from, to);
    expect_valid(mesh, way, from, to);
    const double helix = std::hypot(10 * angle, 22.7 - 4.1);
    EXPECT_NEAR(test::length_of(mesh, way), helix, 0.01 * helix);
    const Vec3 a = position_of(mesh, from);
    const Vec3 middle_normal(std::cos(0.3 + angle / 2), std::sin(0.3 + angle / 2), 0);
    const Vec3 plane = (position_of(mesh, to) - a).cross(middle_normal).normalized();
    for (const SurfacePoint& p : way) EXPECT_NEAR(plane.dot(position_of(mesh, p) - a), 0, 0.4);
  }
}

TEST(SurfaceWalk, NearbyPairsOnABumpySurfaceAreJoined) {
  const TriangleMesh mesh =
      test::height_grid(60, 60, 10, 10, [](double x, double y) { return 0.5 * std::sin(2 * x) * std::cos(1.7 * y); });
  const SurfaceLocator locator(mesh);
  int joined = 0;
  constexpr int pairs = 4000;
  for (std::uint64_t seed = 1; seed <= pairs; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    const SurfacePoint from = random_point(mesh, random);
    std::uniform_real_distribution<double> step(-0.6, 0.6);
    const Vec3 moved = position_of(mesh, from) + Vec3(step(random), step(random), step(random));
    const SurfacePoint to = seed % 2 ? locator.nearest(moved).at : random_point(mesh, random);
    const auto way = surface_walk(mesh, from, to);
    if (way.empty()) continue;
    ++joined;
    expect_valid(mesh, way, from, to);
    if (HasFailure()) return;
  }
  EXPECT_GT(joined, 0.98 * pairs);
}

TEST(SurfaceWalk, SliversAndPointsWithoutAreaDoNotHoldItUp) {
  // Columns of very different widths, the narrow ones 1e-9 wide.
  TriangleMesh mesh = test::height_grid(40, 8, 40, 8, [](double x, double) { return 0.05 * x; });
  TriangleSoup soup = mesh.soup();
  for (Vec3& p : soup.positions) p.x() = std::floor(p.x() / 4) * 4 + 1e-9 * std::fmod(p.x(), 4);
  for (Vec3& p : soup.positions) p.z() = 0.05 * p.x();
  mesh = TriangleMesh(std::move(soup));
  int joined = 0;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    const SurfacePoint from = random_point(mesh, random);
    const SurfacePoint to = random_point(mesh, random);
    const auto way = surface_walk(mesh, from, to);
    if (way.empty()) continue;
    ++joined;
    expect_valid(mesh, way, from, to);
    if (HasFailure()) return;
  }
  EXPECT_GT(joined, 1900);
}

TEST(SurfaceWalk, GivesUpWhereThereIsNoWay) {
  // Two sheets one above the other, not joined.
  TriangleSoup soup = test::planar_grid(3, 3, 3, 3).soup();
  const TriangleSoup lower = soup;
  const auto n = static_cast<Index>(soup.positions.size());
  for (const Vec3& p : lower.positions) soup.positions.push_back(p + Vec3(0.1, 0.2, 1));
  for (const auto& [a, b, c] : lower.triangles) soup.triangles.push_back({a + n, b + n, c + n});
  const TriangleMesh mesh(std::move(soup));
  EXPECT_TRUE(surface_walk(mesh, {0, Vec3(0.2, 0.3, 0.5)}, {25, Vec3(0.2, 0.3, 0.5)}).empty());
  EXPECT_TRUE(surface_walk(mesh, {0, Vec3(0.2, 0.3, 0.5)}, {18, Vec3(0.2, 0.3, 0.5)}).empty());
}

TEST(SurfaceWalk, PointsOfOneFaceAreJoinedDirectly) {
  const TriangleMesh mesh = test::planar_grid(2, 2, 2, 2);
  const SurfacePoint vertex = point_at_vertex(mesh, 4);
  const auto way = surface_walk(mesh, vertex, {0, Vec3(0.2, 0.3, 0.5)});
  EXPECT_EQ(way.size(), 2u);
  EXPECT_EQ(common_face(mesh, vertex, {0, Vec3(0.2, 0.3, 0.5)}), 0);
  EXPECT_EQ(common_face(mesh, point_at_vertex(mesh, 0), point_at_vertex(mesh, 8)), no_index);
}

}  // namespace
}  // namespace isopath
