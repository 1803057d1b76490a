#include "isopath/plan/partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <vector>

#include "isopath/contour/medial_cuts.h"
#include "isopath/core/error.h"
#include "isopath/impact/gap.h"
#include "isopath/mesh/sub_mesh.h"
#include "isopath/mesh/surface_walk.h"
#include "isopath/plan/patch_links.h"
#include "isopath/plan/patch_plans.h"
#include "isopath/plan/run_plan.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

/// Two squares of side 10 joined by a bar 15 long and 4 wide.
TriangleMesh dumbbell() {
  return test::planar_cells(35, 10, [](int i, int j) { return i < 10 || i >= 25 || (j >= 3 && j < 7); });
}

std::vector<double> areas_of(const Partition& parts) {
  std::vector<double> areas(parts.n_patches, 0);
  for (Index f = 0; f < parts.mesh.n_faces(); ++f) areas[parts.patch_of_face[f]] += parts.mesh.face_area(f);
  std::sort(areas.begin(), areas.end());
  return areas;
}

/// Labels count up from 0 by lowest face, patches hang together, and the surface is the same.
void expect_partition(const TriangleMesh& mesh, const Partition& parts) {
  EXPECT_NEAR(parts.mesh.area(), mesh.area(), 1e-9 * mesh.area());
  ASSERT_EQ(parts.patch_of_face.size(), static_cast<std::size_t>(parts.mesh.n_faces()));
  Index n = 0;
  for (const Index patch : parts.patch_of_face) {
    ASSERT_LE(patch, n);
    n = std::max(n, patch + 1);
  }
  EXPECT_EQ(n, parts.n_patches);
  for (const SubMesh& patch : split_mesh(parts.mesh, parts.patch_of_face)) EXPECT_EQ(patch.mesh.n_components(), 1);
  for (Index v = 0; v < mesh.n_vertices(); ++v) EXPECT_EQ(parts.mesh.position(v), mesh.position(v));
}

TEST(Partition, CreasesPartTheSidesOfACube) {
  const TriangleMesh mesh = test::cube(4, 6);
  const Partition parts = partition(mesh, 0.5, {.by = PartitionBy::creases});
  expect_partition(mesh, parts);
  EXPECT_EQ(parts.n_patches, 6);
  for (const double area : areas_of(parts)) EXPECT_NEAR(area, 36, 1e-9);
  EXPECT_EQ(partition(mesh, 0.5, {.by = PartitionBy::creases, .crease_angle = 1.6}).n_patches, 1);
  EXPECT_EQ(partition(mesh, 0.5, {}).n_patches, 1);
}

TEST(Partition, ACreaseThatLeadsNowherePartsNothing) {
  // A sheet whose fold flattens out: its faces are sharp on one side only.
  const TriangleMesh mesh = test::height_grid(
      20, 20, 20, 20, [](double x, double y) { return std::max(0.0, y - 10) * -0.4 * std::abs(x - 10); });
  const Partition parts = partition(mesh, 0.5, {.by = PartitionBy::creases});
  EXPECT_EQ(parts.n_patches, 1);
}

TEST(Partition, PatchesTooNarrowForAPassGoToANeighbour) {
  const TriangleMesh mesh = test::box(Vec3::Zero(), Vec3(20, 20, 0.5));
  EXPECT_EQ(partition(mesh, 0.1, {.by = PartitionBy::creases}).n_patches, 6);
  const Partition parts = partition(mesh, 1, {.by = PartitionBy::creases});
  expect_partition(mesh, parts);
  ASSERT_EQ(parts.n_patches, 2) << "the two large sides";
  for (const double area : areas_of(parts)) EXPECT_GE(area, 400);
}

