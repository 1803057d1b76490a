#include "isopath/impact/trochoid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/vertex_field.h"
#include "isopath/impact/gap.h"
#include "isopath/impact/min_radius.h"
#include "isopath/mesh/straight_walk.h"
#include "isopath/mesh/surface_locator.h"
#include "isopath/mesh/surface_walk.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

constexpr double full_turn = 2 * std::numbers::pi;

/// The centres move evenly along the guide, and the spokes, as plane vectors, turn evenly and are a radius long.
void expect_even_circles(const std::vector<Vec2>& spokes, double radius) {
  ASSERT_GT(spokes.size(), 10u);
  const auto turn = [&](std::size_t k) {
    return std::atan2(cross(spokes[k - 1], spokes[k]), spokes[k - 1].dot(spokes[k]));
  };
  for (std::size_t k = 1; k < spokes.size(); ++k) {
    EXPECT_NEAR(spokes[k].norm(), radius, 1e-8 * radius) << k;
    EXPECT_NEAR(turn(k), turn(1), 1e-7) << k;
  }
  const double turns = turn(1) * static_cast<double>(spokes.size() - 1) / full_turn;
  EXPECT_NEAR(turns, std::round(turns), 1e-5) << "whole turns";
  EXPECT_GT(turns, 0.5) << "counter-clockwise";
}

TEST(Trochoid, OnAPlaneSpokesTurnEvenlyWhateverCornersTheGuideHas) {
  const TriangleMesh mesh = test::planar_grid(30, 30, 60, 60, {.jitter = 0.2});
  const SurfaceLocator locator(mesh);
  const SurfaceLinker linker(mesh, locator);
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    SurfaceCurve guide;
    const auto random_place = [&] {
      return locator.nearest(Vec3(test::random_real(rng, 15, 45), test::random_real(rng, 15, 45), 0)).at;
    };
    const SurfacePoint first = random_place();
    guide.add(mesh, first);
    for (int i = 0; i < 3; ++i) linker.extend(guide, random_place());
    if (seed % 2 == 0) linker.extend(guide, first);
    const double radius = test::random_real(rng, 0.5, 10);
    const std::vector<CirclePoint> trace =
        trochoid(mesh, guide, Vec3(test::random_real(rng, 0, 60), 30, 0), {radius, test::random_real(rng, 1, 8), 0});
    std::vector<Vec2> spokes;
    for (const CirclePoint& p : trace) {
      spokes.emplace_back((position_of(mesh, p.at) - position_of(mesh, p.centre)).head<2>());
    }
    expect_even_circles(spokes, radius);
    if (seed % 2 == 0) {
      EXPECT_EQ(position_of(mesh, trace.back().at), position_of(mesh, trace.front().at));
    }
    // The chords stay within the default tolerance of the circles.
    for (std::size_t k = 1; k < spokes.size(); ++k) {
      EXPECT_GE((spokes[k] + spokes[k - 1]).norm() / 2, radius * (1 - 1.0 / 500) - 1e-9);
    }
  }
}

TEST(Trochoid, OnACylinderItIsThatOfThePlaneInTheDevelopment) {
  const int sides = 48;
  const TriangleMesh mesh = test::open_cylinder(sides, 20, 10, 60);
  const double chord = 2 * 10 * std::sin(std::numbers::pi / sides);
  // Position round the prism, as if it were laid out flat.
  const auto developed = [&](const SurfacePoint& at) {
    const Vec3 p = position_of(mesh, at);
    const double step = full_turn / sides;
    double angle = std::atan2(p.y(), p.x());
    angle -= full_turn * std::floor(angle / full_turn);
    const double side = std::floor(angle / step + 1e-12);
    const Vec2 a(10 * std::cos(side * step), 10 * std::sin(side * step));
    const Vec2 b(10 * std::cos((side + 1) * step), 10 * std::sin((side + 1) * step));
    return Vec2((side + (p.head<2>() - a).dot(b - a) / (b - a).squaredNorm()) * chord, p.z());
  };
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    SurfacePoint from = test::random_surface_point(rng, mesh);
    while (std::abs(position_of(mesh, from).z() - 30) > 5) from = test::random_surface_point(rng, mesh);
    // Round the cylinder and a little up or down.
    const Vec3 around = Vec3::UnitZ().cross(mesh.face_normal(from.face));
    const Vec3 along = around + test::random_real(rng, -0.2, 0.2) * Vec3::UnitZ();
    const SurfaceCurve guide = make_curve(mesh, straight_walk(mesh, from, along, 0, 60).points);
    const double radius = test::random_real(rng, 1, 8);
    std::vector<Vec2> spokes;
    for (const CirclePoint& p : trochoid(mesh, guide, Vec3(0, 0, 60), {radius, 4, 0})) {
      Vec2 spoke = developed(p.at) - developed(p.centre);
      spoke.x() = std::remainder(spoke.x(), sides * chord);
      spokes.push_back(spoke);
    }
    expect_even_circles(spokes, radius);
  }
}

