#include "isopath/mesh/curvature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "support/test_meshes.h"

namespace isopath {
namespace {

/// Largest error of the principal curvatures over the vertices, against those of the true surface.
double worst_error(const TriangleMesh& mesh, const std::function<Vec2(const Vec3&)>& max_and_min) {
  const auto found = principal_curvatures(mesh, SmoothNormals(mesh));
  double worst = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    EXPECT_NEAR(found[v].max_direction.norm(), 1, 1e-12);
    EXPECT_NEAR(found[v].min_direction.norm(), 1, 1e-12);
    EXPECT_NEAR(found[v].max_direction.dot(found[v].min_direction), 0, 1e-9);
    const Vec2 truth = max_and_min(mesh.position(v));
    worst = std::max(worst, (Vec2(found[v].max, found[v].min) - truth).cwiseAbs().maxCoeff());
  }
  return worst;
}

TEST(Curvature, TheOutsideOfABallIsConvexThatIsNegative) {
  const auto truth = [](const Vec3&) { return Vec2(-0.2, -0.2); };
  const double coarse = worst_error(test::icosphere(3, 5), truth);
  const double fine = worst_error(test::icosphere(4, 5), truth);
  EXPECT_LT(coarse, 0.02);
  EXPECT_LT(fine, coarse / 3);
}

TEST(Curvature, TheInsideOfABallIsConcaveThatIsPositive) {
  TriangleSoup soup = test::icosphere(4, 5).soup();
  for (Triangle& t : soup.triangles) std::swap(t[1], t[2]);
  EXPECT_LT(worst_error(TriangleMesh(std::move(soup)), [](const Vec3&) { return Vec2(0.2, 0.2); }), 0.005);
}

TEST(Curvature, CylinderHasItsRadiusAcrossAndNothingAlong) {
  const auto truth = [](const Vec3&) { return Vec2(0, -0.1); };
  const double coarse = worst_error(test::open_cylinder(40, 10, 10, 20), truth);
  const double fine = worst_error(test::open_cylinder(80, 20, 10, 20), truth);
  EXPECT_LT(coarse, 0.01);
  EXPECT_LT(fine, coarse / 1.8);
  const TriangleMesh mesh = test::open_cylinder(80, 20, 10, 20);
  for (const PrincipalCurvatures& k : principal_curvatures(mesh, SmoothNormals(mesh))) {
    EXPECT_NEAR(std::abs(k.max_direction.z()), 1, 0.01);
    EXPECT_NEAR(k.along(Vec3::UnitZ()), k.max, 1e-3);
  }
}

TEST(Curvature, CylinderOfLongSliversIsStillACylinder) {
  // Strips 30 times as long as wide, as CAD systems cut a cylinder.
  EXPECT_LT(worst_error(test::open_cylinder(60, 1, 10, 30), [](const Vec3&) { return Vec2(0, -0.1); }), 2e-3);
}

TEST(Curvature, SaddleBendsBothWays) {
  const auto saddle = [](int n) {
    return test::height_grid(n, n, 2, 2,
                             [](double x, double y) { return 0.3 * (x - 1) * (x - 1) - 0.2 * (y - 1) * (y - 1); });
  };
  // The graph z = f has H = second derivatives / sqrt(1 + |grad|²) relative to I + grad gradᵀ.
  const auto truth = [](const Vec3& p) {
    const double fx = 0.6 * (p.x() - 1);
    const double fy = -0.4 * (p.y() - 1);
    const double w = 1 + fx * fx + fy * fy;
    const double gaussian = -0.24 / (w * w);
    const double mean = ((1 + fy * fy) * 0.6 + (1 + fx * fx) * -0.4) / (2 * w * std::sqrt(w));
    const double root = std::sqrt(mean * mean - gaussian);
    return Vec2(mean + root, mean - root);
  };
  const double coarse = worst_error(saddle(10), truth);
  const double fine = worst_error(saddle(20), truth);
  EXPECT_LT(coarse, 0.1);
  EXPECT_LT(fine, coarse / 1.7);
}

TEST(Curvature, TorusConverges) {
  const auto truth = [](const Vec3& p) {
    const double rho = std::hypot(p.x(), p.y());
    const double around = -(rho - 10) / 3 / rho;
    return Vec2(std::max(around, -1.0 / 3), std::min(around, -1.0 / 3));
  };
  const double coarse = worst_error(test::torus(60, 30, 10, 3), truth);
  const double fine = worst_error(test::torus(120, 60, 10, 3), truth);
  EXPECT_LT(coarse, 0.03);
  EXPECT_LT(fine, coarse / 3);
}

/// Greatest error of fitted normals and curvatures on a patch of a ball of radius 5, over the boundary too.
Vec2 errors_on_scattered_ball(int n, double radius = 0) {
  TriangleSoup soup = test::scattered_square(n, 4, 3).soup();
  for (Vec3& p : soup.positions) p.z() = std::sqrt(25 - (p.x() - 2) * (p.x() - 2) - (p.y() - 2) * (p.y() - 2));
  const TriangleMesh mesh(std::move(soup));
  const SurfaceFit fit = fit_surface(mesh, SmoothNormals(mesh), radius);
  Vec2 worst = Vec2::Zero();
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    const Index v = mesh.from(h);
    const Vec3 out = (mesh.position(v) - Vec3(2, 2, 0)) / 5;
    worst[0] = std::max(worst[0], (fit.corner_normals[h] - out).norm());
    worst[1] = std::max({worst[1], std::abs(fit.curvatures[v].max + 0.2), std::abs(fit.curvatures[v].min + 0.2)});
  }
  return worst;
}

