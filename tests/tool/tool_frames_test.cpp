#include "isopath/tool/tool_frames.h"

#include <gtest/gtest.h>

namespace isopath {
namespace {

ToolPath through(std::initializer_list<Vec3> tips) {
  ToolPath path;
  for (const Vec3& tip : tips) {
    ToolPoint point;
    point.tip = tip;
    point.tangent = Vec3::Zero();
    path.points.push_back(point);
  }
  set_tangents(path);
  return path;
}

void expect_tangents(const ToolPath& path, std::initializer_list<Vec3> tangents) {
  ASSERT_EQ(path.points.size(), tangents.size());
  std::size_t i = 0;
  for (const Vec3& tangent : tangents) {
    EXPECT_LT((path.points[i].tangent - tangent.normalized()).norm(), 1e-12)
        << "point " << i << ": " << path.points[i].tangent.transpose();
    ++i;
  }
}

TEST(ToolFrames, ACornerTakesTheBisector) {
  expect_tangents(through({{0, 0, 0}, {5, 0, 0}, {5, 1, 0}}), {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
}

TEST(ToolFrames, AReversalTakesTheNewDirection) {
  expect_tangents(through({{0, 0, 0}, {5, 0, 0}, {1, 0, 0}}), {{1, 0, 0}, {-1, 0, 0}, {-1, 0, 0}});
}

TEST(ToolFrames, CoincidentPointsTakePartInTheirNeighboursDirection) {
  expect_tangents(through({{0, 0, 0}, {0, 0, 0}, {5, 0, 0}, {5, 0, 0}, {5, 0, 0}, {5, 4, 0}, {5, 4, 0}}),
                  {{1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 0}, {1, 1, 0}, {0, 1, 0}, {0, 1, 0}});
}

TEST(ToolFrames, AMoveAlongTheAxisKeepsTheTangent) {
  expect_tangents(through({{0, 0, 9}, {0, 0, 5}, {0, 0, 0}, {0, 3, 0}, {0, 3, 4}, {0, 3, 8}}),
                  {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}});
}

TEST(ToolFrames, OnePointAndAPurePlungeHaveAPerpendicularTangent) {
  for (const ToolPath& path : {through({{1, 2, 3}}), through({{0, 0, 9}, {0, 0, 0}})}) {
    for (const ToolPoint& point : path.points) {
      EXPECT_NEAR(point.tangent.norm(), 1, 1e-15);
      EXPECT_NEAR(point.tangent.dot(point.axis), 0, 1e-15);
    }
  }
}

TEST(ToolFrames, OrientationTurnsTheToolOntoTangentAndAxis) {
  ToolPoint point;
  point.axis = Vec3(1, 2, 2) / 3;
  point.tangent = Vec3(2, 1, -2) / 3;
  const Eigen::Quaterniond q = orientation_of(point);
  EXPECT_LT((q * Vec3::UnitX() - point.tangent).norm(), 1e-14);
  EXPECT_LT((q * Vec3::UnitZ() - point.axis).norm(), 1e-14);
  EXPECT_LT((q * Vec3::UnitY() - point.axis.cross(point.tangent)).norm(), 1e-14);
}

}  // namespace
}  // namespace isopath
