#include "isopath/impact/level_spiral.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "curve_checks.h"
#include "isopath/contour/blend.h"
#include "isopath/contour/blend_mesh.h"
#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/impact/finish_curve.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

/// A part made fine, and its blended function.
struct Part {
  TriangleMesh mesh;
  double spacing = 0;
  std::vector<double> values;

  Part(const TriangleMesh& coarse, double asked) {
    mesh = refine_for_blend(coarse, ExactField::compute(coarse, boundary_source(coarse)), asked).mesh;
    BlendedField blended = blend(ExactField::compute(mesh, boundary_source(mesh)),
                                 {.spacing = asked, .radius = default_radius_in_spacings * asked});
    spacing = blended.spacing;
    values = std::move(blended.values);
  }
};

struct Case {
  const char* name;
  TriangleMesh mesh;
  double spacing;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({"square", test::planar_grid(10, 10, 20, 20), 3});
  all.push_back({"L", test::l_shape(8), 1.4});
  all.push_back({"rectangle 1:10", test::planar_grid(40, 4, 40, 4), 1});
  all.push_back({"disc", test::flat_disc(40, 6, 8), 1.5});
  all.push_back({"star", test::planar_star(5, 12, 6), 1.5});
  all.push_back({"bump",
                 test::height_grid(24, 24, 12, 12,
                                   [](double x, double y) {
                                     const double r2 = (x - 7) * (x - 7) + (y - 6.5) * (y - 6.5);
                                     return 3.5 * std::exp(-r2 / 3);
                                   }),
                 1.2});
  return all;
}

TEST(LevelSpiral, IsOneCurveThatKeepsTheGap) {
  for (const Case& c : cases()) {
    const Part part(c.mesh, c.spacing);
    for (const int arms : {1, 2}) {
      const ImpactPlan plan = level_spiral(VertexField(part.mesh, part.values),
                                           {.arms = arms, .spacing = part.spacing, .asked_spacing = c.spacing});
      SCOPED_TRACE(std::string(c.name) + ", arms " + std::to_string(arms));
      test::expect_valid(part.mesh, plan.curve);
      EXPECT_EQ(test::pieces_of(plan.curve), 1);
      EXPECT_EQ(length_of(plan.curve, MoveKind::link), 0);
      const GapReport gap = measure_gap(part.mesh, plan.curve, c.spacing);
      EXPECT_LE(gap.max, 1.05 * c.spacing);
      EXPECT_GE(gap.covered_fraction, 0.998);
      EXPECT_EQ(plan.radius, default_radius_in_spacings * c.spacing);
      // swells may turn a little more tightly, 0.064 spacings are a turn by 45 degrees within a tenth of one; a gap
      // that only a corner closes comes first
      EXPECT_LE(tight_places(part.mesh, plan.curve, 0.8 * plan.radius).size(), 1U);
      // no more than the area asks for, but for the window, the corners' tips and a level at the top
      const double ideal = part.mesh.area() / c.spacing;
      EXPECT_LE(length_of(plan.curve, MoveKind::cover), 1.45 * ideal);
      const Vec3 ends = plan.curve.points.front().position - plan.curve.points.back().position;
      if (arms == 2) {
        EXPECT_LE(ends.norm(), 1e-9) << "a double spiral ends where it began";
      } else {
        EXPECT_GT(ends.norm(), c.spacing);
      }
    }
  }
}

TEST(LevelSpiral, OnADiscTurnsAsOftenAsThereAreLevels) {
  const Part part(test::flat_disc(40, 5, 6), 0.6);
  for (const int arms : {1, 2}) {
    const ImpactPlan plan = level_spiral(VertexField(part.mesh, part.values), {.arms = arms, .spacing = part.spacing});
    double turns = 0;
    for (std::size_t i = 1; i < plan.curve.points.size(); ++i) {
      const Vec3& a = plan.curve.points[i - 1].position;
      const Vec3& b = plan.curve.points[i].position;
      if (std::min(a.norm(), b.norm()) < 0.6) continue;  // at the centre the angle says nothing
      turns += std::atan2(a.cross(b).z(), a.dot(b)) / (2 * std::numbers::pi);
    }
    if (arms == 1) {
      EXPECT_NEAR(std::abs(turns), 10, 1);
    } else {
      EXPECT_NEAR(turns, 0, 1) << "what goes in comes out the other way round";
    }
  }
}

