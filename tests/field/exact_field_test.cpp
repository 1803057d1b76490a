#include "isopath/field/exact_field.h"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "isopath/core/error.h"
#include "support/random_sources.h"
#include "support/slow_exact.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

using std::numbers::pi;

/// Distance in the plane to the nearest element.
double planar_distance(const TriangleMesh& mesh, const SourceSet& sources, const Vec3& at) {
  double best = infinity;
  for (const SourceElement& source : sources.elements()) {
    const Vec3 a = position_of(mesh, source.a);
    const Vec3 way = source.kind == SourceElement::Kind::segment ? Vec3(position_of(mesh, source.b) - a) : Vec3::Zero();
    const double squared = way.squaredNorm();
    const double t = squared > 0 ? std::clamp((at - a).dot(way) / squared, 0.0, 1.0) : 0.0;
    best = std::min(best, (at - a - t * way).norm());
  }
  return best;
}

void expect_planar(const TriangleMesh& mesh, const SourceSet& sources, Rng& rng) {
  const ExactField field = ExactField::compute(mesh, sources);
  const double tolerance = 1e-10 * mesh.size();
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    EXPECT_NEAR(field.vertex_distances()[v], planar_distance(mesh, sources, mesh.position(v)), tolerance) << v;
    EXPECT_EQ(field.vertex_distances()[v], field.value_at_vertex(v));
  }
  for (int k = 0; k < 200; ++k) {
    const SurfacePoint point = random_supported_point(rng, mesh);
    EXPECT_NEAR(field.value(point), planar_distance(mesh, sources, position_of(mesh, point)), tolerance) << k;
  }
}

class PlaneField : public testing::TestWithParam<int> {
 protected:
  Rng rng{static_cast<std::uint64_t>(GetParam())};
  TriangleMesh mesh = planar_grid(9, 7, 3, 2,
                                  {.diagonal = GetParam() % 2 == 0 ? Diagonal::regular : Diagonal::union_jack,
                                   .jitter = GetParam() < 2 ? 0.0 : 0.24,
                                   .seed = static_cast<std::uint64_t>(GetParam())});
  SourceSet sources;
};

TEST_P(PlaneField, Vertex) {
  sources.add_vertex(mesh, random_index(rng, mesh.n_vertices()));
  expect_planar(mesh, sources, rng);
}

TEST_P(PlaneField, PointInFace) {
  sources.add_point(random_surface_point(rng, mesh));
  expect_planar(mesh, sources, rng);
}

TEST_P(PlaneField, PointOnEdge) {
  sources.add_point(point_on_halfedge(random_index(rng, mesh.n_halfedges()), random_real(rng, 0, 1)));
  expect_planar(mesh, sources, rng);
}

TEST_P(PlaneField, SegmentInFace) {
  const SurfacePoint a = random_surface_point(rng, mesh);
  const std::vector<SurfacePoint> ends = {a, {a.face, Vec3(0.2, 0.7, 0.1)}};
  sources.add_polyline(mesh, ends, false);
  expect_planar(mesh, sources, rng);
}

TEST_P(PlaneField, OpenPolyline) {
  sources.add_polyline(mesh, random_polyline(rng, mesh, 8), false);
  expect_planar(mesh, sources, rng);
}

TEST_P(PlaneField, ClosedPolyline) {
  sources.add_polyline(mesh, random_loop(rng, mesh), true);
  expect_planar(mesh, sources, rng);
}

TEST_P(PlaneField, ChainOfEdges) {
  std::vector<Index> chain;
  for (Index h = 3 * random_index(rng, mesh.n_faces()); chain.size() < 6;) {
    chain.push_back(h);
    // Straight on along the grid line.
    const Index left = TriangleMesh::next(h);
    if (mesh.twin(left) == no_index) break;
    const Index up = TriangleMesh::next(mesh.twin(left));
    h = mesh.twin(up) == no_index ? up : TriangleMesh::next(mesh.twin(up));
  }
  sources.add_halfedges(mesh, chain, false);
  expect_planar(mesh, sources, rng);
}

