#include "isopath/impact/lift.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

/// Checks what a clear lift promises: no leg meets the surface, the length is that of the legs.
void expect_clear(const SurfaceLocator& surface, const LiftPath& path, const Vec3& p, const Vec3& np, const Vec3& q,
                  const Vec3& nq, double clearance) {
  ASSERT_TRUE(path.clear);
  ASSERT_FALSE(path.way_points.empty());
  std::vector<Vec3> legs = path.way_points;
  legs.insert(legs.begin(), p);
  legs.push_back(q);
  double length = 0;
  for (std::size_t i = 1; i < legs.size(); ++i) length += (legs[i] - legs[i - 1]).norm();
  EXPECT_NEAR(path.length, length, 1e-12 * length);
  legs.front() += 2e-3 * clearance * np;
  legs.back() += 2e-3 * clearance * nq;
  for (std::size_t i = 1; i < legs.size(); ++i) EXPECT_FALSE(surface.intersects(legs[i - 1], legs[i])) << "leg " << i;
}

/// A plate [0, 20] × [0, 10] with a wall of the given height between x = 9.5 and x = 10.5.
TriangleMesh plate_with_wall(double height) {
  return test::height_grid(40, 4, 20, 10, [=](double x, double) { return std::abs(x - 10) < 0.3 ? height : 0.0; });
}

TEST(Lift, OverFlatGroundItRetractsHopsAndComesDown) {
  const TriangleMesh mesh = test::planar_grid(4, 4, 20, 20);
  const LiftPath path =
      lift_between(SurfaceLocator(mesh), mesh.bounds(), {2, 2, 0}, Vec3::UnitZ(), {12, 2, 0}, Vec3::UnitZ(), 3);
  EXPECT_TRUE(path.clear);
  ASSERT_EQ(path.way_points.size(), 2u);
  EXPECT_EQ(path.way_points[0], Vec3(2, 2, 3));
  EXPECT_EQ(path.way_points[1], Vec3(12, 2, 3));
  EXPECT_DOUBLE_EQ(path.length, 16);
}

TEST(Lift, ClimbsOverAWall) {
  const Vec3 p(3, 5, 0);
  const Vec3 q(17, 5, 0);
  for (const double height : {0.5, 1.5, 5.0, 50.0}) {
    const TriangleMesh mesh = plate_with_wall(height);
    const SurfaceLocator surface(mesh);
    const LiftPath path = lift_between(surface, mesh.bounds(), p, Vec3::UnitZ(), q, Vec3::UnitZ(), 1);
    expect_clear(surface, path, p, Vec3::UnitZ(), q, Vec3::UnitZ(), 1);
    double highest = 0;
    for (const Vec3& w : path.way_points) highest = std::max(highest, w.z());
    EXPECT_GT(highest, height);
    // The least of 1, 2, 4, 8 that clears the wall at its foot is enough, unless the wall is higher than all.
    EXPECT_EQ(path.way_points.size() == 2, height < 8);
  }
}

TEST(Lift, GoesAroundASphere) {
  const TriangleMesh mesh = test::icosphere(4, 10);
  const SurfaceLocator surface(mesh);
  for (const Vec3& direction : {Vec3(0, 0, 1), Vec3(1, 2, 3), Vec3(-1, 0.1, 0)}) {
    for (const Vec3& offset : {Vec3(0, 0, 0), Vec3(0.4, 0.2, -0.1)}) {
      const Vec3 np = direction.normalized();
      const Vec3 nq = (-np + offset).normalized();
      const LiftPath path = lift_between(surface, mesh.bounds(), 10 * np, np, 10 * nq, nq, 0.5);
      expect_clear(surface, path, 10 * np, np, 10 * nq, nq, 0.5);
      for (const Vec3& w : path.way_points) EXPECT_GT(w.norm(), 10.4);
      for (std::size_t i = 1; i < path.way_points.size(); ++i) {
        const Vec3 middle = 0.5 * (path.way_points[i] + path.way_points[i - 1]);
        EXPECT_GE(middle.norm(), 10.5);
      }
    }
  }
}

TEST(Lift, FindsTheOpeningOfAPocket) {
  // A box turned inside out, without its lid: x, y in [-5, 5], floor at z = -10; q outside beside it, below the rim.
  TriangleSoup soup = test::box({-5, -5, -10}, {5, 5, 0}).soup();
  std::erase_if(soup.triangles, [&](const Triangle& t) {
    return soup.positions[t[0]].z() == 0 && soup.positions[t[1]].z() == 0 && soup.positions[t[2]].z() == 0;
  });
  for (Triangle& t : soup.triangles) std::swap(t[1], t[2]);
  const TriangleMesh mesh(std::move(soup));
  const SurfaceLocator surface(mesh);
  // From a wall the normal leads straight into the opposite wall.
  const Vec3 p(-5, 1, -7);
  const Vec3 q(5, 0.5, -3);
  const Vec3 outside(6, 0.3, -4);
  const LiftPath across = lift_between(surface, mesh.bounds(), p, Vec3::UnitX(), q, -Vec3::UnitX(), 1);
  expect_clear(surface, across, p, Vec3::UnitX(), q, -Vec3::UnitX(), 1);
  EXPECT_EQ(across.way_points.size(), 2u);
  const LiftPath out = lift_between(surface, mesh.bounds(), p, Vec3::UnitX(), outside, Vec3::UnitX(), 1);
  expect_clear(surface, out, p, Vec3::UnitX(), outside, Vec3::UnitX(), 1);
  EXPECT_GT(out.way_points.size(), 2u);
}

TEST(Lift, SaysWhenNoClearWayIsKnown) {
  const TriangleMesh mesh = test::icosphere(3, 10);
  const LiftPath path =
      lift_between(SurfaceLocator(mesh), mesh.bounds(), {0, 0, 0}, Vec3::UnitZ(), {0, 0, 20}, Vec3::UnitZ(), 1);
  EXPECT_FALSE(path.clear);
  EXPECT_FALSE(path.way_points.empty());
}

TEST(Lift, RefusesAClearanceThatIsNone) {
  const TriangleMesh mesh = test::planar_grid(1, 1, 1, 1);
  const SurfaceLocator surface(mesh);
  for (const double clearance : {0.0, -1.0, std::nan(""), infinity}) {
    EXPECT_THROW(lift_between(surface, mesh.bounds(), {0, 0, 0}, Vec3::UnitZ(), {1, 1, 0}, Vec3::UnitZ(), clearance),
                 Error);
  }
}

}  // namespace
}  // namespace isopath
