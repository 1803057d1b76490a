#include "isopath/post/rotary_axes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "isopath/core/error.h"
#include "post/test_paths.h"

namespace isopath {
namespace {

constexpr double radians = std::numbers::pi / 180;

// The table turns the part so that the tool axis, fixed in the part, stands along the machine's +Z: first C about the
// part's z, then A about x. LinuxCNC's default directions are those of the tool's motion relative to the part, so that
// part to machine is Rx(A) Rz(C) with both angles as programmed.
Vec3 turned_by_the_table(const Vec3& axis, const RotaryAngles& angles) {
  const Eigen::AngleAxisd c(angles.c * radians, Vec3::UnitZ());
  const Eigen::AngleAxisd a(angles.a * radians, Vec3::UnitX());
  return a * (c * axis);
}

ToolPath with_axes(const std::vector<Vec3>& axes, MoveKind kind = MoveKind::cover) {
  ToolPath path;
  for (const Vec3& axis : axes) {
    ToolPoint point;
    point.axis = axis.normalized();
    point.kind = kind;
    path.points.push_back(point);
  }
  return path;
}

TEST(RotaryAxes, TheTableStandsEveryAxisUpright) {
  for (const ImpactCurve& curve : {test::cylinder_helix(), test::sphere_spiral(), test::wavy_zigzag()}) {
    const ToolPath path = test::full_path(curve);
    const std::vector<RotaryAngles> angles = rotary_angles(path, {});
    ASSERT_EQ(angles.size(), path.points.size());
    for (std::size_t i = 0; i < angles.size(); ++i) {
      EXPECT_LT((turned_by_the_table(path.points[i].axis, angles[i]) - Vec3::UnitZ()).norm(), 2e-9) << i;
      EXPECT_LT((axis_of(angles[i]) - path.points[i].axis).norm(), 2e-9) << i;
      EXPECT_GE(angles[i].a, -100);
      EXPECT_LE(angles[i].a, 50);
    }
  }
}

TEST(RotaryAxes, CTurnsOnWithoutAJump) {
  const std::vector<RotaryAngles> angles = rotary_angles(test::full_path(test::sphere_spiral()), {});
  for (std::size_t i = 1; i < angles.size(); ++i) {
    EXPECT_LT(std::abs(angles[i].c - angles[i - 1].c), 0.05 / radians + 1e-6) << i;
  }
  EXPECT_NEAR(std::abs(angles.back().c - angles.front().c), 1999 * 0.05 / radians, 1e-6);
  EXPECT_EQ(angles[0].a, 0);
}

TEST(RotaryAxes, CrossingThePoleTiltsToTheOtherSideInsteadOfTurning) {
  std::vector<Vec3> axes;
  for (int i = -20; i <= 20; ++i) axes.emplace_back(0, std::sin(i * 0.04), std::cos(i * 0.04));  // 46 degrees each way
  for (const RotaryAngles& angles : rotary_angles(with_axes(axes), {})) {
    EXPECT_NEAR(angles.c, rotary_angles(with_axes(axes), {}).front().c, 1e-6);
  }
}

TEST(RotaryAxes, WhereOneSideIsOutOfReachTheTableTurnsInTheAir) {
  // From 60 degrees on one side to 60 on the other: A = +60 is out of reach, so C must turn half round somewhere.
  std::vector<Vec3> axes;
  for (int i = -60; i <= 60; i += 5) axes.emplace_back(0, std::sin(i * radians), std::cos(i * radians));
  ToolPath path = with_axes(axes);
  for (std::size_t i = 14; i <= 16; ++i) path.points[i].kind = MoveKind::lift;
  const std::vector<RotaryAngles> angles = rotary_angles(path, {});
  for (std::size_t i = 1; i < angles.size(); ++i) {
    if (std::abs(angles[i].c - angles[i - 1].c) > 1) {
      EXPECT_EQ(path.points[i].kind, MoveKind::lift) << i;
    }
  }
  EXPECT_NEAR(std::abs(angles.back().c - angles.front().c), 180, 1e-6);
}

TEST(RotaryAxes, AtThePoleCStaysOrWaitsWhereItIsNeeded) {
  const Vec3 up = Vec3::UnitZ();
  const Vec3 tilted(0.5, 0.3, 1);
  const std::vector<RotaryAngles> angles = rotary_angles(with_axes({up, up, tilted, up, up}), {});
  for (const RotaryAngles& a : angles) EXPECT_NEAR(a.c, angles[2].c, 1e-9);
  for (const RotaryAngles& a : rotary_angles(with_axes({up, up}), {})) {
    EXPECT_EQ(a.a, 0);
    EXPECT_EQ(a.c, 0);
  }
}

TEST(RotaryAxes, RefusesWhatTheTableCannotReach) {
  EXPECT_TRUE(rotary_angles({}, {}).empty());
  try {
    rotary_angles(with_axes({Vec3::UnitZ(), Vec3(1, 0, -1)}), {});
    FAIL() << "accepted an axis 135 degrees from +Z";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::no_plan);
    EXPECT_EQ(error.where().element, "tool path point 1");
    EXPECT_NE(error.where().value.find("135.00"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace isopath
