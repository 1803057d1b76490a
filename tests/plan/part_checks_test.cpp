#include "isopath/plan/part_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "isopath/core/error.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

TEST(PartChecks, WarnOfSizesThatAnotherUnitWouldExplain) {
  for (const bool has_unit : {false, true}) {
    EXPECT_TRUE(warning_of_size(0.9, has_unit));
    EXPECT_TRUE(warning_of_size(20001, has_unit));
    EXPECT_FALSE(warning_of_size(5, has_unit));
    EXPECT_FALSE(warning_of_size(20000, has_unit));
    EXPECT_EQ(warning_of_size(1.09, has_unit).has_value(), !has_unit);
  }
}

TEST(PartChecks, WarnOfPartsInManyPieces) {
  const auto apart = [](Index pieces, Index triangles_each) {
    TriangleSoup soup;
    for (Index k = 0; k < pieces; ++k) {
      const auto first = static_cast<Index>(soup.positions.size());
      soup.positions.emplace_back(3.0 * k, 0, 0);
      for (Index i = 0; i <= triangles_each; ++i)
        soup.positions.emplace_back(3.0 * k + std::cos(0.1 * i), std::sin(0.1 * i), 0);
      for (Index i = 1; i <= triangles_each; ++i) soup.triangles.push_back({first, first + i, first + i + 1});
    }
    return warning_of_pieces(TriangleMesh(std::move(soup)));
  };
  EXPECT_FALSE(apart(49, 1));
  ASSERT_TRUE(apart(50, 1));
  EXPECT_NE(apart(50, 1)->find("in 50 separate pieces, of 1 triangles"), std::string::npos);
  EXPECT_NE(apart(50, 4)->find("in 50 separate pieces: each"), std::string::npos);
}

TEST(PartChecks, WarnOfToolsLargerThanThePart) {
  const ToolOptions mill{.process = Process::mill, .stand_off = 200, .ball_diameter = 10};
  EXPECT_TRUE(warning_of_tool(mill, 9));
  EXPECT_FALSE(warning_of_tool(mill, 11));
  const ToolOptions spray{.process = Process::spray, .stand_off = 200, .ball_diameter = 10};
  EXPECT_TRUE(warning_of_tool(spray, 19));
  EXPECT_FALSE(warning_of_tool(spray, 21));
}

TEST(PartChecks, NameTheWidestGapAndItsPlace) {
  const TriangleMesh sphere = test::icosphere(0, 10);
  GapReport gap;
  gap.vertex_gap.assign(sphere.n_vertices(), 2.0);
  gap.max = 2.19;
  EXPECT_FALSE(warning_of_gap(sphere, gap, 2));
  gap.max = 2.4;  // between vertices
  EXPECT_EQ(warning_of_gap(sphere, gap, 2).value_or("").find("near"), std::string::npos);
  EXPECT_NE(warning_of_gap(sphere, gap, 2).value_or("").find("1.200"), std::string::npos);
  gap.vertex_gap[3] = 2.4;
  EXPECT_NE(warning_of_gap(sphere, gap, 2).value_or("").find("near"), std::string::npos);
  gap.max = infinity;
  EXPECT_FALSE(warning_of_gap(sphere, gap, 2));
}

/// A path along x over a ridge: flat, then turned by `angle` about y from x = 0 on, points every `step`.
ImpactCurve over_a_ridge(double angle, double step) {
  ImpactCurve curve;
  for (double x = -5; x <= 5; x += step) {
    ImpactPoint point;
    point.kind = MoveKind::cover;
    point.position = Vec3(x, 0, 0);
    point.normal = x < 0 ? Vec3(0, 0, 1) : Vec3(std::sin(angle), 0, std::cos(angle));
    curve.points.push_back(point);
  }
  return curve;
}

