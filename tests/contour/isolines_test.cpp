#include "isopath/contour/isolines.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <random>
#include <set>

#include "contour/functions.h"
#include "isopath/core/error.h"
#include "isopath/field/vertex_field.h"

namespace isopath {
namespace {

using test::PointDistance;
using test::random_values;
using test::square;

using std::numbers::pi;

std::set<Index> faces_around(const TriangleMesh& mesh, const SurfacePoint& point) {
  std::set<Index> faces{point.face};
  const Support support = support_of(mesh, point);
  if (support.kind == Support::Kind::edge && mesh.twin(support.index) != no_index) {
    faces.insert(TriangleMesh::face_of(mesh.twin(support.index)));
  }
  if (support.kind == Support::Kind::vertex) {
    const Index first = mesh.outgoing(support.index);
    Index h = first;
    do {
      faces.insert(TriangleMesh::face_of(h));
      h = mesh.next_outgoing(h);
    } while (h != no_index && h != first);
  }
  return faces;
}

bool on_boundary(const TriangleMesh& mesh, const SurfacePoint& point) {
  const Support support = support_of(mesh, point);
  if (support.kind == Support::Kind::vertex) return mesh.is_boundary_vertex(support.index);
  return support.kind == Support::Kind::edge && mesh.twin(support.index) == no_index;
}

/// The definition of a contour, checked point by point.
void expect_valid(const TriangleMesh& mesh, const SurfaceFunction& function, std::span<const Contour> contours) {
  const double tolerance = 1e-9 * mesh.size() * function.max_slope();
  for (std::size_t k = 0; k < contours.size(); ++k) {
    const Contour& c = contours[k];
    ASSERT_GE(c.level, contours[k > 0 ? k - 1 : 0].level);
    ASSERT_GE(c.points.size(), 2u);
    if (!c.closed) {
      ASSERT_TRUE(on_boundary(mesh, c.points.front())) << "contour " << k;
      ASSERT_TRUE(on_boundary(mesh, c.points.back())) << "contour " << k;
    }
    for (std::size_t i = 0; i < c.points.size(); ++i) {
      ASSERT_NEAR(function.value(c.points[i]), c.level, tolerance) << "contour " << k << " point " << i;
      ASSERT_GE(c.points[i].barycentric.minCoeff(), 0);
      ASSERT_NEAR(c.points[i].barycentric.sum(), 1, 1e-12);
      if (i + 1 == c.points.size() && !c.closed) break;
      const SurfacePoint& next = c.points[(i + 1) % c.points.size()];
      const auto here = faces_around(mesh, c.points[i]);
      const auto there = faces_around(mesh, next);
      ASSERT_TRUE(std::any_of(here.begin(), here.end(), [&](Index f) { return there.count(f) > 0; }))
          << "contour " << k << " points " << i << " and next share no face";
      ASSERT_FALSE(c.points[i].face == next.face && c.points[i].barycentric == next.barycentric) << "repeated point";
    }
  }
}

/// Signed area in the plane z = 0: positive when the contour runs counter-clockwise.
double signed_area(const TriangleMesh& mesh, const Contour& c) {
  double twice = 0;
  for (std::size_t i = 0; i < c.points.size(); ++i) {
    const Vec3 p = position_of(mesh, c.points[i]);
    const Vec3 q = position_of(mesh, c.points[(i + 1) % c.points.size()]);
    twice += p.x() * q.y() - p.y() * q.x();
  }
  return twice / 2;
}

TEST(isolines, of_a_height_are_straight_cuts_with_larger_values_on_the_left) {
  const TriangleMesh mesh = square(7, 3);
  for (const double angle : {0.0, 0.3, 1.1, pi / 4, pi / 2, 4.0}) {
    const Vec3 direction(std::cos(angle), std::sin(angle), 0);
    const VertexField field = height_field(mesh, direction);
    std::vector<double> levels;
    for (double t = -3.9; t < 4.2; t += 0.171) levels.push_back(t);
    const auto contours = isolines(mesh, field, levels);
    expect_valid(mesh, field, contours);
    const Vec3 left = Vec3(-direction.y(), direction.x(), 0);
    std::set<double> seen;
    for (const Contour& c : contours) {
      EXPECT_TRUE(seen.insert(c.level).second) << "a convex part is cut once";
      EXPECT_FALSE(c.closed);
      const Vec3 span = position_of(mesh, c.points.back()) - position_of(mesh, c.points.front());
      EXPECT_NEAR(length_of(mesh, c), span.norm(), 1e-12);
      EXPECT_NEAR(span.dot(left), -span.norm(), 1e-12);
    }
    const auto [low, high] = std::minmax_element(field.values().begin(), field.values().end());
    const auto inside = std::count_if(levels.begin(), levels.end(), [&](double t) { return t > *low && t < *high; });
    EXPECT_EQ(static_cast<std::ptrdiff_t>(contours.size()), inside);
  }
}

TEST(isolines, through_vertices_have_no_repeated_points) {
  const TriangleMesh mesh = square(8, 8);  // vertices at whole numbers
  const VertexField diagonal = height_field(mesh, {1, 1, 0});
  std::vector<double> levels;
  for (int k = 1; k < 16; ++k) levels.push_back(diagonal.value_at_vertex(1) * k);
  const auto contours = isolines(mesh, diagonal, levels);
  expect_valid(mesh, diagonal, contours);
  for (const Contour& c : contours) {
    for (std::size_t i = 1; i < c.points.size(); ++i) {
      const double step = (position_of(mesh, c.points[i]) - position_of(mesh, c.points[i - 1])).norm();
      EXPECT_GT(step, 1e-3);
    }
  }
  const std::vector<double> top{mesh.position(8).x()};
  EXPECT_LE(isolines(mesh, height_field(mesh, {1, 0, 0}), top).size(), 1u);
}

TEST(isolines, of_random_values_close_or_end_on_the_boundary_and_use_each_crossing_once) {
  const std::vector<TriangleMesh> meshes = {square(5), test::icosphere(1, 1), test::torus(12, 6, 3, 1)};
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const TriangleMesh& mesh = meshes[seed % meshes.size()];
    std::vector<double> values = random_values(mesh, random);
    if (seed % 2 == 1) {
      for (double& value : values) value = std::round(value * 4) / 4;  // vertices on the levels, flat faces
    }
    const VertexField field(mesh, values);
    const std::vector<double> levels{0.1, 0.25, 0.26, 0.5, 0.75, 1};
    const auto contours = isolines(mesh, field, levels);
    expect_valid(mesh, field, contours);
    // Every edge whose ends lie on different sides is met exactly once, unless the crossing is at a vertex.
    std::map<std::pair<Index, double>, int> visits;
    for (const Contour& c : contours) {
      for (const SurfacePoint& p : c.points) {
        const Support s = support_of(mesh, p);
        ASSERT_NE(s.kind, Support::Kind::face);
        if (s.kind == Support::Kind::edge) ++visits[{mesh.edge_of(s.index), c.level}];
      }
    }
    for (Index e = 0; e < mesh.n_edges(); ++e) {
      const Index h = mesh.halfedge_of(e);
      for (const double level : levels) {
        const double a = values[mesh.from(h)], b = values[mesh.to(h)];
        const bool crossed = (a >= level) != (b >= level) && a != level && b != level;
        ASSERT_EQ((visits[{e, level}]), crossed ? 1 : 0);
      }
    }
    if (testing::Test::HasFailure()) return;
  }
}

TEST(isolines, of_a_point_distance_are_circles) {
  const Vec3 centre(0.4871, 0.5113, 0);
  for (const int n : {1, 2, 9, 40}) {
    const TriangleMesh mesh = square(n);
    const PointDistance distance(mesh, {centre});
    const std::vector<double> levels{0.003, 0.05, 0.1, 0.2, 0.3, 0.45, 0.48};
    IsolineOptions options;
    for (const double tolerance : {1e-3, 1e-5}) {
      options.chord_tolerance = tolerance;
      const auto contours = isolines(mesh, distance, levels, options);
      expect_valid(mesh, distance, contours);
      ASSERT_EQ(contours.size(), levels.size()) << n << " cells";
      for (std::size_t k = 0; k < levels.size(); ++k) {
        const double r = levels[k];
        EXPECT_TRUE(contours[k].closed);
        EXPECT_LT(signed_area(mesh, contours[k]), 0) << "larger values, outside, on the left";
        // A chord of sagitta s is shorter than its arc by the factor 1 - 4 s / (3 r) to first order.
        EXPECT_LE(length_of(mesh, contours[k]), 2 * pi * r * (1 + 1e-9));
        EXPECT_GE(length_of(mesh, contours[k]), 2 * pi * r * (1 - 2 * tolerance / r));
        for (std::size_t i = 0; i < contours[k].points.size(); ++i) {
          const Vec3 p = position_of(mesh, contours[k].points[i]);
          const Vec3 q = position_of(mesh, contours[k].points[(i + 1) % contours[k].points.size()]);
          EXPECT_NEAR(((p + q) / 2 - centre).norm(), r, tolerance) << "chord tolerance, n = " << n;
        }
      }
    }
  }
}

TEST(isolines, of_random_point_sets_have_the_length_and_area_of_the_union_of_discs) {
  // The area nearer than t, counted on a fine grid, must be what the contours enclose.
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0.25, 0.75);
    const TriangleMesh mesh = square(1 + int(seed % 5));
    std::vector<Vec3> centres;
    for (std::uint64_t i = 0; i <= seed % 7; ++i) centres.emplace_back(uniform(random), uniform(random), 0);
    const PointDistance distance(mesh, centres);
    const std::vector<double> levels{0.02, 0.06, 0.11, 0.17, 0.24};
    IsolineOptions options;
    options.chord_tolerance = 1e-4;
    const auto contours = isolines(mesh, distance, levels, options);
    expect_valid(mesh, distance, contours);
    for (const double level : levels) {
      double enclosed = 0;
      for (const Contour& c : contours) {
        if (c.level == level) enclosed -= signed_area(mesh, c);
        EXPECT_TRUE(c.closed);
      }
      int inside = 0;
      constexpr int n = 400;
      for (int i = 0; i < n * n; ++i) {
        inside += distance.value_at(Vec3((i % n + 0.5) / n, (i / n + 0.5) / n, 0)) < level ? 1 : 0;
      }
      EXPECT_NEAR(enclosed, double(inside) / (n * n), 2e-3) << "level " << level;
    }
  }
}

