#include "isopath/impact/surface_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "impact/curve_checks.h"
#include "isopath/field/exact_field.h"

namespace isopath {
namespace {

double geodesic(const TriangleMesh& mesh, const SurfacePoint& a, const SurfacePoint& b) {
  SourceSet source;
  source.add_point(a);
  return ExactField::compute(mesh, source).value(b);
}

void expect_joins(const TriangleMesh& mesh, const SurfaceCurve& curve, const SurfacePoint& a, const SurfacePoint& b) {
  test::expect_on_surface(mesh, curve);
  ASSERT_GE(curve.size(), 2u);
  EXPECT_LE((curve.positions.front() - position_of(mesh, a)).norm(), 1e-9 * mesh.size());
  EXPECT_LE((curve.positions.back() - position_of(mesh, b)).norm(), 1e-9 * mesh.size());
}

/// Two planes that meet in a ridge over x = 10, at slopes of `steep` on both sides.
TriangleMesh roof(double steep) {
  return test::height_grid(20, 10, 20, 10, [=](double x, double) { return -steep * std::abs(x - 10); });
}

TEST(surface_linker, goes_straight_on_a_plane) {
  const TriangleMesh mesh = test::planar_grid(12, 12, 30, 30, {.jitter = 0.2, .seed = 3});
  const SurfaceLocator locator(mesh);
  const SurfaceLinker linker(mesh, locator);
  test::Rng rng(11);
  for (int k = 0; k < 200; ++k) {
    const SurfacePoint a = test::random_supported_point(rng, mesh);
    const SurfacePoint b = test::random_supported_point(rng, mesh);
    const double straight = (position_of(mesh, a) - position_of(mesh, b)).norm();
    if (straight < 1e-6) continue;
    const auto way = linker.link(a, b, 1.0001 * straight);
    ASSERT_TRUE(way) << "pair " << k;
    expect_joins(mesh, *way, a, b);
    EXPECT_NEAR(length_of(*way), straight, 1e-9 * straight) << "pair " << k;
    EXPECT_FALSE(linker.link(a, b, 0.9999 * straight)) << "pair " << k;
  }
}

TEST(surface_linker, finds_a_way_if_and_only_if_the_geodesic_is_short_enough) {
  const TriangleMesh meshes[] = {test::wavy_sheet(10, 20, 3, 0.7, 0.9, 4), roof(2), test::hemisphere(6, 16, 10),
                                 test::notched_square(7)};
  for (std::size_t m = 0; m < std::size(meshes); ++m) {
    const TriangleMesh& mesh = meshes[m];
    const SurfaceLocator locator(mesh);
    const SurfaceLinker linker(mesh, locator);
    test::Rng rng(m + 1);
    for (int k = 0; k < 60; ++k) {
      SCOPED_TRACE(testing::Message() << "mesh " << m << " pair " << k);
      const SurfacePoint a = test::random_surface_point(rng, mesh);
      const SurfacePoint b = test::random_surface_point(rng, mesh);
      const double straight = (position_of(mesh, a) - position_of(mesh, b)).norm();
      const double shortest = geodesic(mesh, a, b);
      const double longest = test::random_real(rng, 0.8, 1.6) * straight;
      const auto way = linker.link(a, b, longest);
      ASSERT_EQ(way.has_value(), shortest <= longest) << shortest << " limit " << longest;
      if (!way) continue;
      expect_joins(mesh, *way, a, b);
      EXPECT_GE(length_of(*way), shortest * (1 - 1e-9));
      EXPECT_LE(length_of(*way), longest * (1 + 1e-9));
    }
  }
}

TEST(surface_linker, goes_round_a_slot) {
  // Slot 3 < x < 4 above y = 1: the shortest way bends at (3, 1) and (4, 1).
  const TriangleMesh mesh = test::notched_square(7);
  const SurfaceLocator locator(mesh);
  const SurfaceLinker linker(mesh, locator);
  const Vec3 left(2.5, 6, 0);
  const Vec3 right(4.3, 5, 0);
  const double exact = (left - Vec3(3, 1, 0)).norm() + 1 + (right - Vec3(4, 1, 0)).norm();
  const SurfacePoint a = locator.nearest(left).at;
  const SurfacePoint b = locator.nearest(right).at;
  const auto way = linker.link(a, b, exact + 0.01);
  ASSERT_TRUE(way);
  expect_joins(mesh, *way, a, b);
  EXPECT_NEAR(length_of(*way), exact, 1e-9);
  EXPECT_FALSE(linker.link(a, b, exact - 0.01));
}

TEST(surface_linker, does_not_jump_to_another_component) {
  TriangleSoup soup = test::planar_grid(2, 2, 4, 4).soup();
  const TriangleSoup other = test::planar_grid(2, 2, 4, 4).soup();
  const auto n = static_cast<Index>(soup.positions.size());
  for (const Vec3& p : other.positions) soup.positions.push_back(p + Vec3(4.1, 0, 0));
  for (const auto& [a, b, c] : other.triangles) soup.triangles.push_back({a + n, b + n, c + n});
  const TriangleMesh mesh(std::move(soup));
  const SurfaceLocator locator(mesh);
  const SurfaceLinker linker(mesh, locator);
  EXPECT_FALSE(linker.link(locator.nearest({3.9, 2, 0}).at, locator.nearest({4.2, 2, 0}).at, 100));
}

TEST(surface_linker, extends_over_a_crease_without_leaving_the_surface) {
  for (const double steep : {0.1, 1.0, 5.0, 40.0}) {
    const TriangleMesh mesh = roof(steep);
    const SurfaceLocator locator(mesh);
    const SurfaceLinker linker(mesh, locator);
    SurfaceCurve curve;
    double shortest = 0;
    for (const double x : {8.6, 11.3, 9.2, 9.1, 13.4}) {
      const SurfacePoint to = locator.nearest({x, 0.4 * x, -steep * std::abs(x - 10)}).at;
      if (!curve.empty()) shortest += geodesic(mesh, curve.points.back(), to);
      linker.extend(curve, to);
      EXPECT_LE((curve.positions.back() - position_of(mesh, to)).norm(), 1e-9);
    }
    test::expect_on_surface(mesh, curve);
    EXPECT_GT(curve.size(), 5u);
    EXPECT_GE(length_of(curve), shortest * (1 - 1e-9));
    EXPECT_LE(length_of(curve), 1.1 * shortest) << "steep " << steep;
  }
}

TEST(surface_curve, closed_from_a_place_starts_and_ends_there) {
  const TriangleMesh mesh = test::planar_grid(8, 8, 8, 8);
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  const double level = 1.5;
  const std::vector<Contour> contours = isolines(mesh, field, std::span(&level, 1));
  ASSERT_EQ(contours.size(), 1u);
  const Vec3 place(6.9, 4.2, 0);
  const SurfaceCurve ring = closed_from(mesh, contours[0], place);
  test::expect_on_surface(mesh, ring);
  EXPECT_EQ(ring.size(), contours[0].points.size() + 1);
  EXPECT_EQ(ring.positions.front(), ring.positions.back());
  EXPECT_NEAR(length_of(ring), 20, 1e-9);  // a square of side 5
  for (const Vec3& p : ring.positions) EXPECT_GE((p - place).norm(), (ring.positions[0] - place).norm());
  EXPECT_EQ(nearest_index(ring, place), 0u);
}

TEST(surface_curve, reversed_and_rotated_keeps_points_and_positions_together) {
  const TriangleMesh mesh = test::planar_grid(3, 3, 3, 3);
  SurfaceCurve curve = make_curve(mesh, {point_at_vertex(mesh, 0), point_at_vertex(mesh, 1), point_at_vertex(mesh, 5)});
  EXPECT_NEAR(length_of(curve), 2, 1e-12);
  const SurfaceCurve turned = rotated(curve, 1);
  test::expect_on_surface(
      mesh, SurfaceCurve{{turned.points[0], turned.points[1]}, {turned.positions[0], turned.positions[1]}});
  EXPECT_EQ(turned.positions.front(), mesh.position(1));
  EXPECT_EQ(turned.positions.back(), mesh.position(0));
  curve.reverse();
  test::expect_on_surface(mesh, curve);
  EXPECT_EQ(curve.positions.front(), mesh.position(5));
  EXPECT_EQ(nearest_index(SurfaceCurve{}, Vec3::Zero()), 0u);
}

}  // namespace
}  // namespace isopath
