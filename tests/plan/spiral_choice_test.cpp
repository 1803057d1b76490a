#include "isopath/plan/spiral_choice.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "isopath/plan/run_plan.h"
#include "support/plan_spiral.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

void expect_same_curve(const PlanResult& a, const PlanResult& b) {
  ASSERT_EQ(a.impact.curve.points.size(), b.impact.curve.points.size());
  for (std::size_t i = 0; i < a.impact.curve.points.size(); ++i)
    ASSERT_EQ(a.impact.curve.points[i].position, b.impact.curve.points[i].position) << "point " << i;
}

TEST(SpiralChoices, CornersAndLiftsCountAsLength) {
  const CurveCost smooth{.length = 100};
  EXPECT_EQ(as_length(smooth, 2), 100);
  EXPECT_EQ(as_length({.length = 100, .lifts = 1}, 2), 140);
  EXPECT_EQ(as_length({.length = 100, .sharp_corners = 1}, 2), 110);
}

TEST(SpiralChoices, OnlyDiscsWithTheirWholeRimAsSource) {
  const TriangleMesh disc = test::l_shape(3);
  std::vector<double> distances(disc.n_vertices(), 1.0);
  for (Index v = 0; v < disc.n_vertices(); ++v) {
    if (disc.is_boundary_vertex(v)) distances[v] = 0;
  }
  Job job;
  EXPECT_TRUE(may_blend_spiral(job, disc, distances));
  job.pattern = Pattern::spiral;
  EXPECT_TRUE(may_blend_spiral(job, disc, distances));
  job.pattern = Pattern::meander;
  EXPECT_FALSE(may_blend_spiral(job, disc, distances));
  job.pattern = Pattern::spiral;
  for (const Blending told : {Blending::none, Blending::least, Blending::paper}) {
    job.blend = told;
    EXPECT_FALSE(may_blend_spiral(job, disc, distances)) << name_of(told);
  }
  job.blend = Blending::automatic;
  job.smooth = 1;
  EXPECT_FALSE(may_blend_spiral(job, disc, distances));
  job.smooth = 0;
  distances[disc.from(disc.boundary_loops()[0][0])] = 0.1;
  EXPECT_FALSE(may_blend_spiral(job, disc, distances)) << "a place of the rim is no source";
  const TriangleMesh tube = test::open_cylinder(8, 3, 1, 1);
  EXPECT_FALSE(may_blend_spiral(job, tube, std::vector<double>(tube.n_vertices(), 0.0)));
}

TEST(SpiralChoices, WhatIsChosenCostsLess) {
  const TriangleMesh l = test::l_shape(9);
  const TriangleMesh dumbbell =
      test::planar_cells(22, 8, [](int i, int j) { return i < 8 || i >= 14 || (j >= 3 && j < 5); });
  for (const TriangleMesh* mesh : {&l, &dumbbell}) {
    for (const std::optional<Pattern> pattern : {std::optional(Pattern::spiral), std::optional<Pattern>()}) {
      const PlanResult result = test::plan_spiral(*mesh, pattern, Blending::automatic, 1);
      ASSERT_TRUE(result.spiral && result.spiral->by_distance && result.spiral->by_blend);
      const double by_distance = as_length(*result.spiral->by_distance, 1);
      const double by_blend = as_length(*result.spiral->by_blend, 1);
      EXPECT_EQ(result.spiral->blended, by_blend < by_distance);
      const CurveCost taken = cost_of(result.impact.curve, 1, true);
      EXPECT_EQ(as_length(taken, 1), result.spiral->blended ? by_blend : by_distance);
      EXPECT_TRUE(result.spiral->blended || result.spiral->by_distance->finished) << "compared as it is";
      EXPECT_EQ(result.job.blend, Blending::automatic) << "the job stays as it was given";
    }
  }
}

