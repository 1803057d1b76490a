#include "isopath/tool/thin_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace isopath {
namespace {

double distance_to_move(const ToolPoint& p, const ToolPoint& a, const ToolPoint& b, double& u) {
  const Vec3 move = b.tip - a.tip;
  u = move.squaredNorm() > 0 ? std::clamp((p.tip - a.tip).dot(move) / move.squaredNorm(), 0.0, 1.0) : 0;
  return (p.tip - a.tip - u * move).norm();
}

ToolPath wavy(unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> noise(-0.02, 0.02);
  ToolPath path;
  for (int i = 0; i < 600; ++i) {
    const double s = i * 0.1;
    ToolPoint point;
    point.tip = {s, 5 * std::sin(s / 7) + noise(random), noise(random)};
    point.axis = Vec3(0.4 * std::sin(s / 11) + noise(random), 0, 1).normalized();
    point.kind = i % 200 < 150 ? MoveKind::cover : MoveKind::link;
    point.piece = i / 300;
    path.points.push_back(point);
  }
  return path;
}

TEST(ThinPath, EveryDroppedPointIsWithinTheTolerances) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    for (const double chord : {0.01, 0.05, 0.5}) {
      for (const double angle : {0.005, 0.05}) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << " chord " << chord << " angle " << angle);
        const ToolPath path = wavy(seed);
        const ToolPath thin = thin_path(path, chord, angle);
        ASSERT_GE(thin.points.size(), 2U);
        EXPECT_LT(thin.points.size(), path.points.size());
        EXPECT_EQ(thin.points.front().tip, path.points.front().tip);
        EXPECT_EQ(thin.points.back().tip, path.points.back().tip);
        std::size_t k = 0;  // the thinned move that spans point i
        for (const ToolPoint& point : path.points) {
          if (k + 1 < thin.points.size() && point.tip == thin.points[k + 1].tip) ++k;
          if (point.tip == thin.points[k].tip) continue;
          ASSERT_LT(k + 1, thin.points.size());
          double u = 0;
          EXPECT_LE(distance_to_move(point, thin.points[k], thin.points[k + 1], u), chord * (1 + 1e-9));
          const Vec3 axis = axis_between(thin.points[k].axis, thin.points[k + 1].axis, u);
          EXPECT_LE(std::acos(std::min(1.0, axis.dot(point.axis))), angle * (1 + 1e-6));
          EXPECT_EQ(point.kind, thin.points[k + 1].kind);
          EXPECT_EQ(point.piece, thin.points[k + 1].piece);
        }
        EXPECT_EQ(k + 1, thin.points.size());
      }
    }
  }
}

TEST(ThinPath, AStraightMoveWithASteadyAxisKeepsItsEnds) {
  ToolPath path;
  for (int i = 0; i <= 100; ++i) {
    ToolPoint point;
    point.tip = Vec3(3, 4, 12) * i;
    path.points.push_back(point);
  }
  EXPECT_EQ(thin_path(path, 0.01, 0.001).points.size(), 2U);
  EXPECT_EQ(thin_path(path, 0, 0.001).points.size(), 101U);
}

TEST(ThinPath, AClosedCircleStaysACircle) {
  ToolPath path;
  for (int i = 0; i <= 720; ++i) {
    const double angle = i * std::numbers::pi / 360;
    ToolPoint point;
    point.tip = {50 * std::cos(angle), 50 * std::sin(angle), 0};
    path.points.push_back(point);
  }
  const ToolPath thin = thin_path(path, 0.1, 0.01);
  // A chord with sagitta h on radius r spans 2 acos(1 - h/r): at least 360 degrees over that many are needed.
  EXPECT_GE(thin.points.size(), std::size_t(std::numbers::pi / std::acos(1 - 0.1 / 50)));
  EXPECT_LT(thin.points.size(), 200U);
}

TEST(ThinPath, AxisBetweenMovesAtConstantRateOnAGreatCircle) {
  const Vec3 a(1, 0, 0);
  const Vec3 b = Vec3(-1, 1, 0).normalized();  // 135 degrees away
  for (const double u : {0.0, 0.25, 0.5, 1.0}) {
    const Vec3 axis = axis_between(a, b, u);
    EXPECT_NEAR(axis.norm(), 1, 1e-14);
    EXPECT_NEAR(std::atan2(axis.y(), axis.x()), u * 0.75 * std::numbers::pi, 1e-14);
  }
}

}  // namespace
}  // namespace isopath
