#include "isopath/mesh/surface_locator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "support/test_meshes.h"

namespace isopath {
namespace {

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Vec3 random_point(std::mt19937_64& random, double size) {
  const double x = uniform(random, -size, size);
  const double y = uniform(random, -size, size);
  return {x, y, uniform(random, -size, size)};
}

/// Triangles without common vertices; of every eight one is a sliver, one a segment and one a point.
TriangleMesh random_triangles(std::mt19937_64& random, int n, double size) {
  TriangleSoup soup;
  for (Index i = 0; i < n; ++i) {
    const Vec3 a = random_point(random, size);
    Vec3 b = a + random_point(random, 0.3 * size);
    Vec3 c = a + random_point(random, 0.3 * size);
    if (i % 8 == 5) c = a + uniform(random, -1, 2) * (b - a) + 1e-9 * random_point(random, size);
    if (i % 8 == 6) c = a + 0.25 * (b - a);
    if (i % 8 == 7) b = c = a;
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    soup.positions.insert(soup.positions.end(), {a, b, c});
  }
  return TriangleMesh(std::move(soup));
}

/// Distance to a segment by minimising the quadratic in its parameter.
double distance_to_segment(const Vec3& a, const Vec3& b, const Vec3& q) {
  const double length2 = (b - a).squaredNorm();
  const double t = length2 == 0 ? 0 : std::clamp((q - a).dot(b - a) / length2, 0.0, 1.0);
  return (a + t * (b - a) - q).norm();
}

/// Distance to a triangle by orthonormal coordinates in its plane: a way other than the locator's.
double distance_to_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q) {
  const double sides =
      std::min({distance_to_segment(a, b, q), distance_to_segment(b, c, q), distance_to_segment(c, a, q)});
  const Vec3 ex = (b - a).normalized();
  const Vec3 across = (c - a) - (c - a).dot(ex) * ex;
  if (!(across.norm() > 1e-11 * (c - a).norm())) return sides;
  const Vec3 ey = across.normalized();
  const auto plane = [&](const Vec3& p) { return Vec2((p - a).dot(ex), (p - a).dot(ey)); };
  const std::array<Vec2, 3> t = {plane(a), plane(b), plane(c)};
  for (int i = 0; i < 3; ++i) {
    if (cross(Vec2(t[(i + 1) % 3] - t[i]), Vec2(plane(q) - t[i])) < 0) return sides;
  }
  return std::min(sides, std::abs((q - a).dot(ex.cross(ey))));
}

double brute_distance(const TriangleMesh& mesh, const Vec3& q) {
  double best = infinity;
  for (const auto& [a, b, c] : mesh.soup().triangles) {
    best = std::min(best, distance_to_triangle(mesh.position(a), mesh.position(b), mesh.position(c), q));
  }
  return best;
}

void expect_nearest(const TriangleMesh& mesh, const SurfaceLocator& locator, const Vec3& q) {
  const NearestPoint found = locator.nearest(q);
  const double tolerance = 1e-10 * (mesh.size() + q.norm());
  ASSERT_TRUE(found.at.valid());
  EXPECT_NEAR(found.distance, brute_distance(mesh, q), tolerance);
  EXPECT_NEAR((position_of(mesh, found.at) - q).norm(), found.distance, tolerance);
  EXPECT_GE(found.at.barycentric.minCoeff(), 0);
  EXPECT_NEAR(found.at.barycentric.sum(), 1, 1e-15);
}

TEST(SurfaceLocator, NearestAgreesWithBruteForceAtEverySize) {
  for (const double size : {1e-6, 1.0, 1e6}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << " size " << size);
      std::mt19937_64 random(seed);
      const TriangleMesh mesh = random_triangles(random, static_cast<int>(seed * seed), size);
      const SurfaceLocator locator(mesh);
      for (int i = 0; i < 40; ++i) expect_nearest(mesh, locator, random_point(random, i % 4 == 0 ? 100 * size : size));
      if (HasFailure()) return;
    }
  }
}

TEST(SurfaceLocator, PointsOfTheSurfaceAreAtDistanceZero) {
  const TriangleMesh mesh = test::torus(30, 20, 10, 3);
  const SurfaceLocator locator(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const NearestPoint found = locator.nearest(mesh.position(v));
    EXPECT_EQ(found.distance, 0);
    const Support support = support_of(mesh, found.at);
    EXPECT_EQ(support.kind, Support::Kind::vertex);
    EXPECT_EQ(support.index, v);
  }
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    const NearestPoint found = locator.nearest(position_of(mesh, point_on_halfedge(h, 0.5)));
    EXPECT_NEAR(found.distance, 0, 1e-14 * mesh.size());
    const Support support = support_of(mesh, found.at);
    ASSERT_EQ(support.kind, Support::Kind::edge) << found.at.barycentric.transpose();
    EXPECT_EQ(mesh.edge_of(support.index), mesh.edge_of(h));
  }
}

TEST(SurfaceLocator, MaximumDistanceIsALimit) {
  const TriangleMesh mesh = test::planar_grid(4, 4, 1, 1);
  const SurfaceLocator locator(mesh);
  EXPECT_FALSE(locator.nearest({0.4, 0.4, 2}, 1.999).at.valid());
  EXPECT_EQ(locator.nearest({0.4, 0.4, 2}, 1.999).distance, infinity);
  EXPECT_NEAR(locator.nearest({0.4, 0.4, 2}, 2.001).distance, 2, 1e-15);
}

