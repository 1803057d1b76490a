#include "isopath/mesh/straight_walk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/mesh/surface_walk.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

/// A direction in a point's face, at an angle from its first edge.
Vec3 direction_at(const TriangleMesh& mesh, const SurfacePoint& point, double angle) {
  const Vec3 along = (mesh.position(mesh.to(3 * point.face)) - mesh.position(mesh.from(3 * point.face))).normalized();
  return std::cos(angle) * along + std::sin(angle) * mesh.face_normal(point.face).cross(along);
}

/// What a walk promises whatever the surface.
void expect_walk(const TriangleMesh& mesh, const StraightWalk& walk, double longest) {
  EXPECT_NEAR(test::length_of(mesh, walk.points), walk.length, 1e-9 * (mesh.size() + longest));
  if (walk.at_boundary) {
    EXPECT_LE(walk.length, longest);
    const Support end = support_of(mesh, walk.points.back());
    ASSERT_NE(end.kind, Support::Kind::face);
    EXPECT_TRUE(end.kind == Support::Kind::vertex ? mesh.is_boundary_vertex(end.index)
                                                  : mesh.is_boundary_edge(mesh.edge_of(end.index)));
  } else {
    EXPECT_DOUBLE_EQ(walk.length, longest);
  }
  for (std::size_t i = 1; i < walk.points.size(); ++i) {
    EXPECT_NE(common_face(mesh, walk.points[i - 1], walk.points[i]), no_index) << i;
    if (i + 1 == walk.points.size()) break;
    EXPECT_NE(support_of(mesh, walk.points[i]).kind, Support::Kind::face);
  }
}

TEST(StraightWalk, OnAPlaneItIsStraight) {
  const TriangleMesh mesh = test::planar_grid(9, 7, 9, 7, {.jitter = 0.2});
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    const SurfacePoint from = test::random_supported_point(rng, mesh);
    const double angle = test::random_real(rng, 0, 2 * std::numbers::pi);
    const double turn = test::random_real(rng, -9, 9);
    const double longest = test::random_real(rng, 0.1, 12);
    const StraightWalk walk = straight_walk(mesh, from, Vec3(std::cos(angle), std::sin(angle), 0), turn, longest);
    expect_walk(mesh, walk, longest);
    const Vec3 along(std::cos(angle + turn), std::sin(angle + turn), 0);
    const Vec3 start = position_of(mesh, from);
    EXPECT_NEAR((position_of(mesh, walk.points.back()) - start - walk.length * along).norm(), 0, 1e-11);
    if (!walk.at_boundary) continue;
    // Nothing of the way on lies in the rectangle.
    const Vec3 beyond = position_of(mesh, walk.points.back()) + 1e-6 * along;
    EXPECT_TRUE(beyond.x() < 0 || beyond.x() > 9 || beyond.y() < 0 || beyond.y() > 7) << beyond.transpose();
  }
}

/// A line's points in the development of a surface whose triangles all touch, or are parallel to, an axis.
void expect_straight(const std::vector<Vec2>& developed, double tolerance) {
  const Vec2 way = developed.back() - developed.front();
  for (const Vec2& p : developed) EXPECT_NEAR(cross(way.normalized(), p - developed.front()), 0, tolerance);
}

TEST(StraightWalk, OnACylinderItIsStraightInTheDevelopment) {
  const int sides = 17;
  const TriangleMesh mesh = test::open_cylinder(sides, 6, 2, 9);
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    const SurfacePoint from = test::random_supported_point(rng, mesh);
    const StraightWalk walk =
        straight_walk(mesh, from, direction_at(mesh, from, test::random_real(rng, 0, 6.3)), 0.3, 40);
    expect_walk(mesh, walk, 40);
    // A step is flat: its width in the development is what its height leaves of its length, to the left or the right.
    std::vector<Vec2> developed = {Vec2::Zero()};
    for (std::size_t i = 1; i < walk.points.size(); ++i) {
      const Vec3 a = position_of(mesh, walk.points[i - 1]);
      const Vec3 step = position_of(mesh, walk.points[i]) - a;
      const double around = std::copysign(std::hypot(step.x(), step.y()), a.x() * step.y() - a.y() * step.x());
      developed.push_back(developed.back() + Vec2(around, step.z()));
    }
    if (walk.length > 0) expect_straight(developed, 1e-10);
  }
}