TEST_P(PlaneField, BoundaryIsTheNearestSide) {
  expect_planar(mesh, boundary_source(mesh), rng);
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  for (int k = 0; k < 100; ++k) {
    const SurfacePoint point = random_surface_point(rng, mesh);
    const Vec3 at = position_of(mesh, point);
    EXPECT_NEAR(field.value(point), std::min({at.x(), 3 - at.x(), at.y(), 2 - at.y()}), 1e-11);
  }
}

TEST_P(PlaneField, ManySources) {
  sources = random_sources(rng, mesh, 12);
  expect_planar(mesh, sources, rng);
}

INSTANTIATE_TEST_SUITE_P(Grids, PlaneField, testing::Range(0, 12));

TEST(ExactField, NonConvexPolygons) {
  for (const TriangleMesh& mesh : {l_shape(3), notched_square(7), planar_star(7, 2, 0.6)}) {
    for (Index v = 0; v < mesh.n_vertices(); v += 5) {
      SourceSet sources;
      sources.add_vertex(mesh, v);
      const SlowExact slow(mesh, sources.elements());
      const ExactField field = ExactField::compute(mesh, sources);
      for (Index w = 0; w < mesh.n_vertices(); ++w) {
        EXPECT_NEAR(field.value_at_vertex(w), slow.vertex_distances()[w], 1e-11) << v << ' ' << w;
      }
    }
  }
}

TEST(ExactField, InsideTheBoundaryOfAnLShape) {
  const TriangleMesh mesh = l_shape(4);
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  Rng rng(1);
  for (int k = 0; k < 300; ++k) {
    const SurfacePoint point = random_surface_point(rng, mesh);
    const Vec3 at = position_of(mesh, point);
    // Distance to the removed quarter, whose corner is at (4, 4).
    const double inner = std::hypot(std::max(0.0, 4 - at.x()), std::max(0.0, 4 - at.y()));
    EXPECT_NEAR(field.value(point), std::min({at.x(), at.y(), 8 - at.x(), 8 - at.y(), inner}), 1e-11);
  }
}

/// Coordinates on the unrolled `open_cylinder` of n sides.
Vec2 unroll_cylinder(const TriangleMesh& mesh, int n, double chord, const SurfacePoint& point) {
  const Index side = point.face / 2 % n;
  Vec2 at = Vec2::Zero();
  for (int i = 0; i < 3; ++i) {
    const Index v = mesh.triangle(point.face)[i];
    at += point.barycentric[i] * Vec2((v % n == side ? side : side + 1) * chord, mesh.position(v).z());
  }
  return at;
}

TEST(ExactField, CylinderUnrolls) {
  const int n = 12;
  const TriangleMesh mesh = open_cylinder(n, 6, 1, 5);
  const double chord = 2 * std::sin(pi / n);
  Rng rng(2);
  for (int k = 0; k < 20; ++k) {
    SourceSet sources;
    sources.add_point(random_supported_point(rng, mesh));
    const ExactField field = ExactField::compute(mesh, sources);
    const Vec2 from = unroll_cylinder(mesh, n, chord, sources.elements()[0].a);
    for (int i = 0; i < 50; ++i) {
      const SurfacePoint point = random_supported_point(rng, mesh);
      const Vec2 step = unroll_cylinder(mesh, n, chord, point) - from;
      EXPECT_NEAR(field.value(point), std::hypot(std::remainder(step.x(), n * chord), step.y()), 1e-11);
    }
  }
}