TEST(SurfaceFit, NormalsAndCurvaturesConvergeOnIrregularTriangles) {
  const Vec2 coarse = errors_on_scattered_ball(12);
  const Vec2 fine = errors_on_scattered_ball(24);
  EXPECT_LT(coarse[0], 4e-3);
  EXPECT_LT(coarse[1], 0.02);
  EXPECT_LT(fine[0], coarse[0] / 4);
  EXPECT_LT(fine[1], coarse[1] / 2);
}

TEST(SurfaceFit, ASteepBoundaryIsNoHollowerThanTheRest) {
  // a sin(bx) cos(by) is hollowest at its lowest points, with a b² both ways; elsewhere slopes only flatten it
  const TriangleMesh mesh =
      test::height_grid(64, 64, 32, 32, [](double x, double y) { return 4.2 * std::sin(0.2 * x) * std::cos(0.2 * y); });
  for (const PrincipalCurvatures& k : principal_curvatures(mesh, SmoothNormals(mesh))) {
    EXPECT_LT(std::max(k.max, -k.min), 1.3 * 4.2 * 0.04);
  }
}

TEST(SurfaceFit, ARadiusEvensOutNoise) {
  TriangleSoup soup = test::planar_grid(40, 40, 8, 8).soup();
  test::Rng rng(1);
  for (Vec3& p : soup.positions) p.z() += test::random_real(rng, -1e-3, 1e-3);
  const TriangleMesh mesh(std::move(soup));
  const SmoothNormals normals(mesh);
  const auto rms = [&](double radius) {
    double sum = 0;
    const SurfaceFit fit = fit_surface(mesh, normals, radius);
    for (Index v = 0; v < mesh.n_vertices(); ++v) {  // on the rim there is less to average
      const Vec2 at = mesh.position(v).head<2>();
      if (at.minCoeff() > 1 && at.maxCoeff() < 7) sum += fit.curvatures[v].max * fit.curvatures[v].max;
    }
    return std::sqrt(sum);
  };
  EXPECT_LT(rms(0.8), 0.5 * rms(0));
}

TEST(SurfaceFit, AVertexOnACreaseHasANormalForEachSide) {
  const TriangleMesh mesh = test::cube(4, 1);
  const SurfaceFit fit = fit_surface(mesh, SmoothNormals(mesh));
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    EXPECT_LT((fit.corner_normals[h] - mesh.face_normal(TriangleMesh::face_of(h))).norm(), 1e-9);
  }
}

TEST(Curvature, CreasesDoNotMakeACubeRound) {
  const TriangleMesh mesh = test::box({0, 0, 0}, {1, 2, 3});
  for (const PrincipalCurvatures& k : principal_curvatures(mesh, SmoothNormals(mesh))) {
    EXPECT_NEAR(k.max, 0, 1e-12);
    EXPECT_NEAR(k.min, 0, 1e-12);
  }
}

TEST(Curvature, ScalesWithTheInverseOfTheSize) {
  for (const double size : {1e-6, 1e6}) {
    TriangleSoup soup = test::torus(30, 15, 10, 3).soup();
    const TriangleMesh mesh(soup);
    for (Vec3& p : soup.positions) p *= size;
    const TriangleMesh scaled(soup);
    const auto a = principal_curvatures(mesh, SmoothNormals(mesh));
    const auto b = principal_curvatures(scaled, SmoothNormals(scaled));
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      EXPECT_NEAR(b[v].max * size, a[v].max, 1e-9);
      EXPECT_NEAR(b[v].min * size, a[v].min, 1e-9);
    }
  }
}

TEST(Curvature, UnusedVerticesAndTrianglesWithoutAreaAreHarmless) {
  TriangleSoup soup;
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {9, 9, 9}};
  soup.triangles = {{0, 1, 2}};
  const TriangleMesh mesh(std::move(soup));
  const auto k = principal_curvatures(mesh, SmoothNormals(mesh));
  for (const auto& c : k) EXPECT_TRUE(std::isfinite(c.max) && std::isfinite(c.min) && c.max_direction.allFinite());
  EXPECT_TRUE(k[3].max_direction.isZero());
}

}  // namespace
}  // namespace isopath
