#include "isopath/plan/nested_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/core/quiet_progress.h"
#include "isopath/field/exact_distances.h"
#include "isopath/field/source.h"
#include "isopath/mesh/refine.h"
#include "isopath/plan/hole_bridges.h"
#include "isopath/plan/run_plan.h"
#include "support/plan_spiral.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

TEST(NestedPlan, ShapesAreToldByTheirLoopsAndHandles) {
  EXPECT_EQ(nested_shape_of(test::l_shape(3)), NestedShape::disc);
  EXPECT_EQ(nested_shape_of(test::icosphere(1, 1)), NestedShape::disc);
  EXPECT_EQ(nested_shape_of(test::open_cylinder(8, 3, 1, 1)), NestedShape::annulus);
  EXPECT_EQ(nested_shape_of(test::torus(8, 6, 3, 1)), NestedShape::handles);
  EXPECT_EQ(nested_shape_of(test::planar_cells(7, 3, [](int i, int j) { return j != 1 || (i != 1 && i != 5); })),
            NestedShape::holes);
}

TEST(NestedPlan, OneSpiralWhereTheDistanceHasTwoTops) {
  const TriangleMesh dumbbell =
      test::planar_cells(22, 8, [](int i, int j) { return i < 8 || i >= 14 || (j >= 2 && j < 6); });
  const PlanResult result = test::plan_spiral(dumbbell, std::nullopt, Blending::least, 1);
  EXPECT_EQ(result.pattern, Pattern::spiral);
  EXPECT_EQ(result.figures.pieces, 1);
  EXPECT_EQ(result.figures.lifts, 0);
  EXPECT_GE(result.gap.covered_fraction, 0.995);

  const PlanResult there_and_back = test::plan_spiral(dumbbell, Pattern::double_spiral, Blending::automatic, 1);
  EXPECT_EQ(there_and_back.job.blend, Blending::least) << "needs nested levels, whether asked for or not";
  EXPECT_EQ(there_and_back.figures.pieces, 1);
  EXPECT_EQ(there_and_back.figures.lifts, 0);
}

TEST(NestedPlan, AnAnnulusIsBlendedFromLoopToLoop) {
  const TriangleMesh mesh = test::planar_cells(12, 12, [](int i, int j) { return i < 4 || i >= 8 || j < 4 || j >= 8; });
  const PlanResult result = test::plan_spiral(mesh, Pattern::double_spiral, Blending::least, 0.8);
  EXPECT_EQ(result.figures.pieces, 1);
  EXPECT_EQ(result.figures.lifts, 0);
  EXPECT_GE(result.gap.covered_fraction, 0.995);
}

TEST(NestedPlan, AnAnnulusOfUnevenWidthIsCutOpen) {
  // 2 wide on one side of the hole, 10 on the other: levels from loop to loop would be five times as dense there
  const TriangleMesh mesh = test::planar_cells(16, 8, [](int i, int j) { return i < 2 || i >= 6 || j < 2 || j >= 6; });
  QuietProgress quiet(Progress::none());
  const std::optional<RefinedMesh> opened = opened_annulus(mesh, 0.5, quiet);
  ASSERT_TRUE(opened);
  EXPECT_EQ(nested_shape_of(opened->mesh), NestedShape::disc);
  EXPECT_NEAR(opened->mesh.area(), mesh.area(), 1e-9);
  EXPECT_FALSE(opened_annulus(test::open_cylinder(24, 8, 5, 4), 0.5, quiet)) << "of even width";

  const PlanResult result = test::plan_spiral(mesh, Pattern::spiral, Blending::least, 0.5);
  EXPECT_EQ(result.figures.pieces, 1);
  EXPECT_EQ(result.figures.lifts, 0);
  EXPECT_LE(result.gap.max, 1.05);
  EXPECT_LE(result.length_ratio, 1.2);
}

