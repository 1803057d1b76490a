#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/field/exact_distances.h"
#include "isopath/impact/gap_repair.h"
#include "isopath/plan/level_density.h"
#include "isopath/plan/plan_outputs.h"
#include "isopath/plan/run_plan.h"
#include "isopath/plan/smooth_part.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

Job smooth_job_on(const TriangleMesh& mesh, const std::string& name) {
  Job job;
  job.mesh = std::filesystem::path(testing::TempDir()) / (name + ".off");
  job.sources = {{.kind = SourceSpec::Kind::boundary}};
  job.pattern = Pattern::spiral;
  job.report = false;
  write_off(mesh, job.mesh);
  return job;
}

TEST(SmoothPart, KeepsTheZeroSetAndRoundsRidges) {
  const TriangleMesh mesh = planar_grid(40, 40, 40, 40, {.jitter = 0.2});
  const std::vector<double> exact = exact_distances(mesh, boundary_source(mesh));
  const std::vector<double> smooth = smoothed_distances(mesh, nullptr, exact, 3);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    EXPECT_EQ(smooth[v] == 0, mesh.is_boundary_vertex(v));
    const Vec3& p = mesh.position(v);
    const double ridge = std::abs(std::min(p.x(), 40 - p.x()) - std::min(p.y(), 40 - p.y()));
    // near a side and far from ridges distances are linear: they are only stretched for the volume's sake
    if (exact[v] > 0 && exact[v] < 8 && ridge > 15) {
      EXPECT_NEAR(smooth[v] / exact[v], 1.04, 0.04) << p.transpose();
    }
    // with a single width everywhere a ridge of a right angle would sink by 2 sigma / sqrt(pi) * 1 / sqrt(2)
    if (ridge < 1e-9 && exact[v] > 10) {
      EXPECT_LT(smooth[v], exact[v] * 1.08 - 1) << p.transpose();
    }
  }
}

TEST(SmoothPart, AWidthBeyondThePartIsThatOfThePart) {
  const TriangleMesh mesh = wavy_sheet(15, 10, 0.5, 1, 1, 3);
  const std::vector<double> exact = exact_distances(mesh, boundary_source(mesh));
  EXPECT_EQ(smoothed_distances(mesh, nullptr, exact, 1e3), smoothed_distances(mesh, nullptr, exact, 1e9));
}

TEST(SmoothPart, SamplesAreTheFieldAndRidgesItsMedialAxis) {
  const TriangleMesh mesh = planar_grid(3, 3, 30, 30);
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  const FieldSamples samples = sample_for_smoothing(field, 2);
  const TriangleMesh& finer = samples.refined.mesh;
  for (Index v = 0; v < finer.n_vertices(); ++v) {
    const Vec3& p = finer.position(v);
    EXPECT_NEAR(samples.distances[v], std::min({p.x(), p.y(), 30 - p.x(), 30 - p.y()}), 1e-12);
  }
  double length = 0;
  for (const std::vector<SurfacePoint>& ridge : samples.ridges) {
    for (std::size_t i = 0; i < ridge.size(); ++i) {
      const Vec3 p = position_of(mesh, ridge[i]);
      EXPECT_NEAR(std::min(p.x(), 30 - p.x()), std::min(p.y(), 30 - p.y()), 1e-6);
      if (i > 0) length += (p - position_of(mesh, ridge[i - 1])).norm();
    }
  }
  EXPECT_NEAR(length, 2 * std::sqrt(2.0) * 30, 1e-6);
}

TEST(SmoothPart, LengthsOfAFinerMeshAreThoseOfTheMetric) {
  const TriangleMesh mesh = wavy_sheet(8, 10, 1, 1, 1, 3);
  std::vector<double> stretched(mesh.edge_lengths().begin(), mesh.edge_lengths().end());
  for (double& length : stretched) length *= 3;
  const IntrinsicGeometry metric(mesh, stretched);
  const RefinedMesh refined = refine_for_smoothing(mesh, 0.8, 5);
  EXPECT_GT(refined.mesh.n_faces(), 2 * mesh.n_faces());
  const std::vector<double> lengths = lengths_in(mesh, metric, refined);
  for (Index e = 0; e < refined.mesh.n_edges(); ++e) {
    EXPECT_LE(refined.mesh.edge_length(e), 0.4);
    EXPECT_NEAR(lengths[e], 3 * refined.mesh.edge_length(e), 1e-12 * mesh.size());
  }
}