TEST(StraightWalk, OnAConeItIsStraightInTheDevelopment) {
  const TriangleMesh mesh = test::open_cone(13, 4, 2, 5);
  const Vec3 apex = mesh.position(0);
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    const SurfacePoint from = test::random_surface_point(rng, mesh);
    const StraightWalk walk =
        straight_walk(mesh, from, direction_at(mesh, from, test::random_real(rng, 0, 6.3)), 0, 20);
    expect_walk(mesh, walk, 20);
    double turned = 0;
    std::vector<Vec2> developed;
    for (std::size_t i = 0; i < walk.points.size(); ++i) {
      const Vec3 p = position_of(mesh, walk.points[i]) - apex;
      if (i > 0) {
        const Vec3 q = position_of(mesh, walk.points[i - 1]) - apex;
        const double side = q.x() * p.y() - q.y() * p.x();
        turned += std::copysign(std::atan2(q.cross(p).norm(), q.dot(p)), side);
      }
      developed.emplace_back(p.norm() * std::cos(turned), p.norm() * std::sin(turned));
    }
    expect_straight(developed, 1e-9);
  }
}

TEST(StraightWalk, ThroughAVertexBothAnglesAreEqual) {
  // Straight at the tip of a cone, along the middle of one of an odd number of sides: it comes out along an edge.
  const int n = 7;
  const TriangleMesh mesh = test::open_cone(n, 1, 2, 5);
  for (int i = 0; i < n; ++i) {
    const Vec3 middle = (mesh.position(1 + i) + mesh.position(1 + (i + 1) % n)) / 2;
    for (Index f = 0; f < mesh.n_faces(); ++f) {
      const Vec3 centre = (mesh.position(mesh.triangle(f)[0]) + mesh.position(mesh.triangle(f)[1]) +
                           mesh.position(mesh.triangle(f)[2])) /
                          3;
      const Vec3 up = mesh.position(0) - middle;
      if (up.cross(centre - middle).norm() > 1e-9 * up.squaredNorm()) continue;
      const StraightWalk walk = straight_walk(mesh, {f, Vec3::Constant(1.0 / 3)}, up, 0, 20);
      expect_walk(mesh, walk, 20);
      ASSERT_EQ(walk.points.size(), 3u);
      EXPECT_EQ(support_of(mesh, walk.points[1]).index, 0);
      EXPECT_NEAR((position_of(mesh, walk.points[2]) - mesh.position(1 + (i + (n + 1) / 2) % n)).norm(), 0, 1e-9);
    }
  }
}

TEST(StraightWalk, TheWayBackLeadsToTheStart) {
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    const TriangleMesh mesh =
        test::random_mesh(rng, {.max_faces = 60, .closed = seed % 2 == 0, .holes = seed % 3 == 0});
    const SurfacePoint from = test::random_surface_point(rng, mesh);
    const double longest = test::random_real(rng, 0.05, 1) * mesh.size();
    const StraightWalk walk =
        straight_walk(mesh, from, direction_at(mesh, from, test::random_real(rng, 0, 6.3)), 0, longest);
    expect_walk(mesh, walk, longest);
    const std::size_t n = walk.points.size();
    if (walk.at_boundary || n < 2) continue;
    const SurfacePoint& end = walk.points.back();
    const Index face = common_face(mesh, walk.points[n - 2], end);
    const Vec3 back_there = position_of(mesh, walk.points[n - 2]) - position_of(mesh, end);
    const StraightWalk back = straight_walk(mesh, express_in(mesh, end, face), back_there, 0, walk.length);
    EXPECT_NEAR((position_of(mesh, back.points.back()) - position_of(mesh, from)).norm(), 0, 1e-7 * mesh.size());
  }
}

TEST(StraightWalk, GoesOnFromAPolyline) {
  const TriangleMesh mesh = test::planar_grid(5, 5, 5, 5);
  const StraightWalk first = straight_walk(mesh, point_at_vertex(mesh, 7), Vec3(2, 1, 0), 0, 1.7);
  const StraightWalk more = straight_on(mesh, first.points, 0.9);
  EXPECT_NEAR((position_of(mesh, more.points.back()) - mesh.position(7) - 2.6 * Vec3(2, 1, 0).normalized()).norm(), 0,
              1e-12);
  EXPECT_THROW(straight_on(mesh, {first.points[0]}, 1), Error);
  EXPECT_THROW(straight_walk(mesh, first.points[0], Vec3::UnitZ(), 0, 1), Error);
  EXPECT_THROW(straight_walk(mesh, first.points[0], Vec3::UnitX(), 0, 0), Error);
}

}  // namespace
}  // namespace isopath
