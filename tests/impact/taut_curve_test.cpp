#include "isopath/impact/taut_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "impact/curve_checks.h"
#include "isopath/field/exact_field.h"
#include "isopath/impact/cover_guard.h"
#include "isopath/impact/min_radius.h"

namespace isopath {
namespace {

/// A curve in the plane z = 0 through places, on the surface.
ImpactCurve curve_through(const SurfaceLinker& linker, const std::vector<Vec2>& places) {
  SurfaceCurve curve;
  for (const Vec2& p : places) {
    const SurfacePoint at = linker.locator().nearest(Vec3(p.x(), p.y(), 0)).at;
    curve.empty() ? curve.add(linker.mesh(), at) : linker.extend(curve, at);
  }
  ImpactCurve impact;
  for (std::size_t i = 0; i < curve.size(); ++i)
    impact.points.push_back({MoveKind::cover, curve.points[i], curve.positions[i], Vec3::UnitZ(), 0});
  return impact;
}

class TautCurve : public testing::Test {
 protected:
  TautCurve() : mesh_(test::planar_grid(20, 20, 20, 20)), locator_(mesh_), normals_(mesh_), linker_(mesh_, locator_) {}

  ExactField cover_of(const ImpactCurve& curve) const {
    SourceSet source;
    std::vector<SurfacePoint> points;
    for (const ImpactPoint& p : curve.points) points.push_back(p.at);
    source.add_polyline(mesh_, points, false);
    return ExactField::compute(mesh_, source);
  }

  TriangleMesh mesh_;
  SurfaceLocator locator_;
  SmoothNormals normals_;
  SurfaceLinker linker_;
};

TEST_F(TautCurve, GivesUpNothingThatItCovers) {
  // three passes, nearer than the spacing; the middle one makes a detour that covers nothing new
  ImpactCurve before = curve_through(
      linker_,
      {{1, 8.8}, {19, 8.8}, {19, 10}, {11, 10}, {10.5, 10.9}, {9.5, 10.9}, {9, 10}, {1, 10}, {1, 11.2}, {19, 11.2}});
  keep_min_radius(linker_, normals_, before, 0.16);
  ImpactCurve curve = before;
  const std::vector<Vec3> moved = draw_taut(linker_, normals_, curve, {.spacing = 2, .radius = 0.16});
  test::expect_valid(mesh_, curve);
  EXPECT_FALSE(moved.empty());
  EXPECT_LT(length_of(curve, MoveKind::cover), length_of(before, MoveKind::cover) - 0.1);
  EXPECT_EQ(curve.points.front().position, before.points.front().position);
  EXPECT_EQ(curve.points.back().position, before.points.back().position);

  const ExactField old_cover = cover_of(before);
  const ExactField cover = cover_of(curve);
  // samples are 0.04 apart, and what lies between is off by less than that
  for (double x = 0.05; x < 20; x += 0.1) {
    for (double y = 0.05; y < 20; y += 0.1) {
      const SurfacePoint at = locator_.nearest(Vec3(x, y, 0)).at;
      if (old_cover.value(at) > 1) continue;
      EXPECT_LE(cover.value(at), 1.04) << x << " " << y;
    }
  }
}

TEST_F(TautCurve, TurnsNoMoreTightlyThanAllowed) {
  std::vector<Vec2> places = {{2, 10}};
  for (double x = 5; x < 15; x += 1) places.insert(places.end(), {{x, 10.2}, {x + 0.5, 9.8}});
  places.push_back({18, 10});
  ImpactCurve curve = curve_through(linker_, places);
  const double radius = 0.3;
  keep_min_radius(linker_, normals_, curve, radius);
  const double length = length_of(curve, MoveKind::cover);
  draw_taut(linker_, normals_, curve, {.spacing = 2, .radius = radius});
  for (const TightPlace& place : tight_places(mesh_, curve, radius)) EXPECT_GE(place.radius, 0.9 * radius);
  EXPECT_LT(length_of(curve, MoveKind::cover), length);
}

TEST_F(TautCurve, LeavesStraightPassesAlone) {
  ImpactCurve curve = curve_through(linker_, {{1.3, 4.7}, {18.2, 4.7}});
  const std::vector<Vec3> moved = draw_taut(linker_, normals_, curve, {.spacing = 2, .radius = 0.16});
  EXPECT_TRUE(moved.empty());
  EXPECT_NEAR(length_of(curve, MoveKind::cover), 16.9, 1e-9);
}

TEST(CoverGuard, KeepsWhatOnlyOneSegmentReaches) {
  const TriangleMesh mesh = test::planar_grid(8, 8, 8, 8);
  // point 1 between two that stay; the rim of the part at y = 5 is covered where x is 4
  const std::vector<Vec3> points = {{4, 4, 0}, {3, 4, 0}, {5, 4, 0}};
  const auto guard = [&] {
    return CoverGuard(mesh, points, 1, {{1, 0}, {0, 2}}, {.reach = 1, .sample_size = 0.02, .most_moved = 0.3},
                      Progress::none());
  };
  CoverGuard up = guard();
  EXPECT_FALSE(up.try_move(0, Vec3(4, 4.2, 0))) << "takes what lies 1 below";
  EXPECT_EQ(up.point(0), Vec3(4, 4, 0));
  CoverGuard along = guard();
  EXPECT_TRUE(along.try_move(0, Vec3(4.3, 4, 0)));
  EXPECT_EQ(along.point(0), Vec3(4.3, 4, 0));
  // with a second line below, nothing is lost below; above, the curve comes nearer
  CoverGuard two(mesh, {{4, 4, 0}, {3, 4, 0}, {5, 4, 0}, {0, 3, 0}, {8, 3, 0}}, 1, {{1, 0}, {0, 2}, {3, 4}},
                 {.reach = 1, .sample_size = 0.02, .most_moved = 0.3}, Progress::none());
  EXPECT_TRUE(two.try_move(0, Vec3(4, 4.2, 0)));
  EXPECT_FALSE(two.try_move(0, Vec3(4, 3.8, 0))) << "takes what lies above";
}

}  // namespace
}  // namespace isopath