TEST(LevelDensity, GivesSlopeOneAlongHalfOfEachLevel) {
  // two plates: slope 1/2 along 30 mm of every level, 2 along 10 mm
  TriangleSoup soup = planar_grid(40, 30, 40, 30).soup();
  const Index n = static_cast<Index>(soup.positions.size());
  const TriangleMesh steep = planar_grid(40, 10, 40, 10);
  for (const Vec3& p : steep.soup().positions) soup.positions.emplace_back(p + Vec3(0, 100, 0));
  for (const auto& [a, b, c] : steep.soup().triangles) soup.triangles.push_back({a + n, b + n, c + n});
  const TriangleMesh mesh(std::move(soup));
  std::vector<double> values;
  for (Index v = 0; v < mesh.n_vertices(); ++v) values.push_back((v < n ? 0.5 : 2) * mesh.position(v).x());
  const VertexField function(mesh, values);
  const VertexField even = LevelDensity(function, IntrinsicGeometry(mesh), 1).applied();
  for (Index v = 0; v < n; ++v) {
    if (mesh.position(v).x() < 39) {
      EXPECT_NEAR(even.values()[v], mesh.position(v).x(), 1e-9);
    }
  }
}

TEST(LevelDensity, RisesOnlyWhereGapsAreTooWide) {
  const TriangleMesh mesh = planar_grid(40, 4, 40, 4);
  const VertexField function = height_field(mesh, Vec3::UnitX());
  LevelDensity density(function, IntrinsicGeometry(mesh), 2);
  std::vector<double> gaps(mesh.n_vertices(), 2.0);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (std::abs(mesh.position(v).x() - 20) < 0.5) gaps[v] = 3;
  }
  density.raise(gaps, 2.5);
  const VertexField raised = density.applied();
  const auto at = [&](int x) { return raised.values()[2 * 41 + x]; };
  for (int x = 0; x < 40; ++x) {
    const double step = at(x + 1) - at(x);
    if (x < 17 || x > 22) {
      EXPECT_NEAR(step, 1, 1e-9) << x;
    } else if (x == 20) {
      EXPECT_NEAR(step, 3 / 2.5, 1e-9) << x;
    }
    EXPECT_GT(step, 1 - 1e-9);
  }
  for (int round = 0; round < 9; ++round) density.raise(gaps, 2.5);
  const VertexField most = density.applied();
  EXPECT_NEAR(most.values()[2 * 41 + 21] - most.values()[2 * 41 + 20], 2, 1e-9);
}