TEST(SpiralChoices, OnADoubleSpiralsHolesTheCheaperClosedCurveIsTaken) {
  const TriangleMesh two_holes =
      test::planar_cells(14, 6, [](int i, int j) { return j < 2 || j > 3 || (i != 3 && i != 10); });
  // levels from loop to loop are as good as can be
  const TriangleMesh ring = test::open_cylinder(32, 6, 4, 3);
  constexpr double spacing = 0.5;
  for (const TriangleMesh* mesh : {&two_holes, &ring}) {
    const PlanResult result = test::plan_spiral(*mesh, Pattern::double_spiral, Blending::automatic, spacing);
    ASSERT_TRUE(result.spiral && result.spiral->by_two_way && result.spiral->by_blend);
    const double two_way = as_length(*result.spiral->by_two_way, spacing);
    const double nested = as_length(*result.spiral->by_blend, spacing);
    EXPECT_EQ(result.spiral->blended, nested <= two_way);
    EXPECT_EQ(result.pattern, result.spiral->blended ? Pattern::double_spiral : Pattern::two_way);
    EXPECT_NEAR(as_length(cost_of(result.impact.curve, 0.4, true), spacing), std::min(nested, two_way), 1e-9 * nested);
    const auto& points = result.impact.curve.points;
    EXPECT_LE((points.front().position - points.back().position).norm(), 1e-9) << "closed, whichever it is";
    EXPECT_EQ(result.job.blend, Blending::automatic) << "the job stays as it was given";
    EXPECT_EQ(result.job.sources, Job{}.sources);
    EXPECT_EQ(text_of(*result.spiral, result.gap.area, spacing).rfind(result.spiral->blended ? "double" : "two-way", 0),
              0U)
        << "says first what was taken";
    EXPECT_GE(result.gap.covered_fraction, 0.999);

    const PlanResult told = test::plan_spiral(*mesh, Pattern::double_spiral, Blending::least, spacing);
    EXPECT_FALSE(told.spiral);
    EXPECT_EQ(told.pattern, Pattern::double_spiral);
    expect_same_curve(result, result.spiral->blended
                                  ? told
                                  : test::plan_spiral(*mesh, Pattern::two_way, Blending::automatic, spacing));
  }
}

TEST(SpiralChoices, AChosenBlendIsTheOneThatMayBeAskedFor) {
  const TriangleMesh l = test::l_shape(9);
  const PlanResult chosen = test::plan_spiral(l, Pattern::spiral, Blending::automatic, 1);
  ASSERT_TRUE(chosen.spiral && chosen.spiral->blended);
  const PlanResult asked = test::plan_spiral(l, Pattern::spiral, Blending::least, 1);
  EXPECT_FALSE(asked.spiral) << "nothing was left to choose";
  expect_same_curve(chosen, asked);
  EXPECT_EQ(chosen.distances, asked.distances);
  EXPECT_EQ(chosen.figures.lifts, 0);
  EXPECT_GE(chosen.gap.covered_fraction, 0.999);
}

TEST(SpiralChoices, PartsThatWouldTakeLongAreNotBlendedUnasked) {
  const TriangleMesh square = test::planar_cells(10, 10, [](int, int) { return true; });
  constexpr double spacing = 0.18;
  ASSERT_GT(triangles_for_blend(square, spacing), most_triangles_unasked);
  const PlanResult chosen = test::plan_spiral(square, Pattern::spiral, Blending::automatic, spacing);
  ASSERT_TRUE(chosen.spiral);
  EXPECT_EQ(chosen.spiral->too_fine, triangles_for_blend(square, spacing));
  expect_same_curve(chosen, test::plan_spiral(square, Pattern::spiral, Blending::none, spacing));
}

TEST(SpiralChoices, LargeRadiiSwallowNoPasses) {
  Job job;
  job.pattern = Pattern::spiral;
  job.spacing = 5;
  job.min_radius = 20;  // drawn as round as that, the spiral of a square of 50 mm shrinks to a turn
  job.report = false;
  job.mesh = std::filesystem::path(testing::TempDir()) / "LargeRadiiSwallowNoPasses.off";
  test::write_off(test::planar_grid(4, 4, 50, 50), job.mesh);
  const PlanResult result = run_plan(job);
  EXPECT_GT(result.gap.covered_fraction, 0.99);
  EXPECT_FALSE(result.tight.empty()) << "it has to tell where the radius is not kept";
}

}  // namespace
}  // namespace isopath
