#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/plan/plan_outputs.h"
#include "isopath/plan/run_plan.h"
#include "isopath/plan/scallop_metric.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

Job job_on(const TriangleMesh& mesh, const std::string& name) {
  Job job;
  job.mesh = std::filesystem::path(testing::TempDir()) / (name + ".off");
  job.report = false;
  write_off(mesh, job.mesh);
  return job;
}

TEST(ScallopPlan, LeavesTheCuspsThatAreAskedFor) {
  Job job = job_on(wavy_sheet(40, 20, 1, 0.3, 0.3, 5), "scallop_wavy");
  job.scallop = 0.04;
  job.tool.ball_diameter = 10;
  job.pattern = Pattern::contour;
  const PlanResult result = run_plan(job);
  EXPECT_NEAR(result.spacing, std::sqrt(8 * 0.04 * 5), 1e-12);
  EXPECT_GT(result.gap.covered_fraction, 0.99);
  EXPECT_LT(result.gap.max, 1.2 * result.spacing);
  EXPECT_GT(result.length_ratio, 0.98);
  EXPECT_LT(result.length_ratio, 1.2);
  ASSERT_TRUE(result.scallop);
  // Cusps go with the square of the gap. Passes are put up to a few percent closer than asked for; where fronts meet,
  // gaps of 1.03 spacings are let be, and what bumps leave is a little wider.
  EXPECT_LT(result.scallop->measured.p99, 1.15 * 1.15 * job.scallop);
  EXPECT_GT(result.scallop->measured.mean, 0.75 * job.scallop);
  EXPECT_LT(result.scallop->measured.mean, 1.02 * job.scallop);
  EXPECT_EQ(result.scallop->gouged_fraction, 0);
  const auto summary = nlohmann::json::parse(summary_json(result));
  EXPECT_EQ(summary["scallop"]["wanted"], 0.04);
  EXPECT_EQ(summary["scallop"]["max"], result.scallop->measured.max);

  job.scallop = 0;
  job.spacing = 3;
  EXPECT_FALSE(nlohmann::json::parse(summary_json(run_plan(job))).contains("scallop"));
}

TEST(ScallopPlan, PlanarPassesAreOnlyMeasured) {
  Job job = job_on(planar_grid(4, 4, 20, 20), "scallop_plane");
  job.scallop = 0.04;
  job.pattern = Pattern::planar;
  const PlanResult result = run_plan(job);
  ASSERT_TRUE(result.scallop);
  EXPECT_LE(result.scallop->measured.max, 1.01 * job.scallop);
  EXPECT_GT(result.scallop->measured.min, 0.8 * job.scallop);
}

ScallopMetric metric_of(const TriangleMesh& mesh) {
  return scallop_metric(mesh, FittedPart(mesh, 1).fit.curvatures, 10, 1);
}

TEST(ScallopPlan, SaysWhereTheBallDoesNotFit) {
  TriangleSoup soup = open_cylinder(60, 6, 8, 20).soup();
  for (Triangle& t : soup.triangles) std::swap(t[1], t[2]);
  const ScallopMetric metric = metric_of(TriangleMesh(std::move(soup)));
  EXPECT_NEAR(metric.gouged_fraction, 1, 1e-9);
  ASSERT_FALSE(metric.warnings.empty());
  EXPECT_NE(metric.warnings[0].find("does not fit"), std::string::npos);
  EXPECT_TRUE(metric_of(open_cylinder(60, 6, 8, 20)).warnings.empty());
}

TEST(ScallopPlan, LengthAndAreaInAMetric) {
  const TriangleMesh mesh = planar_grid(3, 3, 2, 2);
  std::vector<double> twice(mesh.edge_lengths().begin(), mesh.edge_lengths().end());
  for (double& l : twice) l *= 2;
  const IntrinsicGeometry metric(mesh, twice);
  EXPECT_NEAR(area_in(mesh, metric), 16, 1e-12);
  ImpactCurve curve;
  curve.points.resize(3);
  for (int i = 0; i < 3; ++i) curve.points[i].at = point_at_vertex(mesh, i);
  curve.points[2].kind = MoveKind::link;
  EXPECT_NEAR(cover_length(mesh, curve, metric), 2 * mesh.position(1).x(), 1e-12);
}

TEST(ScallopPlan, RefusesWhatMakesNoSense) {
  Job job;
  job.mesh = "part.off";
  job.scallop = 0.05;
  EXPECT_NO_THROW(job.validate());
  const auto refused = [&](auto change) {
    Job changed = job;
    change(changed);
    EXPECT_THROW(changed.validate(), Error);
  };
  refused([](Job& j) { j.spacing = 1; });
  refused([](Job& j) { j.scallop = -1; });
  refused([](Job& j) { j.scallop = 5; });
  refused([](Job& j) { j.tool.process = Process::spray; });
  const auto path = std::filesystem::path(testing::TempDir()) / "scallop_job.yaml";
  std::ofstream(path) << job_yaml(job, testing::TempDir());
  EXPECT_EQ(read_job(path).scallop, 0.05);
}

}  // namespace
}  // namespace isopath::test