TEST(Partition, TheMedialAxisPartsRoomsFromTheNeckBetweenThem) {
  const Partition parts = partition(dumbbell(), 0.5, {.by = PartitionBy::medial});
  expect_partition(dumbbell(), parts);
  ASSERT_EQ(parts.n_patches, 3);
  const std::vector<double> areas = areas_of(parts);
  EXPECT_NEAR(areas[0], 60, 1e-6);
  EXPECT_NEAR(areas[1], 100, 1e-6);
  EXPECT_NEAR(areas[2], 100, 1e-6);
}

TEST(Partition, AnArmIsPartedFromAWiderOneAndNotFromAnEqualOne) {
  const auto ell = [](int width) {
    return test::planar_cells(30, 25, [width](int i, int j) { return i < 10 || j < width; });
  };
  const Partition uneven = partition(ell(4), 0.5, {.by = PartitionBy::medial});
  expect_partition(ell(4), uneven);
  ASSERT_EQ(uneven.n_patches, 2);
  EXPECT_NEAR(areas_of(uneven)[0], 20 * 4, 8);
  EXPECT_EQ(partition(ell(10), 0.5, {.by = PartitionBy::medial}).n_patches, 1);
}

TEST(Partition, EvenShapesStayWhole) {
  EXPECT_EQ(partition(test::planar_grid(10, 10, 10, 10), 0.3, {.by = PartitionBy::medial}).n_patches, 1);
  EXPECT_EQ(partition(test::planar_grid(40, 4, 40, 4), 0.3, {.by = PartitionBy::medial}).n_patches, 1);
  EXPECT_EQ(partition(test::hemisphere(10, 40, 10), 0.3, {.by = PartitionBy::medial}).n_patches, 1);
  EXPECT_EQ(partition(test::open_cylinder(24, 8, 5, 10), 0.3, {.by = PartitionBy::both}).n_patches, 1);
  EXPECT_EQ(partition(test::icosphere(2, 5), 0.3, {.by = PartitionBy::both}).n_patches, 1);
}

TEST(Partition, AnyMeshIsPartedIntoPatchesThatHangTogether) {
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    const TriangleMesh mesh = test::random_mesh(rng, {.min_faces = 6, .max_faces = 60, .closed = seed % 4 == 0});
    const PartitionOptions options{.by = PartitionBy::both, .crease_angle = 0.6, .unevenness = 1.2};
    expect_partition(mesh, partition(mesh, 0.01 * mesh.size(), options));
  }
}

TEST(Partition, RefusesWhatItCannotUse) {
  const TriangleMesh mesh = test::planar_grid(2, 2, 2, 2);
  EXPECT_THROW(partition(mesh, 0, {}), Error);
  EXPECT_THROW(partition(mesh, 1, {.crease_angle = 0}), Error);
  EXPECT_THROW(partition(mesh, 1, {.unevenness = 1}), Error);
}

TEST(Partition, RefusesAnAngleThatTakesEveryEdgeForACrease) {
  const TriangleMesh sphere = test::icosphere(3, 10);  // 1280 triangles, with angles of some degrees between them
  EXPECT_EQ(partition(sphere, 1e-3, {.by = PartitionBy::creases}).n_patches, 1);
  try {
    partition(sphere, 1e-3, {.by = PartitionBy::creases, .crease_angle = 1e-3});
    FAIL() << "1280 patches";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::no_plan);
    EXPECT_NE(error.where().value.find("1280 patches"), std::string::npos);
  }
}

TEST(MedialCuts, RunFromBoundaryToBoundaryAndAreShort) {
  const TriangleMesh mesh = dumbbell();
  const MedialCuts cuts = medial_cuts(ExactField::compute(mesh, boundary_source(mesh)));
  EXPECT_NEAR(cuts.least_clearance, 2, 1e-6);
  ASSERT_EQ(cuts.lines.size(), 2u);
  for (const auto& line : cuts.lines) {
    double length = 0;
    for (std::size_t i = 1; i < line.size(); ++i) {
      ASSERT_NE(common_face(mesh, line[i - 1], line[i]), no_index);
      length += (position_of(mesh, line[i]) - position_of(mesh, line[i - 1])).norm();
    }
    EXPECT_NEAR(length, 4, 1e-6) << "across the mouth of the bar";
  }
}

