#include "isopath/tool/make_tool_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "isopath/core/error.h"

namespace isopath {
namespace {

ImpactPoint on_sphere(double radius, const Vec3& direction, MoveKind kind = MoveKind::cover, Index piece = 0) {
  ImpactPoint point;
  point.kind = kind;
  point.normal = direction.normalized();
  point.position = radius * point.normal;
  point.piece = piece;
  return point;
}

// Seeded points all over the sphere of this radius.
ImpactCurve random_on_sphere(double radius, unsigned seed, bool upper_half = false) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  ImpactCurve curve;
  for (int i = 0; i < 200; ++i) {
    Vec3 d(normal(random), normal(random), normal(random));
    if (upper_half) d.z() = std::abs(d.z());
    curve.points.push_back(on_sphere(radius, d));
  }
  return curve;
}

ToolOptions all_points(Process process, AxisMode mode = AxisMode::surface_normal) {
  ToolOptions options;
  options.process = process;
  options.axis_mode = mode;
  options.chord_tolerance = 0;
  return options;
}

TEST(MakeToolPath, DocumentedDefaults) {
  const ToolOptions options;
  EXPECT_EQ(options.process, Process::mill);
  EXPECT_EQ(options.stand_off, 150);
  EXPECT_EQ(options.ball_diameter, 10);
  EXPECT_EQ(options.axis_mode, AxisMode::surface_normal);
  EXPECT_EQ(options.fixed_axis, Vec3::UnitZ());
  EXPECT_EQ(options.chord_tolerance, 0.01);
}

TEST(MakeToolPath, BallAlongTheNormalTouchesWithItsTip) {
  const ImpactCurve curve = random_on_sphere(40, 1);
  const ToolPath path = make_tool_path(curve, all_points(Process::mill));
  ASSERT_EQ(path.points.size(), curve.points.size());
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    EXPECT_LT((path.points[i].tip - curve.points[i].position).norm(), 1e-12) << i;
    EXPECT_EQ(path.points[i].axis, curve.points[i].normal) << i;
  }
}

TEST(MakeToolPath, BallCentreStaysOnTheOffsetSphere) {
  for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0, 0, 7), Vec3(1, 2, 3)}) {
    ImpactCurve curve = random_on_sphere(40, 2);
    std::erase_if(curve.points, [&](const ImpactPoint& p) { return p.normal.dot(axis) < 0; });
    ToolOptions options = all_points(Process::grind, AxisMode::fixed_direction);
    options.ball_diameter = 12;
    options.fixed_axis = axis;
    for (const ToolPoint& point : make_tool_path(curve, options).points) {
      EXPECT_NEAR(point.axis.norm(), 1, 1e-15);
      EXPECT_NEAR((point.tip + point.axis * 6).norm(), 40 + 6, 1e-12);
    }
  }
}

TEST(MakeToolPath, SprayKeepsItsStandOff) {
  const ImpactCurve curve = random_on_sphere(40, 3, true);
  for (const AxisMode mode : {AxisMode::surface_normal, AxisMode::fixed_direction}) {
    ToolOptions options = all_points(Process::spray, mode);
    options.stand_off = 230;
    const ToolPath path = make_tool_path(curve, options);
    for (std::size_t i = 0; i < path.points.size(); ++i) {
      const ToolPoint& point = path.points[i];
      const Vec3 hit = point.tip - 230 * point.axis;  // where the jet meets the surface
      EXPECT_LT((hit - curve.points[i].position).norm(), 1e-12);
      if (mode == AxisMode::surface_normal) {
        EXPECT_NEAR(point.tip.norm(), 270, 1e-12);
      }
    }
  }
}

TEST(MakeToolPath, TangentIsAUnitVectorAcrossTheAxisAndForward) {
  const ImpactCurve curve = random_on_sphere(40, 4);
  const ToolPath path = make_tool_path(curve, all_points(Process::mill));
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const ToolPoint& point = path.points[i];
    EXPECT_NEAR(point.tangent.norm(), 1, 1e-12) << i;
    EXPECT_NEAR(point.tangent.dot(point.axis), 0, 1e-12) << i;
    if (i > 0 && i + 1 < path.points.size()) {
      const Vec3 in = (point.tip - path.points[i - 1].tip).normalized();
      const Vec3 out = (path.points[i + 1].tip - point.tip).normalized();
      EXPECT_GT(point.tangent.dot(in + out), 0) << i;
    }
  }
}

