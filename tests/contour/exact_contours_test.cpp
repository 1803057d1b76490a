// Contours of exact distances: what the extraction promises must hold for the function that it was made for.
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "contour/functions.h"
#include "isopath/contour/contour_graph.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/source.h"

namespace isopath {
namespace {

std::vector<double> levels_of(const ExactField& field, int n) {
  std::vector<double> levels;
  for (int i = 0; i < n; ++i) levels.push_back(field.max_vertex_distance() * (i + 0.5) / n);
  return levels;
}

void expect_on_their_levels(const TriangleMesh& mesh, const ExactField& field, std::span<const Contour> contours) {
  for (std::size_t k = 0; k < contours.size(); ++k) {
    for (const SurfacePoint& point : contours[k].points) {
      ASSERT_NEAR(field.value(point), contours[k].level, 1e-9 * mesh.size()) << "contour " << k;
    }
  }
}

TEST(exact_contours, of_a_squares_boundary_are_squares) {
  const TriangleMesh mesh = test::square(10, 4);
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  std::vector<double> levels;
  for (double t = 0.05; t < 2; t += 0.1) levels.push_back(t);
  const ContourSet set = contour_set(mesh, field, levels);
  expect_on_their_levels(mesh, field, set.contours);
  ASSERT_EQ(set.contours.size(), levels.size());
  for (const Contour& c : set.contours) {
    EXPECT_TRUE(c.closed);
    EXPECT_NEAR(length_of(mesh, c), 4 * (4 - 2 * c.level), 1e-3);
  }
  EXPECT_EQ(set.graph.runs.size(), 1u);
}

TEST(exact_contours, of_a_point_are_circles) {
  for (const int n : {1, 4, 15}) {
    const TriangleMesh mesh = test::square(n, 2);
    SourceSet source;
    source.add_point({0, Vec3(0.37, 0.33, 0.3)});
    const Vec3 centre = position_of(mesh, source.elements()[0].a);
    const double reach = std::min({centre.x(), centre.y(), 2 - centre.x(), 2 - centre.y()});
    const ExactField field = ExactField::compute(mesh, source);
    std::vector<double> levels;
    for (int i = 1; i < 10; ++i) levels.push_back(reach * i / 10);
    const ContourSet set = contour_set(mesh, field, levels);
    expect_on_their_levels(mesh, field, set.contours);
    ASSERT_EQ(set.contours.size(), levels.size()) << n;
    for (const Contour& c : set.contours) {
      EXPECT_TRUE(c.closed);
      // A chord of sagitta s is shorter than its arc by the share 4 s / (3 r) to first order.
      EXPECT_NEAR(length_of(mesh, c), 2 * std::numbers::pi * c.level, 2 * std::numbers::pi * 1.5e-4 * mesh.size());
    }
    EXPECT_EQ(set.graph.runs.size(), 1u);
  }
}

TEST(exact_contours, of_closed_surfaces_are_closed_and_lie_above_one_another) {
  const std::vector<TriangleMesh> meshes = {test::icosphere(3, 2), test::torus(24, 12, 3, 1), test::cube(5, 2)};
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    SCOPED_TRACE(m);
    SourceSet source;
    source.add_vertex(meshes[m], 0);
    source.add_vertex(meshes[m], meshes[m].n_vertices() / 3);
    const ExactField field = ExactField::compute(meshes[m], source);
    const ContourSet set = contour_set(meshes[m], field, levels_of(field, 25));
    expect_on_their_levels(meshes[m], field, set.contours);
    for (std::size_t k = 0; k < set.contours.size(); ++k) {
      EXPECT_TRUE(set.contours[k].closed);
      EXPECT_EQ(set.graph.parents[k].empty(), set.contours[k].level == set.contours[0].level) << "contour " << k;
    }
  }
}

TEST(exact_contours, of_random_meshes_close_or_end_on_the_boundary) {
  for (std::uint64_t seed = 0; seed < 45; ++seed) {
    SCOPED_TRACE(seed);
    test::Rng random(seed);
    const TriangleMesh mesh =
        test::random_mesh(random, {.max_faces = 40, .closed = seed % 3 == 0, .slivers = seed % 5 == 0});
    SourceSet source;
    if (seed % 2 == 0 && !mesh.boundary_loops().empty()) {
      source = boundary_source(mesh);
    } else {
      source.add_point({static_cast<Index>(seed) % mesh.n_faces(), Vec3(0.5, 0.3, 0.2)});
    }
    const ExactField field = ExactField::compute(mesh, source);
    if (!(field.max_vertex_distance() > 0)) continue;
    const ContourSet set = contour_set(mesh, field, levels_of(field, 9));
    expect_on_their_levels(mesh, field, set.contours);
    for (const Contour& c : set.contours) {
      if (c.closed) continue;
      for (const SurfacePoint& end : {c.points.front(), c.points.back()}) {
        const Support s = support_of(mesh, end);
        ASSERT_TRUE(s.kind == Support::Kind::vertex ? mesh.is_boundary_vertex(s.index)
                                                    : s.kind == Support::Kind::edge && mesh.twin(s.index) == no_index);
      }
    }
  }
}

}  // namespace
}  // namespace isopath