TEST(AxisJumps, AreCountedWhereTheNormalTurnsByMoreThanThirtyDegrees) {
  for (const double step : {0.01, 0.3, 2.0}) {
    for (const double degrees : {10.0, 29.0, 31.0, 90.0, 179.0}) {
      const double angle = degrees * std::numbers::pi / 180;
      const AxisJumps jumps = axis_jumps(over_a_ridge(angle, step), 1);
      EXPECT_EQ(jumps.count, degrees > 30 ? 1 : 0) << degrees << " degrees, step " << step;
      if (degrees < 30) continue;
      EXPECT_NEAR(jumps.worst, angle, 1e-9);
      EXPECT_NEAR(jumps.at.x(), 0, std::max(step, 1.0)) << "step " << step;
    }
  }
}

TEST(AxisJumps, AreNotSeenInASlowTurnNorAcrossALift) {
  // a quarter circle of radius 10 turns by 5.7 degrees a millimetre
  ImpactCurve curve;
  for (double t = 0; t < std::numbers::pi / 2; t += 0.01) {
    ImpactPoint point;
    point.kind = MoveKind::cover;
    point.normal = Vec3(std::cos(t), std::sin(t), 0);
    point.position = 10 * point.normal;
    curve.points.push_back(point);
  }
  EXPECT_EQ(axis_jumps(curve, 1).count, 0);
  EXPECT_GT(axis_jumps(curve, 6).count, 0);

  ImpactCurve lifted = over_a_ridge(1.5, 0.1);
  for (ImpactPoint& point : lifted.points) {
    if (std::abs(point.position.x()) < 0.3) point.kind = MoveKind::lift;
  }
  EXPECT_EQ(axis_jumps(lifted, 1).count, 0);
}

/// What check_reach complains about; empty where it does not.
std::string unreachable(const TriangleMesh& mesh, const std::vector<double>& distances, const Job& job) {
  try {
    check_reach(mesh, distances, job);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::no_plan);
    return error.what();
  }
  return "";
}

TEST(CheckReach, RefusesWhatTheSourcesReachAndTheToolDoesNot) {
  const TriangleMesh sphere = test::icosphere(3, 10);
  Job up;
  up.tool = {.axis_mode = AxisMode::fixed_direction, .fixed_axis = {0, 0, 3}};
  std::vector<double> distances(sphere.n_vertices(), 1.0);
  EXPECT_NE(unreachable(sphere, distances, up).find("% of the area"), std::string::npos) << "half of it faces away";
  EXPECT_EQ(unreachable(sphere, distances, {}), "") << "along the normals anything can be reached";
  for (Index v = 0; v < sphere.n_vertices(); ++v) {
    if (sphere.position(v).z() < 0.5) distances[v] = infinity;
  }
  EXPECT_EQ(unreachable(sphere, distances, up), "");
}

TEST(CheckReach, RefusesWhatAProgramCannotHold) {
  const TriangleMesh sphere = test::icosphere(3, 10);
  std::vector<double> distances(sphere.n_vertices(), 1.0);
  const auto complaint = [&](const char* format) {
    Job job;
    job.programs = {format};
    return unreachable(sphere, distances, job);
  };
  EXPECT_NE(complaint("gcode3").find("--axis 0,0,1"), std::string::npos);
  EXPECT_NE(complaint("gcode5").find("farther than the table tilts"), std::string::npos);
  EXPECT_EQ(complaint("yaml"), "");
  for (Index v = 0; v < sphere.n_vertices(); ++v) {
    if (sphere.position(v).z() < 0) distances[v] = infinity;
  }
  EXPECT_EQ(complaint("gcode5"), "") << "the table tilts by 100 degrees one way";
  EXPECT_NE(complaint("gcode3"), "");

  const TriangleMesh table = test::planar_grid(3, 3, 10, 10);
  Job flat;
  flat.programs = {"gcode3"};
  EXPECT_EQ(unreachable(table, std::vector<double>(table.n_vertices(), 0.0), flat), "");
}

}  // namespace
}  // namespace isopath