TEST(MakeToolPath, EveryLiftLandsSlowlyThoughNothingIsCoveredBehindIt) {
  ImpactCurve curve;
  const auto add = [&](MoveKind kind, double x, double z, Index piece) {
    ImpactPoint point;
    point.kind = kind;
    point.position = {x, 0, z};
    point.piece = piece;
    curve.points.push_back(point);
  };
  add(MoveKind::cover, 0, 0, 0);
  for (const Index piece : {1, 2}) {  // a piece that is but the point where the lift ends
    add(MoveKind::lift, 10 * piece - 10, 20, piece);
    add(MoveKind::lift, 10 * piece, 20, piece);
    add(MoveKind::lift, 10 * piece, 0, piece);
  }
  const ToolOptions options = all_points(Process::mill);
  for (const ToolPoint& point : make_tool_path(curve, options).points) {
    if (point.kind != MoveKind::lift) continue;
    const bool on_surface = point.tip.z() == 0;
    EXPECT_EQ(point.feed_mm_per_min, on_surface ? options.link_feed_mm_per_min : options.rapid_speed_mm_per_min);
  }
}

TEST(MakeToolPath, StopsOnRequest) {
  class Stop final : public Progress {
    bool cancelled() const override { return true; }
  } stop;
  ImpactCurve curve;
  for (const double x : {0.0, 1.0, 2.0}) {
    ImpactPoint& point = curve.points.emplace_back();
    point.position.x() = x;
  }
  EXPECT_THROW(make_tool_path(curve, {}, stop), Error);
}

TEST(MakeToolPath, TimeIsTheSumOfLengthOverFeed) {
  ImpactCurve curve;
  const auto add = [&](MoveKind kind, double x, double z, Index piece) {
    ImpactPoint point;
    point.kind = kind;
    point.position = {x, 0, z};
    point.piece = piece;
    curve.points.push_back(point);
  };
  add(MoveKind::cover, 0, 0, 0);
  add(MoveKind::cover, 10, 0, 0);  // 10 mm at 600 mm/min: 1 s
  add(MoveKind::link, 15, 0, 0);   // 5 mm at 300: 1 s
  add(MoveKind::lift, 15, 20, 1);  // 20 mm at 6000: 0.2 s
  add(MoveKind::lift, 35, 20, 1);  // 20 mm at 6000: 0.2 s
  add(MoveKind::lift, 35, 0, 1);   // 20 mm down at 300: 4 s
  add(MoveKind::cover, 45, 0, 1);  // 1 s
  ToolOptions options = all_points(Process::mill);
  options.cover_feed_mm_per_min = 600;
  options.link_feed_mm_per_min = 300;
  options.rapid_speed_mm_per_min = 6000;
  const ToolPath path = make_tool_path(curve, options);
  const double expected[] = {0, 1, 2, 2.2, 2.4, 6.4, 7.4};
  ASSERT_EQ(path.points.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_NEAR(path.points[i].time, expected[i], 1e-12) << i;
    EXPECT_EQ(path.points[i].kind, curve.points[i].kind) << i;
    EXPECT_EQ(path.points[i].piece, curve.points[i].piece) << i;
  }
}

TEST(MakeToolPath, RefusesASurfaceThatFacesAwayFromTheFixedAxis) {
  ImpactCurve curve;
  for (const Vec3& d : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(1, 0, -0.5)}) curve.points.push_back(on_sphere(10, d));
  try {
    make_tool_path(curve, all_points(Process::mill, AxisMode::fixed_direction));
    FAIL() << "accepted an undercut";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::no_plan);
    EXPECT_EQ(error.where().element, "impact point 2");
  }
  curve.points.back().kind = MoveKind::lift;  // off the surface, nothing is in the way
  EXPECT_NO_THROW(make_tool_path(curve, all_points(Process::mill, AxisMode::fixed_direction)));
}

TEST(MakeToolPath, RefusesBrokenOptionsAndCurves) {
  ToolOptions options;
  options.ball_diameter = -2;
  try {
    make_tool_path({}, options);
    FAIL() << "accepted a negative diameter";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_usage);
    EXPECT_NE(std::string(error.what()).find("ball_diameter"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("-2"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("> 0"), std::string::npos);
  }
  ImpactCurve curve;
  curve.points.push_back(on_sphere(10, Vec3::UnitZ()));
  curve.points[0].normal *= 2;
  EXPECT_THROW(make_tool_path(curve), Error);
  curve.points[0].normal = Vec3::Constant(std::nan(""));
  EXPECT_THROW(make_tool_path(curve), Error);
}

TEST(MakeToolPath, AnEmptyCurveMakesAnEmptyPath) { EXPECT_TRUE(make_tool_path({}).points.empty()); }

}  // namespace
}  // namespace isopath
