#include "isopath/field/vertex_field.h"

#include <gtest/gtest.h>

#include <random>

#include "isopath/core/error.h"

namespace isopath {
namespace {

TriangleMesh tetrahedron() {
  return TriangleMesh(
      TriangleSoup{{{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 5}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}});
}

SurfacePoint random_point(const TriangleMesh& mesh, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.01, 1);
  const Vec3 weights(uniform(random), uniform(random), uniform(random));
  const Index face = std::uniform_int_distribution<Index>(0, mesh.n_faces() - 1)(random);
  return {face, weights / weights.sum()};
}

TEST(vertex_field, reproduces_a_linear_function_and_its_gradient) {
  const TriangleMesh mesh = tetrahedron();
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 100; ++round) {
    const Vec3 g(normal(random), normal(random), normal(random));
    std::vector<double> values;
    for (Index v = 0; v < mesh.n_vertices(); ++v) values.push_back(g.dot(mesh.position(v)) + 7);
    const VertexField field(mesh, values);
    const SurfacePoint p = random_point(mesh, random);
    EXPECT_NEAR(field.value(p), g.dot(position_of(mesh, p)) + 7, 1e-13 * (7 + 10 * g.norm()));
    const Vec3 n = mesh.face_normal(p.face);
    const Vec3 in_face = g - g.dot(n) * n;
    EXPECT_NEAR((field.slope(p).ascent - in_face.normalized()).norm(), 0, 1e-12);
    EXPECT_GE(field.max_slope(), in_face.norm() * (1 - 1e-12));
    EXPECT_LE(field.max_slope(), g.norm() * (1 + 1e-12));
  }
}

TEST(vertex_field, crossings_lie_on_the_level_and_have_the_parity_of_the_ends) {
  const TriangleMesh mesh = tetrahedron();
  std::mt19937_64 random(2);
  std::uniform_int_distribution<int> small(-3, 3);  // small numbers: ends often lie exactly on the level
  for (int round = 0; round < 1000; ++round) {
    std::vector<double> values;
    for (Index v = 0; v < mesh.n_vertices(); ++v) values.push_back(small(random));
    const VertexField field(mesh, values);
    const double level = small(random);
    for (Index edge = 0; edge < mesh.n_edges(); ++edge) {
      const Index h = mesh.halfedge_of(edge);
      std::vector<double> parameters{-1};
      field.edge_crossings(edge, level, parameters);
      ASSERT_EQ(parameters.front(), -1) << "appends";
      const bool differ = (values[mesh.from(h)] >= level) != (values[mesh.to(h)] >= level);
      ASSERT_EQ(parameters.size() % 2 == 0, differ) << round;
      for (std::size_t i = 1; i < parameters.size(); ++i) {
        ASSERT_NEAR(field.value(point_on_halfedge(h, parameters[i])), level, 1e-14) << round;
      }
    }
  }
}

TEST(vertex_field, an_infinite_corner_leaves_the_face_unreached_but_not_its_finite_edge) {
  const TriangleMesh mesh = tetrahedron();
  const VertexField field(mesh, {0, 1, 2, infinity});
  EXPECT_EQ(field.value({1, {0.5, 0.25, 0.25}}), infinity);
  EXPECT_EQ(field.slope({1, {0.5, 0.25, 0.25}}).ascent, Vec3::Zero());
  EXPECT_DOUBLE_EQ(field.value(point_on_halfedge(3, 0.25)), 0.25);  // from vertex 0 to 1, in a face with vertex 3
  EXPECT_TRUE(std::isfinite(field.max_slope()));
  for (Index edge = 0; edge < mesh.n_edges(); ++edge) {
    const Index h = mesh.halfedge_of(edge);
    std::vector<double> parameters;
    field.edge_crossings(edge, 100, parameters);
    EXPECT_TRUE(parameters.empty()) << mesh.from(h) << "-" << mesh.to(h);
  }
}

TEST(vertex_field, refuses_wrong_sizes_and_values) {
  const TriangleMesh mesh = tetrahedron();
  for (const std::vector<double>& values : {std::vector<double>{1, 2, 3}, std::vector<double>{1, 2, 3, NAN},
                                            std::vector<double>{1, 2, 3, -infinity}, std::vector<double>{}}) {
    try {
      const VertexField field(mesh, values);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_usage);
    }
  }
}

TEST(height_field, measures_along_the_unit_direction) {
  const TriangleMesh mesh = tetrahedron();
  const VertexField field = height_field(mesh, {0, 0, 20});
  for (Index v = 0; v < mesh.n_vertices(); ++v) EXPECT_DOUBLE_EQ(field.value_at_vertex(v), mesh.position(v).z());
  EXPECT_THROW(height_field(mesh, Vec3::Zero()), Error);
  EXPECT_THROW(height_field(mesh, {NAN, 0, 0}), Error);
}

}  // namespace
}  // namespace isopath
