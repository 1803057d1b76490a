#include "isopath/tool/gouge.h"

#include <gtest/gtest.h>

#include <cmath>

#include "isopath/core/error.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

/// A floor z = 0 and a wall x = 0 that meet at a right angle, 40 mm long and 20 mm wide each.
TriangleMesh floor_and_wall() {
  TriangleSoup soup;
  soup.positions = {{20, 0, 0}, {20, 40, 0}, {0, 40, 0}, {0, 0, 0}, {0, 40, 20}, {0, 0, 20}};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}, {3, 2, 4}, {3, 4, 5}};
  return TriangleMesh(std::move(soup));
}

/// Ball points on the floor, `x` from the wall, from y = 5 to y = 35, in two moves.
ToolPath along_the_wall(double x, MoveKind second) {
  ToolPath path;
  for (const double y : {5, 20, 35}) path.points.push_back({.kind = MoveKind::cover, .tip = Vec3(x, y, 0)});
  path.points.back().kind = second;
  return path;
}

TEST(Gouge, IsTheDepthThatAWallReachesIntoTheBall) {
  const TriangleMesh mesh = floor_and_wall();
  for (const double x : {0.5, 2.0, 3.9}) {
    const GougeReport report = measure_gouges(mesh, along_the_wall(x, MoveKind::link), 4, 0.01);
    EXPECT_NEAR(report.deepest, 4 - x, 1e-12);
    EXPECT_NEAR(report.place.x(), 0, 1e-12);
    EXPECT_NEAR(report.place.z(), 4, 1e-12);
    EXPECT_NEAR(report.share, 1, 1e-12);
  }
  EXPECT_EQ(measure_gouges(mesh, along_the_wall(4, MoveKind::link), 4, 0.01).deepest, 0);
  EXPECT_EQ(measure_gouges(mesh, along_the_wall(12, MoveKind::link), 4, 0.01).share, 0);
}

TEST(Gouge, CountsTheLengthOfMovesThatTouch) {
  const TriangleMesh mesh = floor_and_wall();
  ToolPath path = along_the_wall(2, MoveKind::lift);
  EXPECT_NEAR(measure_gouges(mesh, path, 4, 0.01).share, 1, 1e-12) << "the lift counts for nothing";
  path.points.push_back({.kind = MoveKind::cover, .tip = Vec3(8, 5, 0)});  // away from the wall: it gouges until x = 4
  path.points[2] = {.kind = MoveKind::cover, .tip = Vec3(0, 5, 0)};
  path.points.erase(path.points.begin(), path.points.begin() + 2);
  EXPECT_NEAR(measure_gouges(mesh, path, 4, 0.01).share, 0.5, 1e-12);
}

TEST(Gouge, AFacettedBallIsNotGougedFromOutside) {
  const TriangleMesh ball = icosphere(4, 10);
  ToolPath path;
  for (Index v = 0; v < ball.n_vertices(); ++v) {
    const Vec3 normal = ball.position(v).normalized();
    path.points.push_back({.kind = MoveKind::cover, .piece = v, .tip = ball.position(v), .axis = normal});
    path.points.push_back({.kind = MoveKind::cover, .piece = v, .tip = ball.position(v), .axis = normal});
  }
  EXPECT_EQ(measure_gouges(ball, path, 3, 0.03).deepest, 0);
  for (ToolPoint& point : path.points)
    point.axis = -point.axis;  // from inside, a ball of 6 mm fits, one of 14 does not
  EXPECT_EQ(measure_gouges(ball, path, 6, 0.06).deepest, 0);
  EXPECT_NEAR(measure_gouges(ball, path, 14, 0.14).deepest, 2 * (14 - 10), 0.1);
}

TEST(Gouge, TheBallRollsAboutASharpEdge) {
  // A roof with its ridge along y: from one side to the other the axis turns by a right angle, the tip stays.
  TriangleSoup soup;
  soup.positions = {{-20, 0, -20}, {0, 0, 0}, {0, 40, 0}, {-20, 40, -20}, {20, 0, -20}, {20, 40, -20}};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  const TriangleMesh roof(std::move(soup));
  const double r = std::sqrt(0.5);
  ToolPath path;
  path.points = {{.tip = Vec3(0, 20, 0), .axis = Vec3(-r, 0, r)}, {.tip = Vec3(0, 20, 0), .axis = Vec3(r, 0, r)}};
  EXPECT_EQ(measure_gouges(roof, path, 5, 0.01).deepest, 0);
  // With a fixed axis the centre goes straight from one side to the other.
  path.points = {{.tip = Vec3(-5 * r, 20, 5 * r - 5)}, {.tip = Vec3(5 * r, 20, 5 * r - 5)}};
  EXPECT_NEAR(measure_gouges(roof, path, 5, 0.01).deepest, 5 - 5 * r, 0.05);
}

TEST(Gouge, StopsOnRequest) {
  struct Cancelled : Progress {
    bool cancelled() const override { return true; }
  } cancelled;
  EXPECT_THROW(measure_gouges(floor_and_wall(), along_the_wall(2, MoveKind::link), 4, 0.01, cancelled), Error);
}

}  // namespace
}  // namespace isopath::test
