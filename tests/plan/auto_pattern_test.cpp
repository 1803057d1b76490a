#include "isopath/plan/auto_pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "isopath/field/exact_field.h"
#include "isopath/field/vertex_field.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

ChosenPlan choose(const TriangleMesh& mesh, const SurfaceFunction& function, double spacing) {
  std::vector<double> values;
  for (Index v = 0; v < mesh.n_vertices(); ++v) values.push_back(function.value_at_vertex(v));
  return plan_by_part(mesh, function, values, {.pattern = Pattern::planar, .spacing = spacing});
}

double way_of(const ImpactPlan& plan) {
  return length_of(plan.curve, MoveKind::cover) + length_of(plan.curve, MoveKind::link);
}

TEST(auto_pattern, is_a_spiral_where_isolines_are_nested) {
  // so many turns that half a pass more at either rim weighs little
  const TriangleMesh mesh = test::hemisphere(24, 72, 50);
  EXPECT_EQ(choose(mesh, ExactField::compute(mesh, boundary_source(mesh)), 2.5).pattern, Pattern::spiral);
}

TEST(auto_pattern, is_a_meander_where_isolines_are_side_by_side) {
  const TriangleMesh mesh = test::planar_grid(30, 20, 60, 40);
  EXPECT_EQ(choose(mesh, height_field(mesh, Vec3::UnitY()), 2).pattern, Pattern::meander);
}

TEST(auto_pattern, is_two_way_where_that_saves_lifts_or_length) {
  // a plate with a square hole that is not in its middle: many families of isolines
  const TriangleMesh mesh =
      test::planar_cells(14, 14, [](int i, int j) { return !(j > 4 && j < 10 && i > 4 && i < 10); });
  ASSERT_EQ(mesh.boundary_loops().size(), 2u);
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  const ChosenPlan chosen = choose(mesh, field, 1);
  EXPECT_EQ(chosen.pattern, Pattern::two_way);
  EXPECT_EQ(chosen.plan.curve.points.back().piece, 0);
  const ImpactPlan spiral = plan_impact(mesh, field, {.pattern = Pattern::spiral, .spacing = 1});
  const bool saves_lifts = spiral.curve.points.back().piece > 0;
  EXPECT_LT(way_of(chosen.plan), (saves_lifts ? 1.05 : 1 / 1.1) * way_of(spiral));
}

}  // namespace
}  // namespace isopath
