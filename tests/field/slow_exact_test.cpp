#include "support/slow_exact.h"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "support/test_meshes.h"

namespace isopath::test {
namespace {

SourceElement point(const SurfacePoint& at) { return {.a = at, .b = {}}; }
SourceElement vertex(const TriangleMesh& mesh, Index v) { return point(point_at_vertex(mesh, v)); }
SourceElement segment(const SurfacePoint& a, const SurfacePoint& b) {
  return {.kind = SourceElement::Kind::segment, .a = a, .b = b};
}

std::vector<double> distances(const TriangleMesh& mesh, const std::vector<SourceElement>& sources) {
  return SlowExact(mesh, sources).vertex_distances();
}

TEST(SlowExact, PlaneIsEuclidean) {
  const TriangleMesh mesh = planar_grid(6, 5, 3, 2, {.jitter = 0.24, .seed = 4});
  Rng rng(7);
  for (int k = 0; k < 30; ++k) {
    const SurfacePoint source = random_supported_point(rng, mesh);
    const SurfacePoint target = random_supported_point(rng, mesh);
    const std::vector<SourceElement> sources = {point(source)};
    const double expected = (position_of(mesh, source) - position_of(mesh, target)).norm();
    EXPECT_NEAR(SlowExact(mesh, sources).distance(target), expected, 1e-13) << k;
  }
}

TEST(SlowExact, SegmentsInThePlane) {
  const TriangleMesh mesh = planar_grid(5, 5, 1, 1, {.jitter = 0.24, .seed = 9});
  Rng rng(8);
  for (int k = 0; k < 30; ++k) {
    const Index face = random_index(rng, mesh.n_faces());
    const auto inside = [&] {
      const Vec3 w(random_real(rng, 0, 1), random_real(rng, 0, 1), random_real(rng, 0, 1));
      return SurfacePoint{face, w / w.sum()};
    };
    // A third of them lie along an edge.
    const SurfacePoint a = k % 3 == 0 ? point_on_halfedge(3 * face, 0.1) : inside();
    const SurfacePoint b = k % 3 == 0 ? point_on_halfedge(3 * face, 0.8) : inside();
    const std::vector<SourceElement> sources = {segment(a, b)};
    const SlowExact slow(mesh, sources);
    const Vec3 start = position_of(mesh, a);
    const Vec3 way = position_of(mesh, b) - start;
    for (int i = 0; i < 30; ++i) {
      const SurfacePoint target = random_supported_point(rng, mesh);
      const Vec3 at = position_of(mesh, target);
      const double t = std::clamp((at - start).dot(way) / way.squaredNorm(), 0.0, 1.0);
      EXPECT_NEAR(slow.distance(target), (at - start - t * way).norm(), 1e-13) << k << ' ' << i;
    }
  }
}

TEST(SlowExact, CubeCornerToCorner) {
  for (int n = 1; n <= 3; ++n) {
    const TriangleMesh mesh = cube(n, 1);
    Index near = no_index;
    Index far = no_index;
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      if (mesh.position(v).isZero()) near = v;
      if (mesh.position(v).isOnes()) far = v;
    }
    EXPECT_NEAR(distances(mesh, {vertex(mesh, near)})[far], std::sqrt(5.0), 1e-13) << n;
  }
}

TEST(SlowExact, CylinderUnrolls) {
  const int n = 8;
  const TriangleMesh mesh = open_cylinder(n, 3, 1, 2);
  const double chord = 2 * std::sin(std::numbers::pi / n);
  const std::vector<double> found = distances(mesh, {vertex(mesh, 0)});
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const int side = std::min(v % n, n - v % n);
    EXPECT_NEAR(found[v], std::hypot(side * chord, mesh.position(v).z()), 1e-13) << v;
  }
}

TEST(SlowExact, ConeUnrolls) {
  const int n = 9;
  const TriangleMesh mesh = open_cone(n, 1, 1, 3);
  const double whole = cone_angle(n, 1, 3);
  const std::vector<double> found = distances(mesh, {vertex(mesh, 1)});
  EXPECT_NEAR(found[0], 3, 1e-13);
  // The unrolled rim is a convex polygon: the way is the chord.
  for (int side = 1; side <= n / 2; ++side) {
    EXPECT_NEAR(found[1 + side], 6 * std::sin(side * whole / n / 2), 1e-12) << side;
  }
}

TEST(SlowExact, OverASaddleThroughTheApex) {
  const TriangleMesh mesh = saddle_cone(8, 1, 1.5);
  const std::vector<double> found = distances(mesh, {vertex(mesh, 1)});
  const double spoke = mesh.position(1).norm();
  EXPECT_NEAR(found[0], spoke, 1e-14);
  EXPECT_NEAR(found[5], 2 * spoke, 1e-14);
}

TEST(SlowExact, AroundTheReflexCorner) {
  const TriangleMesh mesh = l_shape(2);
  const auto at = [&](double x, double y) {
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      if ((mesh.position(v) - Vec3(x, y, 0)).norm() < 1e-9) return v;
    }
    return no_index;
  };
  const std::vector<double> found = distances(mesh, {vertex(mesh, at(0, 4))});
  EXPECT_NEAR(found[at(2, 2)], std::sqrt(8.0), 1e-14);
  EXPECT_NEAR(found[at(4, 2)], std::sqrt(8.0) + 2, 1e-14);
  EXPECT_NEAR(found[at(4, 1)], std::sqrt(8.0) + std::sqrt(5.0), 1e-14);
  EXPECT_NEAR(found[at(1, 0)], std::sqrt(17.0), 1e-14);
}

TEST(SlowExact, IsSymmetricOnRandomMeshes) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Rng rng(seed);
    const TriangleMesh mesh = random_mesh(rng, {.closed = seed % 2 == 0, .slivers = seed % 3 == 0});
    const SurfacePoint a = random_supported_point(rng, mesh);
    const SurfacePoint b = random_supported_point(rng, mesh);
    const std::vector<SourceElement> from_a = {point(a)};
    const std::vector<SourceElement> from_b = {point(b)};
    EXPECT_NEAR(SlowExact(mesh, from_a).distance(b), SlowExact(mesh, from_b).distance(a), 1e-11 * mesh.size()) << seed;
  }
}

}  // namespace
}  // namespace isopath::test
