#include "isopath/mesh/normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "isopath/core/error.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

const std::array<Vec3, 4> samples = {Vec3(1, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0.2, 0.3, 0.5), Vec3(0, 0, 1)};

/// Largest difference between the smooth normal and the true one of a sphere about the origin.
double sphere_error(int level) {
  const TriangleMesh mesh = test::icosphere(level, 5);
  const SmoothNormals normals(mesh);
  double worst = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    for (const Vec3& b : samples) {
      const Vec3 n = normals.at({f, b});
      EXPECT_NEAR(n.norm(), 1, 1e-14);
      worst = std::max(worst, (n - position_of(mesh, {f, b}).normalized()).norm());
    }
  }
  return worst;
}

TEST(SmoothNormals, DefaultCreaseAngleIsFortyDegrees) {
  EXPECT_DOUBLE_EQ(NormalsOptions{}.crease_angle, 40 * std::numbers::pi / 180);
}

TEST(SmoothNormals, RefuseAnAngleThatIsNone) {
  EXPECT_THROW(SmoothNormals(test::planar_grid(1, 1, 1, 1), {.crease_angle = -0.1}), Error);
  EXPECT_THROW(SmoothNormals(test::planar_grid(1, 1, 1, 1), {.crease_angle = std::nan("")}), Error);
}

TEST(SmoothNormals, APlaneHasOneNormal) {
  const TriangleMesh mesh = test::planar_grid(5, 3, 10, 4);
  const SmoothNormals normals(mesh);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    for (const Vec3& b : samples) EXPECT_LT((normals.at({f, b}) - Vec3::UnitZ()).norm(), 1e-15);
  }
}

TEST(SmoothNormals, ErrorOnASphereShrinksWithTheEdge) {
  const double coarse = sphere_error(3);
  const double middle = sphere_error(4);
  const double fine = sphere_error(5);
  EXPECT_LT(coarse, 0.05);
  EXPECT_LT(middle, coarse / 1.9);
  EXPECT_LT(fine, middle / 1.9);
}

TEST(SmoothNormals, ACubeKeepsItsFaceNormalsUpToTheEdges) {
  const TriangleMesh mesh = test::box({-1, -1, -1}, {1, 2, 3});
  const SmoothNormals normals(mesh);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    for (const Vec3& b : samples) EXPECT_LT((normals.at({f, b}) - mesh.face_normal(f)).norm(), 1e-15);
  }
}

TEST(SmoothNormals, WithoutCreasesACubeCornerPointsAlongTheDiagonal) {
  // Each side has a right angle at the corner, however it is cut: the angle-weighted mean is the diagonal.
  const TriangleMesh mesh = test::box({0, 0, 0}, {1, 1, 1});
  const SmoothNormals normals(mesh, {.crease_angle = std::numbers::pi});
  for (Index v = 0; v < 8; ++v) {
    const Vec3 diagonal = (mesh.position(v) - Vec3::Constant(0.5)).normalized();
    EXPECT_LT((normals.at(point_at_vertex(mesh, v)) - diagonal).norm(), 1e-14);
  }
}

TEST(SmoothNormals, ARidgeIsSmoothedUpToTheCreaseAngle) {
  for (const double ridge : {39.0, 41.0}) {
    const double slope = std::tan(ridge / 2 * std::numbers::pi / 180);
    const TriangleMesh mesh = test::height_grid(4, 4, 4, 4, [&](double x, double) { return -slope * std::abs(x - 2); });
    const SmoothNormals normals(mesh);
    for (Index h = 0; h < mesh.n_halfedges(); ++h) {
      if (mesh.position(mesh.from(h)).x() != 2) continue;
      // Both sides have the same angle at each vertex of the ridge, so the mean is vertical.
      const Vec3 expected = ridge > 40 ? mesh.face_normal(h / 3) : Vec3::UnitZ();
      EXPECT_LT((normals.at_corner(h / 3, h % 3) - expected).norm(), 1e-14) << ridge;
    }
  }
}

TEST(SmoothNormals, TrianglesWithoutAreaTakeANeighboursNormal) {
  // A flat square whose diagonal carries a triangle of three collinear points.
  TriangleSoup soup;
  soup.positions = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 2, 0}, {1, -2, 0}};
  soup.triangles = {{0, 2, 3}, {2, 1, 3}, {0, 1, 2}, {1, 0, 4}};
  const TriangleMesh mesh(std::move(soup));
  ASSERT_EQ(mesh.face_area(2), 0);
  const SmoothNormals normals(mesh);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    EXPECT_LT((normals.of_face(f) - Vec3::UnitZ()).norm(), 1e-15) << f;
    for (const Vec3& b : samples) EXPECT_LT((normals.at({f, b}) - Vec3::UnitZ()).norm(), 1e-15) << f;
  }
}

TEST(SmoothNormals, AMeshWithoutAnyAreaStillHasUnitNormals) {
  TriangleSoup soup;
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  soup.triangles = {{0, 1, 2}};
  const SmoothNormals normals{TriangleMesh(std::move(soup))};
  EXPECT_EQ(normals.at({0, Vec3(0.2, 0.3, 0.5)}).norm(), 1);
}

}  // namespace
}  // namespace isopath
