#include "isopath/plan/nested_plan.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "isopath/core/error.h"
#include "isopath/core/quiet_progress.h"
#include "isopath/plan/run_plan.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

class NestedPlan : public testing::Test {
 protected:
  static PlanResult plan(const TriangleMesh& mesh, std::optional<Pattern> pattern, std::optional<BlendForm> blend,
                         double spacing) {
    Job job;
    job.pattern = pattern;
    job.blend = blend;
    job.spacing = spacing;
    const auto folder = std::filesystem::path(testing::TempDir());
    job.mesh = folder / (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".off");
    test::write_off(mesh, job.mesh);
    job.report = false;
    return run_plan(job);
  }
};

TEST_F(NestedPlan, ShapesAreToldByTheirLoopsAndHandles) {
  EXPECT_EQ(nested_shape_of(test::l_shape(3)), NestedShape::disc);
  EXPECT_EQ(nested_shape_of(test::icosphere(1, 1)), NestedShape::disc);
  EXPECT_EQ(nested_shape_of(test::open_cylinder(8, 3, 1, 1)), NestedShape::annulus);
  EXPECT_EQ(nested_shape_of(test::torus(8, 6, 3, 1)), NestedShape::other);
  EXPECT_EQ(nested_shape_of(test::planar_cells(7, 3, [](int i, int j) { return j != 1 || (i != 1 && i != 5); })),
            NestedShape::other);
}

TEST_F(NestedPlan, OneSpiralWhereTheDistanceHasTwoTops) {
  const TriangleMesh dumbbell =
      test::planar_cells(22, 8, [](int i, int j) { return i < 8 || i >= 14 || (j >= 2 && j < 6); });
  const PlanResult result = plan(dumbbell, std::nullopt, BlendForm::least, 1);
  EXPECT_EQ(result.pattern, Pattern::spiral);
  EXPECT_EQ(result.figures.pieces, 1);
  EXPECT_EQ(result.figures.lifts, 0);
  EXPECT_GE(result.gap.covered_fraction, 0.995);

  const PlanResult there_and_back = plan(dumbbell, Pattern::double_spiral, std::nullopt, 1);
  EXPECT_EQ(there_and_back.job.blend, BlendForm::least) << "needs nested levels, whether asked for or not";
  EXPECT_EQ(there_and_back.figures.pieces, 1);
  EXPECT_EQ(there_and_back.figures.lifts, 0);
}

TEST_F(NestedPlan, AnAnnulusIsBlendedFromLoopToLoop) {
  const TriangleMesh mesh = test::planar_cells(12, 12, [](int i, int j) { return i < 4 || i >= 8 || j < 4 || j >= 8; });
  const PlanResult result = plan(mesh, Pattern::double_spiral, BlendForm::least, 0.8);
  EXPECT_EQ(result.figures.pieces, 1);
  EXPECT_EQ(result.figures.lifts, 0);
  EXPECT_GE(result.gap.covered_fraction, 0.995);
}

TEST_F(NestedPlan, AnAnnulusOfUnevenWidthIsCutOpen) {
  // 2 wide on one side of the hole, 10 on the other: levels from loop to loop would be five times as dense there
  const TriangleMesh mesh = test::planar_cells(16, 8, [](int i, int j) { return i < 2 || i >= 6 || j < 2 || j >= 6; });
  QuietProgress quiet(Progress::none());
  const std::optional<TriangleMesh> opened = opened_annulus(mesh, 0.5, quiet);
  ASSERT_TRUE(opened);
  EXPECT_EQ(nested_shape_of(*opened), NestedShape::disc);
  EXPECT_NEAR(opened->area(), mesh.area(), 1e-9);
  EXPECT_FALSE(opened_annulus(test::open_cylinder(24, 8, 5, 4), 0.5, quiet)) << "of even width";

  const PlanResult result = plan(mesh, Pattern::spiral, BlendForm::least, 0.5);
  EXPECT_EQ(result.figures.pieces, 1);
  EXPECT_EQ(result.figures.lifts, 0);
  EXPECT_LE(result.gap.max, 1.05);
  EXPECT_LE(result.length_ratio, 1.2);
}

TEST_F(NestedPlan, MoreHolesGetATwoWayCurveAndAWarning) {
  const TriangleMesh mesh =
      test::planar_cells(14, 6, [](int i, int j) { return j < 2 || j > 3 || (i != 3 && i != 10); });
  const PlanResult result = plan(mesh, Pattern::spiral, BlendForm::least, 0.7);
  EXPECT_EQ(result.pattern, Pattern::two_way);
  EXPECT_EQ(result.figures.lifts, 0);
  EXPECT_TRUE(std::any_of(result.warnings.begin(), result.warnings.end(),
                          [](const std::string& text) { return text.find("holes") != std::string::npos; }));
}

}  // namespace
}  // namespace isopath