TEST(ExactField, CylinderFromItsRims) {
  const TriangleMesh mesh = open_cylinder(12, 6, 1, 5);
  const ExactField both = ExactField::compute(mesh, boundary_source(mesh));
  const ExactField one = ExactField::compute(mesh, boundary_source(mesh, 0));
  Rng rng(3);
  for (int k = 0; k < 100; ++k) {
    const SurfacePoint point = random_supported_point(rng, mesh);
    const double z = position_of(mesh, point).z();
    EXPECT_NEAR(both.value(point), std::min(z, 5 - z), 1e-12);
    EXPECT_NEAR(std::min(std::abs(one.value(point) - z), std::abs(one.value(point) - 5 + z)), 0, 1e-12);
  }
}

/// Polar coordinates about vertex 0 of a fan of n congruent isosceles sectors, unfolded.
Vec2 fan_polar(const TriangleMesh& mesh, int n, double sector, const SurfacePoint& point) {
  Index side = no_index;
  for (int i = 0; i < 3; ++i) {
    const Index v = mesh.triangle(point.face)[i];
    const Index w = mesh.triangle(point.face)[(i + 1) % 3];
    if (v == 0 || w == 0) continue;
    const Index a = (v - 1) % n;
    const Index b = (w - 1) % n;
    if ((a + 1) % n == b) side = a;
    if ((b + 1) % n == a) side = b;
  }
  Vec2 at = Vec2::Zero();
  for (int i = 0; i < 3; ++i) {
    const Index v = mesh.triangle(point.face)[i];
    const double r = (mesh.position(v) - mesh.position(0)).norm();
    const double angle = v == 0 || (v - 1) % n == side ? 0 : sector;
    at += point.barycentric[i] * r * Vec2(std::cos(angle), std::sin(angle));
  }
  return {at.norm(), side * sector + std::atan2(at.y(), at.x())};
}

void expect_fan(const TriangleMesh& mesh, int n, double whole) {
  Rng rng(4);
  for (int k = 0; k < 20; ++k) {
    SourceSet sources;
    sources.add_point(random_supported_point(rng, mesh));
    const ExactField field = ExactField::compute(mesh, sources);
    const Vec2 from = fan_polar(mesh, n, whole / n, sources.elements()[0].a);
    for (int i = 0; i < 50; ++i) {
      const SurfacePoint point = random_supported_point(rng, mesh);
      const Vec2 to = fan_polar(mesh, n, whole / n, point);
      const double angle = std::abs(std::remainder(to.y() - from.y(), whole));
      const double expected =
          angle >= pi
              ? from.x() + to.x()
              : std::sqrt(std::pow(from.x() - to.x(), 2) + 4 * from.x() * to.x() * std::pow(std::sin(angle / 2), 2));
      EXPECT_NEAR(field.value(point), expected, 1e-10 * mesh.size()) << k << ' ' << i;
    }
  }
}

TEST(ExactField, ConeUnrolls) { expect_fan(open_cone(11, 5, 1, 2), 11, cone_angle(11, 1, 2)); }

TEST(ExactField, SaddleBendsAtTheApex) {
  for (double amplitude : {0.3, 1.0, 2.5}) {
    const int n = 8;
    const TriangleMesh mesh = saddle_cone(n, 1, amplitude);
    const Vec3 a = mesh.position(1);
    const Vec3 b = mesh.position(2);
    const double whole = n * std::atan2(a.cross(b).norm(), a.dot(b));
    ASSERT_GT(whole, 2 * pi);
    expect_fan(mesh, n, whole);
  }
}

TEST(ExactField, CubeFromACorner) {
  for (int n = 1; n <= 5; ++n) {
    const TriangleMesh mesh = cube(n, 1);
    SourceSet sources;
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      if (mesh.position(v).isZero()) sources.add_vertex(mesh, v);
    }
    const ExactField field = ExactField::compute(mesh, sources);
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      Vec3 at = mesh.position(v);
      std::sort(at.begin(), at.end());
      // On a far face, at height 1, the way leads over one of two sides; on a near one it is straight.
      const double expected = at[0] == 0 ? at.norm() : std::hypot(at[0] + 1, at[1]);
      const double other = at[0] == 0 ? at.norm() : std::hypot(at[0], at[1] + 1);
      EXPECT_NEAR(field.value_at_vertex(v), std::min(expected, other), 1e-12) << n << ' ' << at.transpose();
    }
    EXPECT_NEAR(field.max_vertex_distance(), std::sqrt(5.0), 1e-12);
  }
}

