#include "isopath/plan/curve_sources.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/mesh/surface_walk.h"
#include "isopath/plan/make_sources.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

SourceSet sources_of(const TriangleMesh& mesh, const std::string& text) {
  std::vector<Index> map(mesh.n_vertices());
  std::iota(map.begin(), map.end(), 0);
  return make_sources(mesh, std::vector{parse_source_spec(text)}, map);
}

std::string text_of(const Vec3& p) { return fmt::format("{},{},{}", p.x(), p.y(), p.z()); }

/// The places that a source's elements start and end at.
std::vector<Vec3> places_of(const TriangleMesh& mesh, const SourceSet& sources) {
  std::vector<Vec3> places;
  for (const SourceElement& element : sources.elements()) {
    places.push_back(position_of(mesh, element.a));
    places.push_back(position_of(mesh, element.b));
  }
  return places;
}

double length_of(const TriangleMesh& mesh, const SourceSet& sources) {
  double sum = 0;
  for (const auto& element : sources.elements())
    sum += (position_of(mesh, element.a) - position_of(mesh, element.b)).norm();
  return sum;
}

bool is_on_boundary(const TriangleMesh& mesh, const SurfacePoint& point) {
  const Support at = support_of(mesh, point);
  if (at.kind == Support::Kind::vertex) return mesh.is_boundary_vertex(at.index);
  return at.kind == Support::Kind::edge && mesh.is_boundary_edge(mesh.edge_of(at.index));
}

/// Expects an Error(bad_usage) that names the source and holds all the parts.
void expect_refused(const TriangleMesh& mesh, const std::string& text, const std::vector<const char*>& parts) {
  try {
    sources_of(mesh, text);
    ADD_FAILURE() << text << " was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_usage) << error.what();
    EXPECT_NE(std::string(error.what()).find("source '" + text), std::string::npos) << error.what();
    for (const char* part : parts) EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(GeodesicSource, OnAPlaneItIsTheLineThroughBothPointsFromRimToRim) {
  const TriangleMesh mesh = test::planar_grid(9, 7, 9, 7, {.jitter = 0.2});
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    const SurfacePoint a = test::random_supported_point(rng, mesh);
    const SurfacePoint b = test::random_supported_point(rng, mesh);
    const Vec3 from = position_of(mesh, a);
    const Vec3 along = position_of(mesh, b) - from;
    if (along.norm() < 1e-3) continue;
    const std::vector<SurfacePoint> line = geodesic_through(mesh, a, b);
    for (const SurfacePoint& point : line) {
      EXPECT_NEAR(along.normalized().cross(position_of(mesh, point) - from).norm(), 0, 1e-9);
    }
    EXPECT_TRUE(is_on_boundary(mesh, line.front()));
    EXPECT_TRUE(is_on_boundary(mesh, line.back()));
    // Both points lie between the ends.
    const Vec3 low = position_of(mesh, line.front());
    const Vec3 high = position_of(mesh, line.back());
    for (const Vec3& p : {from, Vec3(from + along)}) EXPECT_LE((p - low).dot(p - high), 1e-9);
  }
}

TEST(GeodesicSource, OnACylinderItIsOneStraightLineInTheDevelopment) {
  const TriangleMesh mesh = test::open_cylinder(24, 5, 2, 6);
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    const SurfacePoint a = test::random_supported_point(rng, mesh);
    const SurfacePoint b = test::random_supported_point(rng, mesh);
    if (std::abs(position_of(mesh, a).z() - position_of(mesh, b).z()) < 0.2) continue;
    const std::vector<SurfacePoint> line = geodesic_through(mesh, a, b);
    std::vector<Vec2> developed = {Vec2::Zero()};
    for (std::size_t i = 1; i < line.size(); ++i) {
      const Vec3 p = position_of(mesh, line[i - 1]);
      const Vec3 step = position_of(mesh, line[i]) - p;
      const double around = std::copysign(std::hypot(step.x(), step.y()), p.x() * step.y() - p.y() * step.x());
      developed.push_back(developed.back() + Vec2(around, step.z()));
    }
    EXPECT_NEAR(std::abs(developed.back().y()), 6, 1e-9) << "from end to end";
    for (const Vec2& p : developed) EXPECT_NEAR(cross(developed.back().normalized(), p), 0, 1e-8);
  }
}