TEST(isolines, find_the_corner_on_a_ridge) {
  // Two discs that overlap: the union's outline has two corners, inside one face and nowhere near an edge.
  const TriangleMesh mesh = square(1, 10);
  const Vec3 a(6, 2, 0), b(8, 2.3, 0);
  const PointDistance distance(mesh, {a, b});
  const double r = 1.3;
  IsolineOptions options;
  options.chord_tolerance = 1e-5;
  const auto contours = isolines(mesh, distance, std::vector<double>{r}, options);
  expect_valid(mesh, distance, contours);
  ASSERT_EQ(contours.size(), 1u);
  const double gap = (b - a).norm();
  EXPECT_NEAR(length_of(mesh, contours[0]), 2 * r * (2 * pi - 2 * std::acos(gap / 2 / r)), 1e-3);
  const Vec3 across = Vec3(a.y() - b.y(), b.x() - a.x(), 0) / gap * std::sqrt(r * r - gap * gap / 4);
  for (const Vec3& corner : {Vec3((a + b) / 2 + across), Vec3((a + b) / 2 - across)}) {
    double nearest = infinity;
    for (const SurfacePoint& p : contours[0].points)
      nearest = std::min(nearest, (position_of(mesh, p) - corner).norm());
    EXPECT_LT(nearest, 4e-5);
  }
}