TEST(NestedPlan, SeveralHolesAreCutOpenAndGetOneSpiral) {
  const TriangleMesh mesh =
      test::planar_cells(14, 6, [](int i, int j) { return j < 2 || j > 3 || (i != 3 && i != 10); });
  const PlanResult result = test::plan_spiral(mesh, Pattern::spiral, Blending::least, 0.4);
  EXPECT_EQ(result.pattern, Pattern::spiral);
  EXPECT_EQ(result.figures.pieces, 1);
  EXPECT_EQ(result.figures.lifts, 0);
  EXPECT_LE(result.gap.max, 1.05);
  EXPECT_GE(result.gap.covered_fraction, 0.999);
  EXPECT_NEAR(result.part.mesh.area(), 14 * 6 - 4, 1e-9);
  EXPECT_TRUE(std::any_of(result.warnings.begin(), result.warnings.end(),
                          [](const std::string& text) { return text.find("cut open") != std::string::npos; }));
}

TEST(NestedPlan, HandlesGetATwoWayCurveAndAWarning) {
  const PlanResult result = test::plan_spiral(test::torus(12, 8, 3, 1), Pattern::spiral, Blending::least, 1);
  EXPECT_EQ(result.pattern, Pattern::two_way);
  EXPECT_EQ(result.figures.lifts, 0);
  EXPECT_TRUE(std::any_of(result.warnings.begin(), result.warnings.end(),
                          [](const std::string& text) { return text.find("handles") != std::string::npos; }));
}

/// Prim's tree over all pairs of loops, each distance from a field of its own.
double least_tree_length(const TriangleMesh& mesh) {
  const std::size_t n = mesh.boundary_loops().size();
  std::vector<std::vector<double>> apart(n, std::vector<double>(n, infinity));
  for (std::size_t a = 0; a < n; ++a) {
    const std::vector<double> distance = exact_distances(mesh, boundary_source(mesh, static_cast<Index>(a)));
    for (std::size_t b = 0; b < n; ++b) {
      for (const Index h : mesh.boundary_loops()[b]) apart[a][b] = std::min(apart[a][b], distance[mesh.from(h)]);
    }
  }
  std::vector<char> in(n, 0);
  in[0] = 1;
  double sum = 0;
  for (std::size_t round = 1; round < n; ++round) {
    std::pair<double, std::size_t> best = {infinity, 0};
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) {
        if (in[a] && !in[b]) best = std::min(best, {apart[a][b], b});
      }
    }
    sum += best.first;
    in[best.second] = 1;
  }
  return sum;
}

TEST(HoleBridges, AreTheShortestTreeOfLoopsAndLeaveADisc) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    test::Rng rng(seed);
    // single cells at random, no two of them with a common corner, so that each is a hole
    std::set<std::pair<int, int>> holes;
    const Index wanted = 1 + test::random_index(rng, 8);
    for (int tries = 0; tries < 40 && static_cast<Index>(holes.size()) < wanted; ++tries) {
      const int i = 1 + static_cast<int>(test::random_index(rng, 12));
      const int j = 1 + static_cast<int>(test::random_index(rng, 8));
      const bool is_free = std::none_of(holes.begin(), holes.end(), [&](const auto& hole) {
        return std::abs(hole.first - i) < 2 && std::abs(hole.second - j) < 2;
      });
      if (is_free) holes.insert({i, j});
    }
    const TriangleMesh mesh = split_uniformly(test::planar_cells(14, 10, [&](int i, int j) {
                                return !holes.contains({i, j});
                              })).mesh;
    const auto bridges = hole_bridges(mesh);
    ASSERT_EQ(bridges.size(), holes.size());
    double sum = 0;
    for (const auto& bridge : bridges) sum += test::length_of(mesh, bridge);
    EXPECT_NEAR(sum, least_tree_length(mesh), 1e-4);

    const auto opened = opened_holes(mesh, 1.5, Progress::none());
    ASSERT_TRUE(opened);
    EXPECT_EQ(nested_shape_of(opened->mesh), NestedShape::disc)
        << "a cycle would cut a piece off, a lack leaves a hole";
    EXPECT_EQ(opened->mesh.n_components(), 1);
    EXPECT_NEAR(opened->mesh.area(), mesh.area(), 1e-9);
  }
}

TEST(HoleBridges, NoneOnADiscAndNoDiscWithHandles) {
  EXPECT_TRUE(hole_bridges(test::l_shape(3)).empty());
  EXPECT_FALSE(opened_holes(test::torus(8, 6, 3, 1), 1, Progress::none()));
}

}  // namespace
}  // namespace isopath