/// A curve that a tool can follow: it only leaves the surface in lifts.
void expect_curve(const TriangleMesh& mesh, const ImpactCurve& curve) {
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    const ImpactPoint& a = curve.points[i - 1];
    const ImpactPoint& b = curve.points[i];
    if (b.kind == MoveKind::lift) continue;
    ASSERT_EQ(a.piece, b.piece) << i;
    ASSERT_NE(common_face(mesh, a.at, b.at), no_index) << i;
    EXPECT_NEAR((position_of(mesh, b.at) - b.position).norm(), 0, 1e-9 * mesh.size());
  }
}

PatchedPlan plan_parts(const Partition& parts, double spacing, std::optional<Pattern> pattern = {}) {
  Job job;
  job.pattern = pattern;
  job.report = false;
  return plan_patches(parts, job, spacing);
}

TEST(PatchPlans, CoverEverySideOfACubeInOnePiece) {
  const Partition parts = partition(test::cube(4, 20), 2, {.by = PartitionBy::creases});
  const double spacing = 3;
  const PatchedPlan plan = plan_parts(parts, spacing, Pattern::two_way);
  expect_curve(parts.mesh, plan.impact.curve);
  ASSERT_EQ(plan.patches.size(), 6u);
  for (const PatchFigures& patch : plan.patches) {
    EXPECT_NEAR(patch.area, 400, 1e-9);
    EXPECT_GE(patch.covered_fraction, 0.99);
    EXPECT_EQ(patch.pieces, 1);
  }
  EXPECT_EQ(plan.impact.curve.points.back().piece, 0) << "closed curves need no lift";
  const GapReport gap = measure_gap(parts.mesh, plan.impact.curve, spacing);
  EXPECT_GE(gap.covered_fraction, 0.99);
  // On every side the distance is that from the nearest of its edges.
  for (Index v = 0; v < parts.mesh.n_vertices(); ++v) {
    const Vec3 inside = parts.mesh.position(v).cwiseMin((Vec3::Constant(20) - parts.mesh.position(v)).eval());
    std::array<double, 3> sorted = {inside.x(), inside.y(), inside.z()};
    std::sort(sorted.begin(), sorted.end());
    EXPECT_NEAR(plan.distances[v], sorted[1], 1e-9);
  }
}

TEST(PatchPlans, FacesCarryTheNumberOfTheirPatchInTheOrderOfWork) {
  const Partition parts = partition(dumbbell(), 1, {.by = PartitionBy::medial});
  const PatchedPlan plan = plan_parts(parts, 1);
  expect_curve(parts.mesh, plan.impact.curve);
  std::vector<double> area(plan.patches.size(), 0);
  std::map<Index, Index> number;
  for (Index f = 0; f < parts.mesh.n_faces(); ++f) {
    area[plan.patch_of_face[f]] += parts.mesh.face_area(f);
    const auto [known, fresh] = number.try_emplace(parts.patch_of_face[f], plan.patch_of_face[f]);
    EXPECT_EQ(known->second, plan.patch_of_face[f]);
  }
  for (std::size_t p = 0; p < area.size(); ++p) EXPECT_NEAR(area[p], plan.patches[p].area, 1e-9);
  // The first point of the curve lies in the first patch.
  EXPECT_EQ(plan.patch_of_face[plan.impact.curve.points.front().at.face], 0);
  EXPECT_GE(measure_gap(parts.mesh, plan.impact.curve, 1).covered_fraction, 0.99);
}

