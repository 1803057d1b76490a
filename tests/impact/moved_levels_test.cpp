#include "isopath/impact/moved_levels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "isopath/field/exact_field.h"
#include "isopath/field/vertex_field.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

TEST(moved_levels, draw_another_level_on_every_part_and_nothing_where_there_is_none) {
  // three squares in a row, far from each other
  TriangleSoup soup;
  for (int k = 0; k < 3; ++k) {
    const TriangleSoup square = test::planar_grid(4, 4, 4, 4).soup();
    const auto offset = static_cast<Index>(soup.positions.size());
    for (const Vec3& p : square.positions) soup.positions.push_back(p + Vec3(10.0 * k, 0, 0));
    for (const Triangle& t : square.triangles) soup.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  const TriangleMesh mesh(soup);
  const VertexField height = height_field(mesh, Vec3::UnitY());
  const std::vector<double> level = {1.3, infinity, 2.6};
  std::vector<double> level_of_vertex(mesh.n_vertices());
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    for (const Index v : mesh.triangle(f)) level_of_vertex[v] = level[mesh.component_of(f)];
  }
  const MovedLevels moved(mesh, height, level_of_vertex);
  const double zero = 0;
  const std::vector<Contour> contours = isolines(mesh, moved, std::span(&zero, 1));
  ASSERT_EQ(contours.size(), 2u);
  for (const Contour& contour : contours) {
    const Index component = mesh.component_of(contour.points.front().face);
    EXPECT_NE(component, 1);
    EXPECT_NEAR(length_of(mesh, contour), 4, 1e-12);
    for (const SurfacePoint& p : contour.points) {
      EXPECT_NEAR(position_of(mesh, p).y(), level[component], 1e-12);
      EXPECT_NEAR(moved.value(p), 0, 1e-12);
      EXPECT_NEAR(moved.slope(p).value, 0, 1e-12);
    }
  }
  EXPECT_EQ(moved.value({mesh.n_faces() / 2, Vec3::Constant(1.0 / 3)}), infinity);
}

/// Two rooms joined by a corridor: the distance from the rim has a top in each.
TEST(contours_beside, are_those_on_the_same_hill) {
  const TriangleMesh mesh =
      test::planar_cells(30, 10, [](int i, int j) { return i < 10 || i >= 20 || (j >= 3 && j < 7); });
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  const double low = 3;
  const double high = 3.7;
  for (const Contour& from : isolines(mesh, field, std::span(&low, 1))) {
    const std::vector<Contour> beside = contours_beside(mesh, field, from, high, Progress::none());
    ASSERT_EQ(beside.size(), 1u);
    EXPECT_TRUE(beside[0].closed);
    EXPECT_EQ(beside[0].level, high);
    // a square 3.7 inside a room of side 10, bulged by the mouth of the corridor, on the side where `from` is
    EXPECT_NEAR(length_of(mesh, beside[0]), 4 * 2.6, 0.5);
    const bool left = position_of(mesh, from.points[0]).x() < 15;
    for (const SurfacePoint& p : beside[0].points) {
      EXPECT_EQ(position_of(mesh, p).x() < 15, left);
      EXPECT_NEAR(field.value(p), high, 1e-7);
    }
  }
}

TEST(contours_beside, are_found_down_the_hill_too) {
  const TriangleMesh mesh = test::planar_grid(6, 6, 12, 12);
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  const double high = 4;
  const std::vector<Contour> from = isolines(mesh, field, std::span(&high, 1));
  ASSERT_EQ(from.size(), 1u);
  const std::vector<Contour> below = contours_beside(mesh, field, from[0], 1, Progress::none());
  ASSERT_EQ(below.size(), 1u);
  EXPECT_NEAR(length_of(mesh, below[0]), 40, 1e-3);
}

}  // namespace
}  // namespace isopath
