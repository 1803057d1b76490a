#include "isopath/impact/min_radius.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "impact/curve_checks.h"
#include "isopath/core/error.h"

namespace isopath {
namespace {

constexpr double pi = std::numbers::pi;

/// Smallest radius of the circles through points of a plane polyline that are `window` of arc apart, measured every
/// twentieth of it.
double smallest_circle(const std::vector<Vec2>& points, double window) {
  std::vector<double> arc = {0};
  for (std::size_t i = 1; i < points.size(); ++i) arc.push_back(arc.back() + (points[i] - points[i - 1]).norm());
  const auto at = [&](double s) {
    std::size_t i = 1;
    while (i + 1 < points.size() && arc[i] < s) ++i;
    const double t = (s - arc[i - 1]) / (arc[i] - arc[i - 1]);
    return Vec2((1 - t) * points[i - 1] + t * points[i]);
  };
  double least = infinity;
  for (double s = window; s + window <= arc.back(); s += 0.05 * window) {
    const Vec2 a = at(s - window);
    const Vec2 b = at(s);
    const Vec2 c = at(s + window);
    const double area = 0.5 * std::abs(cross(Vec2(b - a), Vec2(c - a)));
    const double product = (b - a).norm() * (c - b).norm() * (c - a).norm();
    if (area > 1e-9 * product) least = std::min(least, product / (4 * area));
  }
  return least;
}

std::vector<Vec2> seen_from_above(const ImpactCurve& curve) {
  std::vector<Vec2> points;
  for (const ImpactPoint& p : curve.points) points.push_back(p.position.head<2>());
  return points;
}

/// Two legs of 9 mm that enclose an angle at (10, 10) on a plate.
ImpactCurve corner(const SurfaceLinker& linker, double angle) {
  const Vec3 tip(10, 10, 0);
  const auto leg = [&](double direction) { return Vec3(tip + 9 * Vec3(std::cos(direction), std::sin(direction), 0)); };
  ImpactCurve curve;
  test::append(curve, test::line(linker, leg(0.4), tip), MoveKind::cover);
  test::append(curve, test::line(linker, tip, leg(0.4 + angle)), MoveKind::cover);
  return curve;
}

TEST(min_radius, makes_arcs_of_corners) {
  const test::Plate plate{test::planar_grid(17, 17, 20, 20, {.jitter = 0.2})};
  for (const double degrees : {120.0, 90.0, 60.0, 30.0}) {
    const double angle = degrees * pi / 180;
    const double r = degrees < 45 ? 0.8 : 1.5;
    const ImpactCurve before = corner(plate.linker, angle);
    ImpactCurve curve = before;
    ASSERT_EQ(tight_places(plate.mesh, curve, r).size(), 1u) << degrees;
    EXPECT_TRUE(keep_min_radius(plate.linker, plate.normals, curve, r).empty()) << degrees;
    test::expect_valid(plate.mesh, curve);
    EXPECT_GE(smallest_circle(seen_from_above(curve), 0.5 * r), 0.95 * r) << degrees;
    EXPECT_EQ(curve.points.front().position, before.points.front().position);
    EXPECT_EQ(curve.points.back().position, before.points.back().position);
    // no more is cut off than by an arc that touches both legs
    double nearest = infinity;
    for (const ImpactPoint& p : curve.points) nearest = std::min(nearest, (p.position - Vec3(10, 10, 0)).norm());
    const double cut_off = r * (1 / std::sin(0.5 * angle) - 1);
    EXPECT_GE(nearest, 0.9 * cut_off) << degrees;
    EXPECT_LE(nearest, 1.25 * cut_off) << degrees;
    // and the arc spans the turn
    const double legs_less = 2 * r / std::tan(0.5 * angle) - r * (pi - angle);
    const double shorter = length_of(before, MoveKind::cover) - length_of(curve, MoveKind::cover);
    EXPECT_GE(shorter, 0.9 * legs_less) << degrees;
    EXPECT_LE(shorter, 1.3 * legs_less) << degrees;
  }
}

TEST(min_radius, leaves_what_is_round_enough_as_it_is) {
  const test::Plate plate{test::planar_grid(17, 17, 20, 20, {.jitter = 0.2})};
  ImpactCurve curve;
  Vec3 last(15, 10, 0);
  for (int i = 1; i <= 120; ++i) {
    const double angle = 2 * pi * i / 120;
    const Vec3 next = Vec3(10, 10, 0) + 5 * Vec3(std::cos(angle), std::sin(angle), 0);
    test::append(curve, test::line(plate.linker, last, next), MoveKind::cover);
    last = next;
  }
  const std::size_t n = curve.points.size();
  EXPECT_TRUE(keep_min_radius(plate.linker, plate.normals, curve, 4).empty());
  EXPECT_EQ(curve.points.size(), n);
  EXPECT_EQ(tight_places(plate.mesh, curve, 5.5).size(), 1u) << "all round";
}

TEST(min_radius, is_kept_on_a_cylinder_as_on_the_sheet_it_is_rolled_from) {
  const double R = 10;
  const test::Plate pipe{test::open_cylinder(90, 20, R, 30)};
  const SurfaceLinker& linker = pipe.linker;
  const auto on_pipe = [&](const Vec2& p) {
    return linker.locator().nearest(Vec3(R * std::cos(p.x() / R), R * std::sin(p.x() / R), p.y())).at;
  };
  const auto unrolled = [&](const Vec3& p) { return Vec2(R * std::atan2(p.y(), p.x()), p.z()); };
  SurfaceCurve zigzag;
  for (const Vec2& p : {Vec2(-12, 6), Vec2(-4, 22), Vec2(4, 8), Vec2(12, 8)}) linker.extend(zigzag, on_pipe(p));
  ImpactCurve curve;
  test::append(curve, zigzag, MoveKind::cover);
  for (ImpactPoint& p : curve.points) p.normal = pipe.normals.at(p.at);
  const double r = 1.5;
  EXPECT_EQ(tight_places(pipe.mesh, curve, r).size(), 2u);
  EXPECT_TRUE(keep_min_radius(linker, pipe.normals, curve, r).empty());
  test::expect_valid(pipe.mesh, curve);
  std::vector<Vec2> flat;
  for (const ImpactPoint& p : curve.points) {
    EXPECT_LE(p.position.head<2>().norm(), R * (1 + 1e-9));
    EXPECT_GE(p.position.head<2>().norm(), R * std::cos(pi / 90) - 1e-9);
    flat.push_back(unrolled(p.position));
  }
  EXPECT_GE(smallest_circle(flat, 0.5 * r), 0.93 * r);
}

TEST(min_radius, is_no_matter_of_edges_that_a_straight_way_crosses) {
  const test::Plate box{test::cube(6, 20)};
  // round a box, straight when unfolded
  SurfaceCurve ring;
  for (const Vec3& p : {Vec3(3, 0, 9), Vec3(20, 0, 9), Vec3(20, 20, 9), Vec3(0, 20, 9)})
    box.linker.extend(ring, box.locator.nearest(p).at);
  ImpactCurve curve;
  test::append(curve, ring, MoveKind::cover);
  EXPECT_TRUE(tight_places(box.mesh, curve, 2).empty());
}

TEST(min_radius, says_where_it_cannot_be) {
  const test::Plate plate{test::planar_grid(17, 17, 20, 20, {.jitter = 0.2})};
  // the legs are too short for the arc: ends stay where they are
  const Vec3 tip(10, 10, 0);
  ImpactCurve curve;
  test::append(curve, test::line(plate.linker, tip + Vec3(2.5, 0, 0), tip), MoveKind::cover);
  test::append(curve, test::line(plate.linker, tip, tip + Vec3(2.3, 0.9, 0)), MoveKind::cover);
  const std::vector<TightPlace> left = keep_min_radius(plate.linker, plate.normals, curve, 2);
  test::expect_valid(plate.mesh, curve);
  ASSERT_FALSE(left.empty());
  for (const TightPlace& place : left) {
    EXPECT_LT(place.radius, 2);
    EXPECT_LE((place.position - tip).norm(), 3);
  }
}

TEST(min_radius, must_be_large_enough_to_be_told_from_rounding) {
  const test::Plate plate{test::planar_grid(3, 3, 20, 20)};
  ImpactCurve curve = corner(plate.linker, 1);
  for (const double radius : {0.0, -1.0, 1e-12, infinity, std::nan("")}) {
    EXPECT_THROW(check_min_radius(plate.mesh, radius), Error);
    EXPECT_THROW(keep_min_radius(plate.linker, plate.normals, curve, radius), Error);
    EXPECT_THROW(tight_places(plate.mesh, curve, radius), Error);
  }
  EXPECT_NO_THROW(check_min_radius(plate.mesh, 1e-6));
}

}  // namespace
}  // namespace isopath
