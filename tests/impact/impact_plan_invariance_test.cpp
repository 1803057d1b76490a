#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "impact/curve_checks.h"
#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/impact/impact_plan.h"
#include "isopath/mesh/read_mesh.h"
#include "support/stop_at.h"

namespace isopath {
namespace {

/// The whole way from the mesh to the curve.
ImpactPlan plan(const TriangleMesh& mesh, double spacing, Progress& progress = Progress::none()) {
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh), {}, progress);
  return plan_impact(mesh, field, {.spacing = spacing}, progress);
}

TriangleMesh notched() { return test::notched_ellipse(16, 80, 60, 40); }

TriangleMesh patch() {
  return TriangleMesh(read_mesh(std::filesystem::path(ISOPATH_DATA_DIR) / "patch_100mm_a.off").soup);
}

void expect_same(const ImpactCurve& a, const ImpactCurve& b, double factor = 1) {
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    const ImpactPoint& p = a.points[i];
    const ImpactPoint& q = b.points[i];
    ASSERT_EQ(p.kind, q.kind) << "point " << i;
    ASSERT_EQ(p.piece, q.piece) << "point " << i;
    ASSERT_EQ(p.at.face, q.at.face) << "point " << i;
    ASSERT_EQ(p.at.barycentric, q.at.barycentric) << "point " << i;
    ASSERT_EQ(Vec3(factor * p.position), q.position) << "point " << i;
    ASSERT_EQ(p.normal, q.normal) << "point " << i;
  }
}

TEST(impact_plan_invariance, the_same_bytes_from_run_to_run_and_for_every_thread_count) {
  for (const TriangleMesh& mesh : {notched(), patch()}) {
    const ImpactCurve once = plan(mesh, 5).curve;
    const ImpactCurve again = plan(mesh, 5).curve;
    expect_same(once, again);
    for (const std::size_t threads : {1, 2}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      const ImpactCurve with = plan(mesh, 5).curve;
      expect_same(once, with);
      const GapReport a = measure_gap(mesh, once, 5);
      const GapReport b = measure_gap(mesh, with, 5);
      EXPECT_EQ(a.mean, b.mean);
      EXPECT_EQ(a.max, b.max);
      EXPECT_EQ(a.histogram, b.histogram);
    }
  }
}

TEST(impact_plan_invariance, a_part_in_another_unit_has_the_same_curve) {
  // Powers of two scale every number without rounding: any difference is a length that is not relative to the part.
  const TriangleMesh mesh = notched();
  const ImpactCurve curve = plan(mesh, 5).curve;
  for (const double factor : {1.0 / 1024, 1024.0}) {
    SCOPED_TRACE(testing::Message() << "factor " << factor);
    expect_same(curve, plan(test::scaled(mesh, factor), 5 * factor).curve, factor);
  }
}

/// Two plans of the same part differ by rounding at most: as many pieces, of the same length, equally good.
void expect_alike(const TriangleMesh& mesh, const ImpactCurve& curve, const TriangleMesh& other,
                  const ImpactCurve& other_curve, double factor) {
  EXPECT_EQ(test::pieces_of(curve), test::pieces_of(other_curve));
  for (const MoveKind kind : {MoveKind::cover, MoveKind::link, MoveKind::lift}) {
    const double length = factor * length_of(curve, kind);
    EXPECT_NEAR(length_of(other_curve, kind), length, 1e-3 * factor * length_of(curve, MoveKind::cover))
        << name_of(kind);
  }
  const GapReport a = measure_gap(mesh, curve, 5);
  const GapReport b = measure_gap(other, other_curve, 5 * factor);
  EXPECT_NEAR(b.mean, factor * a.mean, 1e-3 * factor * a.mean);
  EXPECT_NEAR(b.max, factor * a.max, 0.02 * factor * a.max);
}

TEST(impact_plan_invariance, a_part_in_millimetres_or_metres_is_planned_alike) {
  const TriangleMesh mesh = patch();
  const ImpactCurve curve = plan(mesh, 5).curve;
  for (const double factor : {1e-3, 1e3}) {
    SCOPED_TRACE(testing::Message() << "factor " << factor);
    const TriangleMesh other = test::scaled(mesh, factor);
    expect_alike(mesh, curve, other, plan(other, 5 * factor).curve, factor);
  }
}

TEST(impact_plan_invariance, a_moved_part_has_the_moved_curve) {
  const TriangleMesh mesh = patch();
  const ImpactCurve curve = plan(mesh, 5).curve;
  const Vec3 axis = Vec3(1, -2, 0.5).normalized();
  const Vec3 translation(130, -70, 15);
  const TriangleMesh other = test::moved(mesh, axis, 1.1, translation);
  const ImpactCurve moved = plan(other, 5).curve;
  expect_alike(mesh, curve, other, moved, 1);
  // and lies where it lay: both begin at the same place of the part
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, axis).toRotationMatrix();
  EXPECT_LE((rotation * curve.points[0].position + translation - moved.points[0].position).norm(), 1e-6);
  EXPECT_LE((rotation * curve.points[0].normal - moved.points[0].normal).norm(), 1e-6);
}

/// Counts how often it is asked in every stage.
class CountChecks final : public Progress {
 public:
  void stage(std::string_view name) override { now_ = &checks_[std::string(name)]; }
  bool cancelled() const override {
    ++*now_;
    return false;
  }
  const std::map<std::string, std::atomic<long>>& checks() const { return checks_; }

 private:
  std::map<std::string, std::atomic<long>> checks_;
  std::atomic<long>* now_ = &checks_["before the first stage"];
};

TEST(impact_plan_invariance, asks_in_every_stage_whether_to_stop) {
  const TriangleMesh mesh = notched();
  CountChecks progress;
  measure_gap(mesh, plan(mesh, 5, progress).curve, 5, progress);
  for (const char* stage : {"isolines", "curve", "wide gaps", "gap"}) {
    const auto found = progress.checks().find(stage);
    ASSERT_NE(found, progress.checks().end()) << stage;
    EXPECT_GT(found->second, 0) << stage;
  }
}

TEST(impact_plan_invariance, stops_whenever_it_is_asked_to) {
  const TriangleMesh mesh = test::notched_ellipse(10, 48, 60, 40);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  constexpr long never = 1L << 40;
  const test::StopAt* counter = nullptr;
  test::StopAt all(never);
  counter = &all;
  const ImpactCurve curve = plan(mesh, 5, all).curve;
  measure_gap(mesh, curve, 5, all);
  const long asked = counter->asked_since(never);
  ASSERT_GT(asked, 10);
  test::Rng rng(3);
  for (int k = 0; k < 25; ++k) {
    const long at = k == 0 ? 1 : k == 1 ? asked : 1 + test::random_index(rng, static_cast<Index>(asked));
    test::StopAt progress(at);
    try {
      const ImpactCurve whole = plan(mesh, 5, progress).curve;
      measure_gap(mesh, whole, 5, progress);
      ADD_FAILURE() << "went on after check " << at << " of " << asked;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::cancelled) << error.what();
    }
  }
}

}  // namespace
}  // namespace isopath