TEST(SurfaceLocator, EmptyMeshAndNonsenseHaveNoAnswer) {
  const SurfaceLocator empty{TriangleMesh()};
  EXPECT_FALSE(empty.nearest({0, 0, 0}).at.valid());
  EXPECT_FALSE(empty.intersects({0, 0, 0}, {1, 1, 1}));
  const SurfaceLocator locator(test::planar_grid(1, 1, 1, 1));
  EXPECT_FALSE(locator.nearest({std::nan(""), 0, 0}).at.valid());
  EXPECT_FALSE(locator.intersects({0.3, 0.3, 1}, {0.3, 0.3, -infinity}));
}

TEST(SurfaceLocator, ManyEqualTrianglesAreNoTrouble) {
  TriangleSoup soup;
  for (Index i = 0; i < 3000; i += 3) {
    soup.positions.insert(soup.positions.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    soup.triangles.push_back({i, i + 1, i + 2});
  }
  const TriangleMesh mesh(std::move(soup));
  EXPECT_NEAR(SurfaceLocator(mesh).nearest({0.2, 0.2, 3}).distance, 3, 1e-15);
}

/// Whether a segment pierces a triangle in general position, by the signs of the volumes of five tetrahedra.
bool pierces(const Vec3& a, const Vec3& b, const std::array<Vec3, 3>& p) {
  const auto positive = [](const Vec3& o, const Vec3& u, const Vec3& v, const Vec3& w) {
    return (u - o).cross(v - o).dot(w - o) > 0;
  };
  if (positive(a, p[0], p[1], p[2]) == positive(b, p[0], p[1], p[2])) return false;
  const bool side = positive(a, b, p[0], p[1]);
  return side == positive(a, b, p[1], p[2]) && side == positive(a, b, p[2], p[0]);
}

SegmentHit brute_hit(const TriangleMesh& mesh, const Vec3& a, const Vec3& b) {
  SegmentHit first;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const auto& [u, v, w] = mesh.triangle(f);
    if (!pierces(a, b, {mesh.position(u), mesh.position(v), mesh.position(w)})) continue;
    const Vec3 n = mesh.face_normal(f);
    const double t = n.dot(mesh.position(u) - a) / n.dot(b - a);
    if (t < first.t) first = {true, t, f};
  }
  return first;
}

TEST(SurfaceLocator, FirstHitAgreesWithBruteForce) {
  int hits = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    TriangleSoup soup;
    for (Index i = 0; i < 3 * 200; i += 3) {
      const Vec3 a = random_point(random, 1);
      const Vec3 b = a + random_point(random, 0.3);
      soup.positions.insert(soup.positions.end(), {a, b, a + random_point(random, 0.3)});
      soup.triangles.push_back({i, i + 1, i + 2});
    }
    const TriangleMesh mesh(std::move(soup));
    const SurfaceLocator locator(mesh);
    for (int i = 0; i < 50; ++i) {
      const Vec3 a = random_point(random, 1.5);
      const Vec3 b = random_point(random, 1.5);
      const SegmentHit expected = brute_hit(mesh, a, b);
      const SegmentHit hit = locator.first_hit(a, b);
      EXPECT_EQ(hit.hit, expected.hit);
      EXPECT_EQ(locator.intersects(a, b), expected.hit);
      EXPECT_EQ(hit.face, expected.face);
      if (hit.hit) {
        EXPECT_NEAR(hit.t, expected.t, 1e-9);
      }
      hits += hit.hit;
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(hits, 100);
}

TEST(SurfaceLocator, NoSegmentSlipsThroughEdgesAndVertices) {
  const TriangleMesh mesh = test::icosphere(3, 1);
  const SurfaceLocator locator(mesh);
  std::mt19937_64 random(7);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    EXPECT_TRUE(locator.intersects(random_point(random, 0.1), 2 * mesh.position(v))) << v;
    EXPECT_TRUE(locator.intersects(Vec3::Zero(), 2 * mesh.position(v))) << v;
  }
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    const Vec3 p = position_of(mesh, point_on_halfedge(mesh.halfedge_of(e), uniform(random, 0, 1)));
    EXPECT_TRUE(locator.intersects(Vec3::Zero(), 1.5 * p)) << e;
    EXPECT_FALSE(locator.intersects(Vec3::Zero(), 0.9 * p)) << e;
    EXPECT_FALSE(locator.intersects(1.1 * p, 2 * p)) << e;
  }
}

TEST(SurfaceLocator, SegmentsAlongTheAxesMeetAnAxisParallelBox) {
  const SurfaceLocator locator(test::box({0, 0, 0}, {1, 1, 1}));
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 centre = Vec3::Constant(0.5);
    const Vec3 out = centre + 2 * Vec3::Unit(axis);
    EXPECT_NEAR(locator.first_hit(out, centre).t, 0.75, 1e-15);
    EXPECT_NEAR(locator.first_hit(centre, out).t, 0.25, 1e-15);
    EXPECT_FALSE(locator.intersects(out, centre + 0.6 * Vec3::Unit(axis)));
  }
}

}  // namespace
}  // namespace isopath