TEST(PatchPlans, ChainsKeepAllThatCovers) {
  for (const Pattern pattern : {Pattern::spiral, Pattern::two_way, Pattern::contour, Pattern::planar}) {
    SCOPED_TRACE(name_of(pattern));
    const Partition parts = partition(test::cube(4, 10), 1.5, {.by = PartitionBy::creases});
    const PatchedPlan plan = plan_parts(parts, 1.5, pattern);
    expect_curve(parts.mesh, plan.impact.curve);
    double length = 0;
    for (const PatchFigures& patch : plan.patches) length += patch.cover_length;
    EXPECT_NEAR(length_of(plan.impact.curve, MoveKind::cover), length, 1e-6 * length);
    for (std::size_t i = 1; i < plan.impact.curve.points.size(); ++i) {
      const bool lifts =
          plan.impact.curve.points[i].kind == MoveKind::lift && plan.impact.curve.points[i - 1].kind != MoveKind::lift;
      EXPECT_EQ(plan.impact.curve.points[i].piece - plan.impact.curve.points[i - 1].piece, lifts ? 1 : 0);
    }
  }
}

TEST(PatchPlans, PicturesHaveTheirOwnVerticesOnBorders) {
  const Partition parts = partition(test::cube(2, 4), 0.5, {.by = PartitionBy::creases});
  Job job;
  job.pattern = Pattern::contour;  // the least work: whatever covers it, the picture is the same
  const DisplaySurface shown = plan_patches(parts, job, 0.5).display;
  EXPECT_NEAR(shown.refined.mesh.area(), parts.mesh.area(), 1e-9);
  std::map<Index, Index> patch_of_vertex;
  for (Index f = 0; f < shown.refined.mesh.n_faces(); ++f) {
    const Index patch = parts.patch_of_face[shown.refined.old_face[f]];
    for (const Index v : shown.refined.mesh.triangle(f)) {
      EXPECT_EQ(patch_of_vertex.try_emplace(v, patch).first->second, patch);
      const Vec3& place = shown.refined.mesh.position(v);
      EXPECT_NEAR((position_of(parts.mesh, shown.refined.on_old[v]) - place).norm(), 0, 1e-12);
      // from the middle of a side it is 2 to its border, by the largest coordinate in it
      const Vec3 q = (place - Vec3::Constant(2)).cwiseAbs();
      const double second = q.sum() - q.maxCoeff() - q.minCoeff();
      EXPECT_NEAR(shown.distances[v], 2 - second, 1e-4) << place.transpose();
    }
  }
}

/// What a patch is planned with besides its spacing is what a part may be planned with.
TEST(PatchPlans, MayBeSmoothedBlendedAndMeasuredByScallops) {
  TriangleSoup soup = test::planar_grid(8, 4, 24, 12).soup();
  for (Vec3& p : soup.positions) {
    if (p.x() > 12) p = Vec3(12, p.y(), p.x() - 12);
  }
  const TriangleMesh mesh(std::move(soup));
  struct Case {
    const char* name;
    double smooth;
    double scallop;
    Blending blend;
  };
  for (const Case& c : {Case{"smooth", 3, 0, Blending::automatic}, Case{"scallop", 0, 0.2, Blending::automatic},
                        Case{"blend", 0, 0, Blending::least}, Case{"smooth and scallop", 3, 0.2, Blending::none}}) {
    Job job;
    job.mesh = std::filesystem::path(testing::TempDir()) / "patches_combined.off";
    test::write_off(mesh, job.mesh);
    job.partition.by = PartitionBy::creases;
    job.report = false;
    job.smooth = c.smooth;
    job.scallop = c.scallop;
    job.blend = c.blend;
    if (c.scallop == 0) job.spacing = 3;
    const PlanResult result = run_plan(job);
    EXPECT_EQ(result.patches.size(), 2U) << c.name;
    EXPECT_EQ(result.figures.lifts, 0) << c.name;
    EXPECT_LE(result.gap.max, 1.05 * result.spacing) << c.name;
    EXPECT_GT(result.gap.covered_fraction, 0.999) << c.name;
    expect_curve(result.part.mesh, result.impact.curve);
  }
}

}  // namespace
}  // namespace isopath