TEST(ExactField, PyramidFromItsApexToTheMiddleOfItsBase) {
  for (int n = 3; n < 9; ++n) {
    const TriangleMesh mesh = closed_pyramid(n, 2, 3);
    SourceSet sources;
    sources.add_vertex(mesh, 0);
    const ExactField field = ExactField::compute(mesh, sources);
    const double apothem = 2 * std::cos(pi / n);
    EXPECT_NEAR(field.value_at_vertex(1), std::hypot(2, 3), 1e-12);
    EXPECT_NEAR(field.value_at_vertex(n + 1), apothem + std::hypot(apothem, 3), 1e-12) << n;
  }
}

TEST(ExactField, SphereTendsToTheGreatCircle) {
  const TriangleMesh mesh = icosphere(4, 1);
  SourceSet sources;
  sources.add_vertex(mesh, 0);
  const ExactField field = ExactField::compute(mesh, sources);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const double angle = std::acos(std::clamp(mesh.position(0).dot(mesh.position(v)), -1.0, 1.0));
    EXPECT_NEAR(field.value_at_vertex(v), angle, 0.01);
  }
}

TEST(ExactField, OtherComponentsAreUnreached) {
  TriangleSoup soup = tetrahedron(1).soup();
  const TriangleSoup second = tetrahedron(2).soup();
  for (const Vec3& p : second.positions) soup.positions.emplace_back(p + Vec3(10, 0, 0));
  for (const auto& [a, b, c] : second.triangles) soup.triangles.push_back({a + 4, b + 4, c + 4});
  const TriangleMesh mesh(soup);
  SourceSet sources;
  sources.add_vertex(mesh, 0);
  const ExactField field = ExactField::compute(mesh, sources);
  EXPECT_EQ(field.value_at_vertex(5), infinity);
  EXPECT_EQ(field.value({5, Vec3(0.3, 0.3, 0.4)}), infinity);
  EXPECT_TRUE(field.shortest_path({5, Vec3(0.3, 0.3, 0.4)}).empty());
  EXPECT_NEAR(field.max_vertex_distance(), 1, 1e-13);
  std::vector<double> crossings;
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    if (mesh.component_of(TriangleMesh::face_of(mesh.halfedge_of(e))) == 1) field.edge_crossings(e, 0.5, crossings);
  }
  EXPECT_TRUE(crossings.empty());
}

TEST(ExactField, StopsAtADistance) {
  const TriangleMesh mesh = wavy_sheet(12, 4, 0.4, 2, 3, 5);
  SourceSet sources;
  sources.add_vertex(mesh, 20);
  const ExactField whole = ExactField::compute(mesh, sources);
  const ExactField part = ExactField::compute(mesh, sources, {.stop_distance = 1.5});
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const double exact = whole.value_at_vertex(v);
    EXPECT_GE(part.value_at_vertex(v), exact * (1 - 1e-13));
    if (exact < 1.5) {
      EXPECT_NEAR(part.value_at_vertex(v), exact, 1e-12);
    }
  }
  EXPECT_LT(part.windows_kept(), whole.windows_kept());
}

TEST(ExactField, SaysWhatIsWrong) {
  const TriangleMesh mesh = tetrahedron(1);
  try {
    ExactField::compute(mesh, SourceSet{});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_usage);
  }
}

TEST(ExactField, StopsOnRequest) {
  class Stop final : public Progress {
    bool cancelled() const override { return true; }
  } stop;
  const TriangleMesh mesh = icosphere(3, 1);
  SourceSet sources;
  sources.add_vertex(mesh, 0);
  try {
    ExactField::compute(mesh, sources, {}, stop);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace isopath::test
