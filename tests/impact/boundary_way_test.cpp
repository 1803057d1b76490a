#include "isopath/impact/boundary_way.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "impact/curve_checks.h"

namespace isopath {
namespace {

/// The point at arc length s along a boundary loop.
SurfacePoint point_at(const TriangleMesh& mesh, const std::vector<Index>& loop, double s) {
  for (const Index h : loop) {
    const double length = mesh.edge_length(mesh.edge_of(h));
    if (s < length) return point_on_halfedge(h, s / length);
    s -= length;
  }
  return point_at_vertex(mesh, mesh.from(loop.front()));
}

double perimeter(const TriangleMesh& mesh, const std::vector<Index>& loop) {
  double sum = 0;
  for (const Index h : loop) sum += mesh.edge_length(mesh.edge_of(h));
  return sum;
}

/// The way between two points of a loop, given by their arc lengths, must be the shorter one of the two, on the
/// boundary all along, and exist if and only if it is not longer than allowed.
void expect_shorter_way(const TriangleMesh& mesh, const std::vector<Index>& loop, double s, double t, double longest) {
  const double whole = perimeter(mesh, loop);
  const double shorter = std::min(std::abs(t - s), whole - std::abs(t - s));
  if (std::abs(shorter - longest) < 1e-9 * whole) return;
  const SurfacePoint from = point_at(mesh, loop, s);
  const SurfacePoint to = point_at(mesh, loop, t);
  const auto way = boundary_way(mesh, from, to, longest);
  ASSERT_EQ(way.has_value(), shorter < longest) << s << " to " << t << " of " << whole << ", longest " << longest;
  if (!way) return;
  EXPECT_NEAR(length_of(*way), shorter, 1e-9 * whole) << s << " to " << t << " of " << whole;
  test::expect_on_surface(mesh, *way);
  EXPECT_LE((way->positions.front() - position_of(mesh, from)).norm(), 1e-12 * whole);
  EXPECT_LE((way->positions.back() - position_of(mesh, to)).norm(), 1e-12 * whole);
  for (const SurfacePoint& point : way->points) EXPECT_TRUE(test::on_boundary(mesh, point));
}

TEST(boundary_way, is_the_shorter_way_round_a_square) {
  const TriangleMesh mesh = test::planar_grid(4, 4, 4, 4);
  const auto& loop = mesh.boundary_loops()[0];
  for (const double s : {0.0, 0.3, 1.0, 3.5, 4.0, 9.25, 15.0, 15.9}) {
    for (const double t : {0.0, 0.1, 0.3, 0.6, 1.0, 1.5, 4.0, 8.25, 12.5, 15.0, 15.5, 15.95}) {
      if (std::abs(std::abs(t - s) - 8) < 1e-9) continue;  // both ways are equally long
      for (const double longest : {1.0, 5.0, 20.0, infinity}) expect_shorter_way(mesh, loop, s, t, longest);
    }
  }
}

TEST(boundary_way, is_the_shorter_way_round_any_loop) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::Rng rng(seed);
    const TriangleMesh mesh = test::random_mesh(rng, {.min_faces = 6, .max_faces = 60, .holes = true});
    for (const auto& loop : mesh.boundary_loops()) {
      const double whole = perimeter(mesh, loop);
      for (int k = 0; k < 20; ++k) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        expect_shorter_way(mesh, loop, test::random_real(rng, 0, whole), test::random_real(rng, 0, whole),
                           test::random_real(rng, 0, whole));
      }
    }
  }
}

TEST(boundary_way, from_a_point_to_itself_stays) {
  const TriangleMesh mesh = test::planar_grid(3, 3, 3, 3);
  const auto& loop = mesh.boundary_loops()[0];
  for (const double s : {0.0, 0.4, 3.0, 7.7}) {
    const SurfacePoint point = point_at(mesh, loop, s);
    const auto way = boundary_way(mesh, point, point, 100);
    ASSERT_TRUE(way);
    EXPECT_EQ(length_of(*way), 0);
  }
}

TEST(boundary_way, needs_two_points_of_one_loop) {
  const TriangleMesh plate = test::planar_grid(4, 4, 4, 4);
  const SurfacePoint inside = point_at_vertex(plate, 12);
  const SurfacePoint corner = point_at_vertex(plate, 0);
  EXPECT_FALSE(boundary_way(plate, inside, corner, 100));
  EXPECT_FALSE(boundary_way(plate, corner, inside, 100));
  const TriangleMesh pipe = test::open_cylinder(12, 2, 5, 10);
  ASSERT_EQ(pipe.boundary_loops().size(), 2u);
  const SurfacePoint low = point_at(pipe, pipe.boundary_loops()[0], 1);
  const SurfacePoint high = point_at(pipe, pipe.boundary_loops()[1], 1);
  EXPECT_FALSE(boundary_way(pipe, low, high, 1000));
  EXPECT_FALSE(boundary_way(pipe, low, high, infinity));
}

}  // namespace
}  // namespace isopath
