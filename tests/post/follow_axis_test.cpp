#include "isopath/post/follow_axis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "isopath/tool/thin_path.h"
#include "post/test_paths.h"

namespace isopath {
namespace {

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// The largest angle between the axis that A and C, moved evenly, give and the great circle of the path, on a fine
// scale.
double swing(const ToolPath& path) {
  const std::vector<RotaryAngles> angles = rotary_angles(path, {});
  double worst = 0;
  for (std::size_t i = 1; i < angles.size(); ++i) {
    if (path.points[i].kind == MoveKind::lift) continue;
    for (int k = 0; k <= 100; ++k) {
      const double u = k / 100.0;
      const RotaryAngles at = {angles[i - 1].a + u * (angles[i].a - angles[i - 1].a),
                               angles[i - 1].c + u * (angles[i].c - angles[i - 1].c)};
      worst =
          std::max(worst, angle_between(axis_of(at), axis_between(path.points[i - 1].axis, path.points[i].axis, u)));
    }
  }
  return worst;
}

TEST(FollowAxis, TheAxisStaysWithinTheToleranceBetweenPoints) {
  for (const ImpactCurve& curve : {test::near_pole(), test::wavy_zigzag(), test::sphere_spiral()}) {
    const ToolPath path = test::full_path(curve);
    for (const double tolerance : {0.05, 0.01, 0.001}) {
      // The seven places that are looked at miss the worst one by little.
      EXPECT_LT(swing(follow_axis(path, {}, tolerance)), tolerance * 1.2);
    }
  }
  EXPECT_GT(swing(test::full_path(test::near_pole())), 0.05);  // or else there was nothing to do
}

TEST(FollowAxis, PutsPointsOnThePathAndDropsNone) {
  const ToolPath path = test::full_path(test::near_pole());
  const ToolPath finer = follow_axis(path, {}, 0.001);
  EXPECT_GT(finer.points.size(), path.points.size());
  std::size_t next = 0;
  for (const ToolPoint& point : finer.points) {
    ASSERT_LT(next, path.points.size());
    if (point.tip == path.points[next].tip) {
      EXPECT_EQ(point.time, path.points[next].time);
      EXPECT_EQ(point.axis, path.points[next].axis);
      ++next;
      continue;
    }
    const ToolPoint& a = path.points[next - 1];
    const ToolPoint& b = path.points[next];
    const double u = (point.tip - a.tip).norm() / (b.tip - a.tip).norm();
    EXPECT_LT((point.tip - a.tip - u * (b.tip - a.tip)).norm(), 1e-12);
    EXPECT_LT(angle_between(point.axis, axis_between(a.axis, b.axis, u)), 1e-12);
    EXPECT_NEAR(point.time, a.time + u * (b.time - a.time), 1e-12);
  }
  EXPECT_EQ(next, path.points.size());
}

TEST(FollowAxis, LeavesAPathAloneWhoseAxisFollowsAlready) {
  const ToolPath path = test::full_path(test::cylinder_helix());
  EXPECT_EQ(follow_axis(path, {}, 0.01).points.size(), path.points.size());
  EXPECT_TRUE(follow_axis({}, {}, 0.01).points.empty());
}

}  // namespace
}  // namespace isopath
