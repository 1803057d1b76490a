#include "isopath/plan/planar_direction.h"

#include <gtest/gtest.h>

#include <random>

#include "support/test_meshes.h"

namespace isopath {
namespace {

/// A plate, turned and moved.
TriangleMesh turned_plate(double width, double height, const Eigen::Matrix3d& turn) {
  TriangleSoup soup = test::planar_grid(7, 5, width, height).soup();
  for (Vec3& p : soup.positions) p = turn * p + Vec3(100, -30, 7);
  return TriangleMesh(std::move(soup));
}

TEST(PlanarDirection, PassesRunAlongTheLongSideHoweverThePartLies) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int trial = 0; trial < 100; ++trial) {
    Eigen::Quaterniond turn(number(random), number(random), number(random), number(random));
    turn.normalize();
    const Vec3 direction = planar_direction_of(turned_plate(30, 10, turn.matrix()));
    EXPECT_NEAR(std::abs(direction.dot(turn * Vec3::UnitY())), 1, 1e-9) << "trial " << trial;
    EXPECT_NEAR(direction.norm(), 1, 1e-12);
  }
}

TEST(PlanarDirection, IsXOrYWhereTheShapeDoesNotTell) {
  const Eigen::Matrix3d flat = Eigen::Matrix3d::Identity();
  EXPECT_NEAR(planar_direction_of(turned_plate(10, 10, flat)).x(), 1, 1e-9);
  Eigen::Matrix3d upright;
  upright << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // a square that stands in the plane x = 0
  EXPECT_NEAR(planar_direction_of(turned_plate(10, 10, upright)).y(), 1, 1e-9);
  EXPECT_NEAR(planar_direction_of(test::icosphere(3, 5)).x(), 1, 1e-9);
}

}  // namespace
}  // namespace isopath