TEST(Trochoid, AClosedGuideOnACurvedSurfaceGivesAClosedTraceWithoutAJump) {
  const TriangleMesh mesh = test::hemisphere(24, 96, 20);
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  for (const double level : {8.0, 14.0, 20.0}) {
    const std::vector<Contour> rings = isolines(mesh, field, std::array{level});
    ASSERT_EQ(rings.size(), 1u);
    const SurfaceCurve guide = closed_from(mesh, rings[0], Vec3(20, 0, 0));
    const CircleOptions circle{.radius = 3, .step = 2};
    const std::vector<CirclePoint> trace = trochoid(mesh, guide, Vec3(20, 0, 0), circle);
    double longest = 0;
    double sum = 0;
    for (std::size_t k = 1; k < trace.size(); ++k) {
      const double step = (position_of(mesh, trace[k].at) - position_of(mesh, trace[k - 1].at)).norm();
      longest = std::max(longest, step);
      sum += step;
    }
    EXPECT_LT(longest, 2 * sum / static_cast<double>(trace.size() - 1));
    EXPECT_EQ(position_of(mesh, trace.front().at), position_of(mesh, trace.back().at));
  }
}

TEST(Trochoid, TurnsNoTighterThanItsTightestRadius) {
  test::Rng rng(5);
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(i);
    const double step = test::random_real(rng, 0.1, 10);
    const double tightest = test::random_real(rng, 0.1, 20);
    const double radius = circle_radius_for(tightest, step);
    EXPECT_NEAR(tightest_radius({radius, step, 0}), tightest, 1e-9 * radius);
    double found = infinity;
    for (int k = 0; k < 720; ++k) {  // c(t) = (v t, 0) + r (cos t, sin t)
      const double t = full_turn * k / 720;
      const Vec2 first(step / full_turn - radius * std::sin(t), radius * std::cos(t));
      const Vec2 second(-radius * std::cos(t), -radius * std::sin(t));
      found = std::min(found, std::pow(first.norm(), 3) / std::abs(cross(first, second)));
    }
    EXPECT_NEAR(found, tightest, 1e-9 * radius);
  }
}

TEST(GuideLayout, FillsTheRangeSoThatTheFirstHarmonicVanishes) {
  test::Rng rng(3);
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    const double low = test::random_real(rng, -5, 5);
    const double high = low + test::random_real(rng, 0.1, 100);
    const double asked = test::random_real(rng, 0.1, 20);
    const bool rim_low = i % 2 == 0;
    const bool rim_high = i % 3 == 0;
    const GuideLayout layout = guide_layout(low, high, asked, rim_low, rim_high);
    EXPECT_NEAR(std::cyl_bessel_j(0, full_turn * layout.radius / layout.distance), 0, 1e-12);
    EXPECT_NEAR(layout.levels.front() - low, rim_low ? layout.radius : layout.distance / 2, 1e-9);
    EXPECT_NEAR(high - layout.levels.back(), rim_high ? layout.radius : layout.distance / 2, 1e-9);
    for (std::size_t k = 1; k < layout.levels.size(); ++k) {
      EXPECT_NEAR(layout.levels[k] - layout.levels[k - 1], layout.distance, 1e-9);
    }
    EXPECT_LE(layout.radius, asked * (1 + 1e-12));
  }
  EXPECT_THROW(guide_layout(0, 0, 1, true, true), Error);
  EXPECT_THROW(guide_layout(0, 1, 0, true, true), Error);
  EXPECT_THROW(guide_layout(0, 1, 1e-9, true, true), Error);
}

/// Length of covering moves per area, weighted by a Gaussian of this standard deviation.
double density_at(const ImpactCurve& curve, const Vec2& place, double sigma) {
  double sum = 0;
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    if (curve.points[i].kind != MoveKind::cover) continue;
    const Vec2 a = curve.points[i - 1].position.head<2>() - place;
    const Vec2 b = curve.points[i].position.head<2>() - place;
    if (std::min(a.norm(), b.norm()) > 6 * sigma) continue;
    sum += (b - a).norm() * std::exp(-((a + b) / 2).squaredNorm() / (2 * sigma * sigma));
  }
  return sum / (full_turn * sigma * sigma);
}