TEST(SmoothPlan, RoundsCornersAndClosesTheGaps) {
  struct Case {
    const char* name;
    TriangleMesh mesh;
    Pattern pattern;
  };
  for (const auto& [name, mesh, pattern] : {Case{"smooth_square", planar_grid(8, 8, 48, 48), Pattern::spiral},
                                            Case{"smooth_l", scaled(l_shape(10), 3), Pattern::spiral}}) {
    Job job = smooth_job_on(mesh, name);
    job.pattern = pattern;
    job.spacing = 4;
    job.blend = Blending::none;
    const PlanResult sharp = run_plan(job);
    job.smooth = 4;
    const PlanResult smooth = run_plan(job);
    EXPECT_LT(smooth.figures.sharp_corners, 0.2 * sharp.figures.sharp_corners) << name;
    EXPECT_LT(smooth.figures.tight_turns, 0.5 * sharp.figures.tight_turns) << name;
    EXPECT_LE(smooth.figures.lifts, sharp.figures.lifts) << name;
    EXPECT_LE(smooth.gap.max, 1.05 * job.spacing) << name;
    EXPECT_GT(smooth.gap.covered_fraction, 0.999) << name;
    EXPECT_EQ(smooth.part.mesh.n_faces(), mesh.n_faces()) << name << ": finer meshes are for the function alone";
    EXPECT_EQ(smooth.distances.size(), static_cast<std::size_t>(mesh.n_vertices())) << name;
    EXPECT_LT(smooth.length_ratio, 1.5 * sharp.length_ratio) << name;
    EXPECT_FALSE(sharp.smoothing);
    ASSERT_TRUE(smooth.smoothing);
    EXPECT_GT(smooth.smoothing->gap_before, 1.15 * job.spacing) << name;
    // what was chosen is the path that came out, and no other way that was planned costs less
    const auto cost = [&](const GapRepairCost& way) {
      return way.length + job.spacing * (20 * way.lifts + 5 * way.tight_turns);
    };
    const auto& ways = smooth.smoothing->costs;
    const auto chosen =
        std::find_if(ways.begin(), ways.end(), [&](const auto& way) { return way.repair == smooth.smoothing->repair; });
    ASSERT_NE(chosen, ways.end());
    EXPECT_NEAR(chosen->length, smooth.figures.cover_length + smooth.figures.links_length, 1e-9 * chosen->length);
    EXPECT_EQ(chosen->tight_turns, smooth.figures.tight_turns);
    for (const GapRepairCost& way : ways) {
      if (way.planned) {
        EXPECT_LE(cost(*chosen), cost(way)) << name;
      }
    }
    const auto summary = nlohmann::json::parse(summary_json(smooth));
    EXPECT_EQ(summary["smoothing"]["repair"], name_of(*smooth.smoothing->repair));
    EXPECT_EQ(summary["smoothing"]["ways"].size(), ways.size());
  }
}

TEST(SmoothPlan, WorksWithEveryPatternSourceAndMetric) {
  Job job = smooth_job_on(planar_grid(8, 6, 40, 30), "smooth_patterns");
  job.spacing = 4;
  job.smooth = 5;
  const auto expect_covered = [](const PlanResult& result) {
    const bool as_they_are = result.pattern == Pattern::contour;
    EXPECT_GT(result.gap.covered_fraction, as_they_are ? 0.98 : 0.999);
    EXPECT_LE(result.gap.max, (as_they_are ? 1.17 : 1.05) * result.spacing);
  };
  job.pattern = Pattern::contour;
  expect_covered(run_plan(job));
  job.pattern = Pattern::two_way;
  const PlanResult two_way = run_plan(job);
  expect_covered(two_way);
  EXPECT_EQ(two_way.figures.lifts, 0);
  job.pattern = std::nullopt;
  job.sources = {{.kind = SourceSpec::Kind::point, .numbers = {21, 17, 0}}};
  expect_covered(run_plan(job));
  job.sources = {{.kind = SourceSpec::Kind::boundary}};
  job.spacing = 0;
  job.scallop = 0.4;
  expect_covered(run_plan(job));
}

TEST(SmoothPlan, IsTheSameEveryTime) {
  Job job = smooth_job_on(planar_grid(5, 5, 24, 18), "smooth_same");
  job.spacing = 3;
  job.smooth = 4;
  const PlanResult first = run_plan(job);
  const PlanResult second = run_plan(job);
  ASSERT_EQ(first.impact.curve.points.size(), second.impact.curve.points.size());
  for (std::size_t i = 0; i < first.impact.curve.points.size(); ++i) {
    ASSERT_EQ(first.impact.curve.points[i].position, second.impact.curve.points[i].position);
  }
}

TEST(SmoothPlan, RefusesWhatItCannotSmooth) {
  Job job = smooth_job_on(planar_grid(2, 2, 20, 20), "smooth_refused");
  job.smooth = -1;
  EXPECT_THROW(job.validate(), Error);
  job.smooth = 1e-9;
  job.spacing = 2;
  EXPECT_THROW(run_plan(job), Error) << "too little to round anything";
  job.smooth = 2;
  EXPECT_NO_THROW(job.validate());
  for (const Pattern pattern : {Pattern::planar, Pattern::double_spiral}) {
    job.pattern = pattern;
    EXPECT_THROW(job.validate(), Error);
  }
  job.pattern = Pattern::spiral;
  job.blend = Blending::least;
  EXPECT_THROW(job.validate(), Error);
}

}  // namespace
}  // namespace isopath::test
