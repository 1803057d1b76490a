#include "isopath/core/angle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace isopath {
namespace {

TEST(AngleBetween, KeepsItsDigitsNextToZeroAndToPi) {
  const Vec3 a(1, 2, 2);
  const Vec3 across = Vec3(2, 1, -2);  // at a right angle to a, and as long
  for (double angle = 1e-12; angle < 1.5; angle *= 3) {
    const Vec3 turned = std::cos(angle) * a + std::sin(angle) * across;
    EXPECT_NEAR(angle_between(a, turned), angle, 1e-15);
    EXPECT_NEAR(angle_between(a, -turned), std::numbers::pi - angle, 1e-15);
    EXPECT_NEAR(angle_between(1e-9 * a, 1e9 * turned), angle, 1e-15);
  }
  EXPECT_EQ(angle_between(a, a), 0);
  EXPECT_EQ(angle_between(a, -a), std::numbers::pi);
  EXPECT_EQ(angle_between(a, Vec3::Zero()), 0);
}

}  // namespace
}  // namespace isopath