TEST(TrochoidalPlan, CoversThePlaneWithAUniformDensityAwayFromTheRims) {
  const TriangleMesh mesh = test::planar_grid(24, 18, 80, 60);
  const double radius = 6;
  const ImpactPlan plan =
      plan_impact(mesh, height_field(mesh, Vec3::UnitY()),
                  {.pattern = Pattern::trochoidal, .spacing = 2, .circle_radius = radius, .circle_step = 2});
  const double distance = radius / 0.8786;
  std::vector<double> densities;
  test::Rng rng(9);
  for (int i = 0; i < 150; ++i) {
    const Vec2 place(test::random_real(rng, 4 * radius, 80 - 4 * radius),
                     test::random_real(rng, 3 * radius, 60 - 3 * radius));
    densities.push_back(density_at(plan.curve, place, distance / 4));
  }
  double mean = 0;
  for (const double density : densities) mean += density / static_cast<double>(densities.size());
  // A turn is a circle's length, and a guide stands for its distance.
  EXPECT_NEAR(mean, full_turn * radius / (distance * 2), 0.08 * mean);
  for (const double density : densities) EXPECT_NEAR(density, mean, 0.05 * mean);
}

TEST(TrochoidalPlan, TakesCirclesForTheSmallestRadiusThatIsAskedFor) {
  const TriangleMesh mesh = test::planar_grid(24, 18, 80, 60);
  const VertexField height = height_field(mesh, Vec3::UnitY());
  for (const double min_radius : {5.0, 8.0, 9.5, 11.0}) {
    SCOPED_TRACE(min_radius);
    for (const double circle_radius : {0.0, 1.1 * min_radius}) {
      const ImpactPlan plan = plan_impact(mesh, height,
                                          {.pattern = Pattern::trochoidal,
                                           .spacing = 2,
                                           .circle_radius = circle_radius,
                                           .close_gaps = false,
                                           .min_radius = min_radius});
      // both ends of each link from guide to guide are corners; circles that are too small turn tightly in every turn
      const std::size_t corners = 2 * plan.contours.size();
      const std::size_t tight = tight_places(mesh, plan.curve, 0.99 * min_radius).size();
      EXPECT_EQ(tight <= corners, circle_radius == 0) << tight;
      EXPECT_EQ(plan.warnings.empty(), circle_radius == 0);
    }
  }
}

TEST(TrochoidalPlan, CoversSurfacesAndStaysOnThem) {
  for (const TriangleMesh& mesh : {test::hemisphere(12, 48, 20), test::l_shape(6), test::planar_grid(8, 8, 30, 20)}) {
    const double spacing = mesh.size() / 25;
    const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
    const ImpactPlan plan = plan_impact(mesh, field, {.pattern = Pattern::trochoidal, .spacing = spacing});
    for (std::size_t i = 1; i < plan.curve.points.size(); ++i) {
      if (plan.curve.points[i].kind == MoveKind::lift) continue;
      ASSERT_NE(common_face(mesh, plan.curve.points[i - 1].at, plan.curve.points[i].at), no_index) << i;
    }
    EXPECT_GE(measure_gap(mesh, plan.curve, spacing).covered_fraction, 0.99);
  }
}

TEST(TrochoidalPlan, RefusesWhatItCannotUse) {
  const TriangleMesh mesh = test::planar_grid(4, 4, 8, 8);
  const VertexField height = height_field(mesh, Vec3::UnitX());
  EXPECT_THROW(plan_impact(mesh, height, {.pattern = Pattern::trochoidal, .spacing = 1, .circle_radius = -1}), Error);
  EXPECT_THROW(plan_impact(mesh, height, {.pattern = Pattern::trochoidal, .spacing = 1, .circle_step = infinity}),
               Error);
  const IntrinsicGeometry metric(mesh);
  EXPECT_THROW(plan_impact(mesh, height, {.pattern = Pattern::trochoidal, .spacing = 1, .metric = &metric}), Error);
  EXPECT_THROW(plan_impact(mesh, height, {.pattern = Pattern::trochoidal, .spacing = 1, .circle_step = 1e-6}), Error);
  const SurfaceCurve edge = make_curve(mesh, {point_on_halfedge(0, 0), point_on_halfedge(0, 1)});
  EXPECT_THROW(trochoid(mesh, edge, Vec3::Zero(), {1, 1e-7, 0}), Error);
  EXPECT_THROW(trochoid(mesh, edge, Vec3::Zero(), {1, 1, 1e-300}), Error);
  EXPECT_THROW(trochoid(mesh, make_curve(mesh, {point_at_vertex(mesh, 7)}), Vec3::Zero(), {1, 1, 0}), Error);
}

}  // namespace
}  // namespace isopath