TEST(isolines, along_a_ridge_need_few_points) {
  // On the ridge between two points the level runs close to its own other side, which takes deep divisions to see.
  const TriangleMesh mesh = square(1, 10);
  const PointDistance distance(mesh, {Vec3(6, 2, 0), Vec3(8, 2.3, 0)});
  IsolineOptions options;
  options.chord_tolerance = 1e-3;
  const double r = 0.5 * Vec3(2, 0.3, 0).norm() + 1e-6;
  const auto contours = isolines(mesh, distance, std::vector<double>{r}, options);
  expect_valid(mesh, distance, contours);
  std::size_t points = 0;
  for (const Contour& contour : contours) points += contour.points.size();
  // a circle of radius r with chords of that tolerance has 2 pi / sqrt(8 tolerance / r) of them; halving takes more
  EXPECT_LE(static_cast<double>(points), 2 * 2.5 * 2 * pi * std::sqrt(r / 8e-3) + 20);
}

TEST(isolines, skip_unreached_faces) {
  const TriangleMesh mesh = square(4);
  std::vector<double> values;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    values.push_back(mesh.position(v).x() > 0.6 ? infinity : mesh.position(v).y());
  }
  const VertexField field(mesh, values);
  const auto contours = isolines(mesh, field, std::vector<double>{0.3, 0.6});
  ASSERT_EQ(contours.size(), 2u);
  for (const Contour& c : contours) EXPECT_NEAR(length_of(mesh, c), 0.5, 1e-12);
}

TEST(isolines, refuse_bad_levels_and_options) {
  const TriangleMesh mesh = square(1);
  const VertexField field = height_field(mesh, {1, 0, 0});
  EXPECT_EQ(IsolineOptions{}.chord_tolerance, 0);
  for (const std::vector<double>& levels : {std::vector<double>{1, 0.5}, {0.5, 0.5}, {NAN}, {infinity}}) {
    EXPECT_THROW(isolines(mesh, field, levels), Error);
  }
  for (const double bad : {-1.0, double(NAN), infinity}) {
    IsolineOptions options;
    options.chord_tolerance = bad;
    EXPECT_THROW(isolines(mesh, field, std::vector<double>{0.5}, options), Error);
  }
  EXPECT_TRUE(isolines(mesh, field, {}).empty());
}

}  // namespace
}  // namespace isopath