TEST(LevelSpiral, GoesFromLoopToLoopOfAnAnnulus) {
  const TriangleMesh mesh = test::open_cylinder(60, 40, 10, 20);
  std::vector<double> height;
  for (Index v = 0; v < mesh.n_vertices(); ++v) height.push_back(mesh.position(v).z());
  for (const int arms : {1, 2}) {
    const ImpactPlan plan = level_spiral(VertexField(mesh, height), {.arms = arms, .spacing = 2});
    EXPECT_EQ(test::pieces_of(plan.curve), 1);
    EXPECT_EQ(length_of(plan.curve, MoveKind::link), 0);
    EXPECT_LE(measure_gap(mesh, plan.curve, 2).max, 2.1);
    EXPECT_LE(length_of(plan.curve, MoveKind::cover) * 2 / mesh.area(), 1.12);
  }
}

TEST(LevelSpiral, WithFewerLevelsThanArmsIsARing) {
  const Part part(test::planar_grid(8, 8, 8, 8), 4.5);
  for (const int arms : {1, 2}) {
    const ImpactPlan plan = level_spiral(VertexField(part.mesh, part.values), {.arms = arms, .spacing = part.spacing});
    EXPECT_EQ(test::pieces_of(plan.curve), 1);
    test::expect_valid(part.mesh, plan.curve);
  }
}

TEST(LevelSpiral, GoesRoundIslandsOnItsWay) {
  const Part dumbbell(test::planar_cells(22, 8, [](int i, int j) { return i < 8 || i >= 14 || (j >= 2 && j < 6); }),
                      0.7);
  const Part comb(test::planar_cells(20, 8, [](int i, int j) { return j < 1 || i % 7 < 6; }), 0.8);
  for (const Part* part : {&dumbbell, &comb}) {
    for (const int arms : {1, 2}) {
      const ImpactPlan plan =
          level_spiral(VertexField(part->mesh, part->values), {.arms = arms, .spacing = part->spacing});
      SCOPED_TRACE(arms);
      test::expect_valid(part->mesh, plan.curve);
      EXPECT_EQ(test::pieces_of(plan.curve), 1);
      const double spacing = part->spacing;
      // a loop around what is left of an island's top, at most
      EXPECT_LE(length_of(plan.curve, MoveKind::link), (part == &comb ? 2 : 1) * 4 * spacing);
      const GapReport gap = measure_gap(part->mesh, plan.curve, spacing);
      EXPECT_LE(gap.max, 1.05 * spacing);
      EXPECT_GE(gap.covered_fraction, 0.999);
      // passes through the neck for all levels of the far side would be a third more
      EXPECT_LE(length_of(plan.curve, MoveKind::cover), 1.25 * part->mesh.area() / spacing);
      const Vec3 ends = plan.curve.points.front().position - plan.curve.points.back().position;
      EXPECT_EQ(ends.norm() < 1e-9, arms == 2);
    }
  }
}

TEST(LevelSpiral, RefusesOpenLevels) {
  const TriangleMesh mesh = test::planar_grid(8, 8, 8, 8);
  try {
    level_spiral(height_field(mesh, Vec3::UnitX()), {.spacing = 0.7});
    FAIL() << "lines from edge to edge were taken for nested curves";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::no_plan);
  }
}

TEST(LevelSpiral, RefusesOptionsOutOfRange) {
  const TriangleMesh mesh = test::planar_grid(2, 2, 1, 1);
  const VertexField field(mesh, std::vector<double>(9, 0.0));
  EXPECT_THROW(level_spiral(field, {.arms = 3, .spacing = 1}), Error);
  EXPECT_THROW(level_spiral(field, {}), Error);
  EXPECT_THROW(level_spiral(field, {.spacing = 1, .clearance = -1}), Error);
  EXPECT_THROW(level_spiral(field, {.spacing = 1}), Error) << "a level function has no levels";
}

TEST(LevelSpiral, IsTheSameEachTime) {
  const Part part(test::l_shape(4), 1);
  const VertexField field(part.mesh, part.values);
  const ImpactPlan one = level_spiral(field, {.arms = 2, .spacing = part.spacing});
  const ImpactPlan other = level_spiral(field, {.arms = 2, .spacing = part.spacing});
  ASSERT_EQ(one.curve.points.size(), other.curve.points.size());
  for (std::size_t i = 0; i < one.curve.points.size(); ++i)
    EXPECT_EQ(one.curve.points[i].position, other.curve.points[i].position);
}

}  // namespace
}  // namespace isopath