TEST(GeodesicSource, OnAClosedPartItEndsWhereItMeetsItself) {
  const TriangleMesh mesh = test::moved(test::icosphere(2, 3), Vec3(1, 2, 3).normalized(), 0.4, Vec3::Zero());
  test::Rng rng(5);
  for (int i = 0; i < 50; ++i) {
    const SurfacePoint a = test::random_surface_point(rng, mesh);
    const SurfacePoint b = test::random_surface_point(rng, mesh);
    const std::vector<SurfacePoint> line = geodesic_through(mesh, a, b);
    double length = 0;
    for (std::size_t k = 1; k < line.size(); ++k) {
      ASSERT_NE(common_face(mesh, line[k - 1], line[k]), no_index);
      length += (position_of(mesh, line[k]) - position_of(mesh, line[k - 1])).norm();
    }
    EXPECT_GT(length, 2 * std::numbers::pi * 3 * 0.8) << "it goes round";
    EXPECT_LE(length, 2 * mesh.size() + std::numbers::pi * 3);
  }
}

TEST(GeodesicSource, SaysWhatIsWrong) {
  const TriangleMesh mesh = test::planar_grid(4, 4, 4, 4);
  expect_refused(mesh, "geodesic:1,1,0:1,1,0", {"one place"});
  expect_refused(mesh, "geodesic:1,1,0:1,1,90", {"far from the surface", "90 mm away"});
  TriangleSoup two = mesh.soup();
  const Index n = mesh.n_vertices();
  for (const Vec3& p : mesh.soup().positions) two.positions.push_back(p + Vec3(9, 0, 0));
  for (const Triangle& t : mesh.soup().triangles) two.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  expect_refused(TriangleMesh(two), "geodesic:1,1,0:10,1,0", {"different components"});
}

TEST(CutSource, LiesInThePlaneThatItsNumbersTell) {
  const TriangleMesh mesh = test::torus(24, 16, 8, 3);
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    const double angle = test::random_real(rng, -400, 400);
    const double tilt = seed % 3 == 0 ? 0 : test::random_real(rng, -180, 180);
    const Vec3 through = position_of(mesh, test::random_surface_point(rng, mesh));
    const std::string angles = tilt == 0 ? fmt::format("{}", angle) : fmt::format("{},{}", angle, tilt);
    const double a = angle * std::numbers::pi / 180;
    const double t = tilt * std::numbers::pi / 180;
    // The plane holds the trace and the upward direction leaned over towards the left.
    const Vec3 trace(std::cos(a), std::sin(a), 0);
    const Vec3 upward = std::cos(t) * Vec3::UnitZ() + std::sin(t) * Vec3(-trace.y(), trace.x(), 0);
    const auto off_plane = [&](const Vec3& p, const Vec3& origin) { return trace.cross(upward).dot(p - origin); };
    const SourceSet cut = sources_of(mesh, fmt::format("cut:{}:{}", text_of(through), angles));
    ASSERT_FALSE(cut.empty());
    for (const Vec3& p : places_of(mesh, cut)) EXPECT_NEAR(off_plane(p, through), 0, 1e-7);

    // The same plane by its offset, which grows to the left of the trace.
    const Vec3 middle = mesh.bounds().center();
    const SourceSet same = sources_of(mesh, fmt::format("cut:{}:{}", -off_plane(through, middle), angles));
    EXPECT_NEAR(length_of(mesh, same), length_of(mesh, cut), 1e-6);
  }
}

TEST(CutSource, SaysWhereThePlaneCouldBe) {
  const TriangleMesh mesh = test::planar_grid(8, 4, 8, 4);
  EXPECT_NEAR(length_of(mesh, sources_of(mesh, "cut:1:90")), 4, 1e-9);
  expect_refused(mesh, "cut:5:90", {"offset 5", "between -4 and 4"});
  expect_refused(mesh, "cut:0,9,0:0", {"through 0, 9, 0", "-9 to -5 mm"});
}

TEST(SegmentSource, RunsWithTheSurfaceOnItsLeftBetweenTheSharesAsked) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    const TriangleMesh mesh = test::random_mesh(rng, {.min_faces = 6, .max_faces = 60, .holes = seed % 2 == 0});
    const auto& loops = mesh.boundary_loops();
    const Index k = test::random_index(rng, static_cast<Index>(loops.size()));
    double total = 0;
    for (const Index h : loops[k]) total += mesh.edge_length(mesh.edge_of(h));
    double from = test::random_real(rng, -2, 3);
    double to = test::random_real(rng, -2, 3);
    if (seed % 5 == 0) from = 0;
    if (seed % 7 == 0) to = 1;
    if (from == to) continue;
    const std::vector<SurfacePoint> line = boundary_segment(mesh, k, from, to);
    double length = 0;
    for (std::size_t i = 1; i < line.size(); ++i) {
      const Index face = common_face(mesh, line[i - 1], line[i]);
      ASSERT_NE(face, no_index);
      length += (position_of(mesh, line[i]) - position_of(mesh, line[i - 1])).norm();
    }
    const double turns = to - from;
    EXPECT_NEAR(length, (std::abs(turns) >= 1 ? 1 : turns - std::floor(turns)) * total, 1e-9 * total);
    // The ends lie at those arcs of the loop.
    for (const auto& [share, point] :
         {std::pair(from, line.front()), std::pair(std::abs(turns) >= 1 ? from : to, line.back())}) {
      double rest = (share - std::floor(share)) * total;
      Vec3 there = Vec3::Zero();
      for (const Index h : loops[k]) {
        const double edge = mesh.edge_length(mesh.edge_of(h));
        there = mesh.position(mesh.from(h)) +
                std::min(1.0, rest / edge) * (mesh.position(mesh.to(h)) - mesh.position(mesh.from(h)));
        if (rest <= edge) break;
        rest -= edge;
      }
      EXPECT_NEAR((there - position_of(mesh, point)).norm(), 0, 1e-9 * mesh.size());
    }
    for (const SurfacePoint& point : line) EXPECT_TRUE(is_on_boundary(mesh, point));
  }
}

TEST(SegmentSource, PicksGoToTheNearestPlaceOfTheBoundary) {
  const TriangleMesh mesh = test::planar_grid(6, 4, 6, 4);
  const SourceSet bottom = sources_of(mesh, "segment:1,-0.1,0:4.5,0.2,0");
  EXPECT_NEAR(length_of(mesh, bottom), 3.5, 1e-9);
  for (const Vec3& p : places_of(mesh, bottom)) EXPECT_NEAR(p.y(), 0, 1e-12);
  EXPECT_NEAR(length_of(mesh, sources_of(mesh, "segment:4.5,0.2,0:1,-0.1,0")), 20 - 3.5, 1e-9) << "the other way round";
  EXPECT_NEAR(length_of(mesh, sources_of(mesh, "segment:0:0,1")), 20, 1e-9);
  expect_refused(mesh, "segment:3,2,0:1,0,0", {"far from the boundary", "2 mm away"});
  expect_refused(mesh, "segment:1:0,0.5", {"loop 1 of 1"});
  expect_refused(mesh, "segment:1,0,0:1,0,0", {"no length"});
  expect_refused(test::cube(2, 1), "segment:0:0,0.5", {"no boundary"});
  expect_refused(test::cube(2, 1), "segment:0,0,0:1,0,0", {"no boundary"});
  expect_refused(test::open_cylinder(12, 3, 1, 1), "segment:1,0,0:1,0,1", {"different boundary loops"});
}

TEST(OffsetSource, LiesAtItsDistanceFromTheEdges) {
  const TriangleMesh mesh = test::cube(6, 12);
  for (const double distance : {0.7, 2.0, 5.5}) {
    const SourceSet edges = sources_of(mesh, "edges:80");
    const ExactField field = ExactField::compute(mesh, edges);
    const SourceSet lines = sources_of(mesh, fmt::format("offset:80,{}", distance));
    for (const SourceElement& element : lines.elements()) {
      EXPECT_NEAR(field.value(element.a), distance, 1e-8);
      EXPECT_NEAR(field.value(element.b), distance, 1e-8);
    }
    EXPECT_NEAR(length_of(mesh, lines), 6 * 4 * (12 - 2 * distance), 1e-6) << "a square on every side";
  }
  expect_refused(mesh, "offset:80,6.1", {"6.1 mm", "farthest vertex is"});
  expect_refused(mesh, "offset:95,1", {"95 degrees"});
}

}  // namespace
}  // namespace isopath
