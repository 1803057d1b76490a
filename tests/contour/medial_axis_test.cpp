// Voronoi diagrams and medial axes must hold by their definition, and agree with closed forms where there are any.
#include "isopath/contour/medial_axis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "contour/functions.h"
#include "isopath/core/error.h"
#include "isopath/core/segment.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/source.h"

namespace isopath {
namespace {

BisectorGraph axis_of_boundary(const TriangleMesh& mesh, const MedialAxisOptions& options = {}) {
  return medial_axis(ExactField::compute(mesh, boundary_source(mesh)), options);
}

std::vector<double> sorted_lengths(const TriangleMesh& mesh, const BisectorGraph& graph) {
  std::vector<double> lengths;
  for (const auto& arc : graph.arcs) lengths.push_back(length_of(mesh, arc));
  std::sort(lengths.begin(), lengths.end());
  return lengths;
}

void expect_lengths(const TriangleMesh& mesh, const BisectorGraph& graph, const std::vector<double>& expected,
                    double within) {
  const std::vector<double> lengths = sorted_lengths(mesh, graph);
  ASSERT_EQ(lengths.size(), expected.size());
  for (std::size_t k = 0; k < lengths.size(); ++k) EXPECT_NEAR(lengths[k], expected[k], within) << "arc " << k;
}

/// The end points of the boundary's edges.
std::vector<std::pair<Vec3, Vec3>> boundary_edges(const TriangleMesh& mesh) {
  std::vector<std::pair<Vec3, Vec3>> edges;
  for (const auto& loop : mesh.boundary_loops()) {
    for (const Index h : loop) edges.emplace_back(mesh.position(mesh.from(h)), mesh.position(mesh.to(h)));
  }
  return edges;
}

/// On a flat convex or star-shaped part: two points of the boundary, not one, are nearest, at the clearance. At leaves
/// the two are one.
void expect_two_feet(const TriangleMesh& mesh, const BisectorGraph& graph) {
  const auto edges = boundary_edges(mesh);
  const double tolerance = 1e-7 * mesh.size();
  for (const auto& arc : graph.arcs) {
    for (std::size_t k = 0; k < arc.points.size(); ++k) {
      const BisectorPoint& point = arc.points[k];
      const Vec3 p = position_of(mesh, point.point);
      double least = infinity;
      for (const auto& [a, b] : edges) least = std::min(least, distance_to_segment(a, b, p));
      ASSERT_NEAR(point.clearance, least, tolerance);
      if (least < 1e-6) continue;
      double widest = 0;
      std::vector<Vec3> feet;
      for (const auto& [a, b] : edges) {
        const Vec3 foot = mix(a, b, nearest_on_segment(a, b, p));
        if ((foot - p).norm() > least + tolerance) continue;
        for (const Vec3& other : feet) widest = std::max(widest, (other - foot).norm());
        feet.push_back(foot);
      }
      ASSERT_GT(widest, 0.1 * least) << "at " << p.transpose();
      if (k == 0 || k + 1 == arc.points.size()) continue;  // more than two fronts meet in nodes
      ASSERT_NEAR(widest, 2 * least * std::sin(0.5 * point.angle), 0.02 * least) << "at " << p.transpose();
    }
  }
}

TEST(medial_axis, of_a_square_are_its_diagonals) {
  const double half_diagonal = std::sqrt(2.0) / 2 * 3;
  for (const auto diagonal : {test::Diagonal::regular, test::Diagonal::union_jack}) {
    for (const int n : {1, 2, 3, 8}) {
      for (const double jitter : {0.0, 0.2}) {
        SCOPED_TRACE(testing::Message() << n << " cells, jitter " << jitter);
        const TriangleMesh mesh = test::planar_grid(n, n, 3, 3, {.diagonal = diagonal, .jitter = jitter});
        const BisectorGraph graph = axis_of_boundary(mesh);
        ASSERT_EQ(graph.nodes.size(), 5u);
        expect_lengths(mesh, graph, {half_diagonal, half_diagonal, half_diagonal, half_diagonal}, 1e-9);
        expect_two_feet(mesh, graph);
        for (const auto& node : graph.nodes) {
          if (node.arcs.size() == 1) continue;
          EXPECT_EQ(node.arcs.size(), 4u);
          EXPECT_LT((position_of(mesh, node.point) - Vec3(1.5, 1.5, 0)).norm(), 1e-9);
        }
      }
    }
  }
}

TEST(medial_axis, of_a_long_rectangle_has_a_spine) {
  const TriangleMesh mesh = test::planar_grid(31, 4, 10, 1, {.jitter = 0.2});
  const BisectorGraph graph = axis_of_boundary(mesh);
  const double corner = std::sqrt(0.5);
  expect_lengths(mesh, graph, {corner, corner, corner, corner, 9}, 1e-9);
  expect_two_feet(mesh, graph);
}

TEST(medial_axis, of_a_triangle_meets_in_the_incentre) {
  const std::vector<Vec2> polygon{Vec2(0, 0), Vec2(7, 1), Vec2(2, 4)};
  const TriangleMesh mesh = test::planar_fan(Vec2(3.1, 1.3), polygon);
  const BisectorGraph graph = axis_of_boundary(mesh);
  double perimeter = 0;
  Vec2 weighted = Vec2::Zero();
  for (int i = 0; i < 3; ++i) {
    const double opposite = (polygon[(i + 1) % 3] - polygon[(i + 2) % 3]).norm();
    perimeter += opposite;
    weighted += opposite * polygon[i];
  }
  const Vec2 incentre = weighted / perimeter;
  std::vector<double> lengths;
  for (const Vec2& corner : polygon) lengths.push_back((corner - incentre).norm());
  std::sort(lengths.begin(), lengths.end());
  expect_lengths(mesh, graph, lengths, 1e-9);
  expect_two_feet(mesh, graph);
}

TEST(medial_axis, of_a_star_are_its_rays) {
  for (const int n : {3, 5, 6}) {
    const TriangleMesh mesh = test::planar_star(n, 5, 2);
    const BisectorGraph graph = axis_of_boundary(mesh);
    expect_lengths(mesh, graph, std::vector<double>(n, 5.0), 1e-8);
    expect_two_feet(mesh, graph);
  }
}

/// Length of the parabola with its focus at distance 2 m from the directrix, from the foot of its axis over `x` along
/// the directrix.
double parabola_length(double m, double x) {
  const double t = x / (2 * m);
  return m * (t * std::sqrt(1 + t * t) + std::asinh(t));
}

TEST(medial_axis, of_an_l_bends_round_the_reflex_corner_by_parabolas) {
  // Arms of width n = 4 and outer sides of 8. Each arm has a centre line at clearance 2 and two corners; where the
  // perpendiculars of the reflex corner (4, 4) end, parabolas of focus (4, 4) and the outer sides take over, and meet
  // on the diagonal. x is measured from the focus along the outer side: they end where x = 4 - r and the distance is r.
  const int n = 4;
  const TriangleMesh mesh = test::l_shape(n);
  const BisectorGraph graph = axis_of_boundary(mesh);
  // on the diagonal (r, r): sqrt(2) (4 - r) = r
  const double r = 4 * std::sqrt(2.0) / (1 + std::sqrt(2.0));
  const double arm = 2 + parabola_length(2, 4 - r);  // straight from (6, 2) to (4, 2), then bent
  const double tip = 2 * std::sqrt(2.0);
  expect_lengths(mesh, graph, {tip, tip, tip, tip, std::sqrt(2.0) * r, arm, arm}, 1e-3);
  for (const auto& node : graph.nodes) {
    if (node.arcs.size() == 3 && node.clearance > 2.1) {
      EXPECT_NEAR(node.clearance, r, 1e-9);
    }
  }
  expect_two_feet(mesh, graph);
}

TEST(medial_axis, needs_no_twigs_for_corners_that_hardly_turn) {
  // A polygon of 60 sides round a stretched circle: the axis is near the ellipse's, between the centres of curvature
  // at its ends.
  std::vector<Vec2> polygon;
  for (int k = 0; k < 60; ++k) {
    const double t = (k + 0.5) * std::numbers::pi / 30;
    polygon.emplace_back(2 * std::cos(t), std::sin(t));
  }
  const TriangleMesh mesh = test::planar_fan(Vec2(0.1, 0.05), polygon);
  const BisectorGraph all = axis_of_boundary(mesh, {.min_angle = 1e-3});
  EXPECT_EQ(std::count_if(all.nodes.begin(), all.nodes.end(), [](const auto& n) { return n.arcs.size() == 1; }), 60);
  expect_two_feet(mesh, axis_of_boundary(mesh, {.min_angle = 0.5}));
  const BisectorGraph kept = axis_of_boundary(mesh, {.min_angle = 0.5});
  double length = 0;
  for (const auto& arc : kept.arcs) {
    length += length_of(mesh, arc);
    for (const BisectorPoint& p : arc.points) EXPECT_NEAR(position_of(mesh, p.point).y(), 0, 0.02);
  }
  // Where the normals of the ellipse at (±t) meet, x = 1.5 cos t, they turn by 2 φ with tan φ = 2 tan t.
  EXPECT_NEAR(length, 3 * std::cos(std::atan(0.5 * std::tan(0.25))), 0.25);
}

TEST(medial_axis, twigs_are_pruned_by_their_length_over_clearance) {
  const TriangleMesh mesh = test::planar_grid(31, 4, 10, 1, {.jitter = 0.2});
  const BisectorGraph graph = axis_of_boundary(mesh);
  EXPECT_EQ(pruned(mesh, graph, 1.41).arcs.size(), 5u);  // a corner's twig is sqrt(2) as long as its clearance
  const BisectorGraph bare = pruned(mesh, graph, 1.42);
  // one of the two at each end goes; the other then continues the spine
  expect_lengths(mesh, bare, {9 + 2 * std::sqrt(0.5)}, 1e-9);
  EXPECT_THROW(pruned(mesh, graph, -1), Error);
}

TEST(medial_axis, behind_a_cones_apex_is_where_a_front_meets_itself) {
  const int sides = 9;
  const double slant = 5;
  const TriangleMesh mesh = test::open_cone(sides, 4, 2, slant);
  const double half_way_round = test::cone_angle(sides, 2, slant) / 2;
  test::Rng rng(11);
  for (int round = 0; round < 5; ++round) {
    SourceSet source;
    const SurfacePoint start = test::random_surface_point(rng, mesh);
    source.add_point(start);
    const BisectorGraph graph = medial_axis(ExactField::compute(mesh, source), {.min_angle = 0.01});
    ASSERT_EQ(graph.arcs.size(), 1u) << "round " << round;
    // Unfolded, the source and a point opposite lie at radii from the apex, with half the cone's angle between them.
    const Vec3 apex = mesh.position(0);
    const double r0 = (position_of(mesh, start) - apex).norm();
    double least = infinity;
    double most = 0;
    for (const BisectorPoint& point : graph.arcs[0].points) {
      const double r = (position_of(mesh, point.point) - apex).norm();
      EXPECT_NEAR(point.clearance, std::sqrt(r * r + r0 * r0 - 2 * r * r0 * std::cos(half_way_round)), 1e-9);
      EXPECT_EQ(point.roots[0], point.roots[1]);
      if (r > 1e-6) {  // by the law of sines, seen from both sides
        const double turn = std::asin(r0 * std::sin(half_way_round) / point.clearance);
        EXPECT_NEAR(std::sin(point.angle), std::sin(2 * turn), 1e-6);
      }
      least = std::min(least, r);
      most = std::max(most, r);
    }
    EXPECT_NEAR(least, 0, 1e-9);
    EXPECT_GT(most, 0.9 * slant);
  }
}

TEST(medial_axis, options_are_checked) {
  MedialAxisOptions options;
  EXPECT_EQ(options.min_angle, 0.2);
  EXPECT_EQ(options.prune, 0);
  EXPECT_EQ(options.chord_tolerance, 0);
  options.min_angle = 0;
  EXPECT_THROW(options.validate(), Error);
  options = {.prune = std::nan("")};
  EXPECT_THROW(options.validate(), Error);
  EXPECT_THROW(VoronoiOptions{.chord_tolerance = -1}.validate(), Error);
}

/// A field of each source alone: what a Voronoi diagram is judged by.
struct Alone {
  std::vector<ExactField> fields;

  Alone(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points) {
    for (const SurfacePoint& p : points) {
      SourceSet source;
      source.add_point(p);
      fields.push_back(ExactField::compute(mesh, source));
    }
  }
  Index nearest(const SurfacePoint& p) const {
    Index best = 0;
    for (std::size_t k = 1; k < fields.size(); ++k) {
      if (fields[k].value(p) < fields[best].value(p)) best = static_cast<Index>(k);
    }
    return best;
  }
};

BisectorGraph voronoi_of(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points) {
  SourceSet sources;
  for (const SurfacePoint& p : points) sources.add_point(p);
  return voronoi_diagram(ExactField::compute(mesh, sources));
}

/// Every point is equally far from its two roots, and no other is nearer.
void expect_ties(const TriangleMesh& mesh, const BisectorGraph& graph, const Alone& alone) {
  const double tolerance = 1e-7 * mesh.size();
  for (const auto& arc : graph.arcs) {
    for (const BisectorPoint& point : arc.points) {
      ASSERT_NE(point.roots[0], point.roots[1]);
      for (const Index root : point.roots)
        ASSERT_NEAR(alone.fields[root].value(point.point), point.clearance, tolerance);
      ASSERT_NEAR(alone.fields[alone.nearest(point.point)].value(point.point), point.clearance, tolerance);
    }
  }
}

/// Wherever the nearest root changes along an edge, an arc crosses.
void expect_complete(const TriangleMesh& mesh, const BisectorGraph& graph, const Alone& alone) {
  std::vector<Vec3> points;
  for (const auto& arc : graph.arcs) {
    for (const BisectorPoint& point : arc.points) points.push_back(position_of(mesh, point.point));
  }
  constexpr int parts = 3;
  int changes = 0;
  for (Index edge = 0; edge < mesh.n_edges(); ++edge) {
    const Index h = mesh.halfedge_of(edge);
    for (int k = 0; k < parts; ++k) {
      // not at the vertices, where sources and crossings may lie
      const SurfacePoint low = point_on_halfedge(h, (k + 1e-6) / parts);
      const SurfacePoint high = point_on_halfedge(h, (k + 1 - 1e-6) / parts);
      const Index first = alone.nearest(low);
      const Index last = alone.nearest(high);
      const auto lead = [&](const SurfacePoint& p) {
        return std::abs(alone.fields[first].value(p) - alone.fields[last].value(p));
      };
      if (first == last || lead(low) < 1e-9 || lead(high) < 1e-9) continue;  // edges that are bisectors themselves
      ++changes;
      const Vec3 a = position_of(mesh, low);
      const Vec3 b = position_of(mesh, high);
      const bool crossed = std::any_of(points.begin(), points.end(), [&](const Vec3& p) {
        return distance_to_segment(a, b, p) < 1e-9 * mesh.size();
      });
      ASSERT_TRUE(crossed) << "edge " << edge << ", part " << k;
    }
  }
  ASSERT_GT(changes, 0);
}

TEST(voronoi_diagram, of_two_points_of_a_plane_is_their_perpendicular) {
  for (const int n : {1, 4}) {
    const TriangleMesh mesh = test::planar_grid(n, n, 4, 4);
    const std::vector<SurfacePoint> points{{0, Vec3(0.5, 0.3, 0.2)}, {mesh.n_faces() - 1, Vec3(0.3, 0.3, 0.4)}};
    const BisectorGraph graph = voronoi_of(mesh, points);
    ASSERT_EQ(graph.arcs.size(), 1u);
    const Vec3 a = position_of(mesh, points[0]);
    const Vec3 b = position_of(mesh, points[1]);
    for (const BisectorPoint& p : graph.arcs[0].points) {
      const Vec3 x = position_of(mesh, p.point);
      EXPECT_NEAR((x - a).norm(), (x - b).norm(), 1e-10);
      EXPECT_NEAR(p.clearance, (x - a).norm(), 1e-10);
    }
    for (const auto& node : graph.nodes) {
      const Vec3 x = position_of(mesh, node.point);
      EXPECT_NEAR(std::min({x.x(), x.y(), 4 - x.x(), 4 - x.y()}), 0, 1e-9);
    }
  }
}

TEST(voronoi_diagram, of_a_rectangles_sides_is_its_medial_axis) {
  // each side is several segments in one line: nothing divides these
  const TriangleMesh mesh = test::planar_grid(4, 3, 4, 3);
  const BisectorGraph graph = voronoi_diagram(ExactField::compute(mesh, boundary_source(mesh)));
  EXPECT_EQ(graph.arcs.size(), 5u);
  EXPECT_EQ(graph.nodes.size(), 6u);
  double length = 0;
  for (const auto& arc : graph.arcs) {
    for (std::size_t k = 1; k < arc.points.size(); ++k)
      length += (position_of(mesh, arc.points[k].point) - position_of(mesh, arc.points[k - 1].point)).norm();
  }
  EXPECT_NEAR(length, 4 * 1.5 * std::numbers::sqrt2 + 1, 1e-7);
}

TEST(voronoi_diagram, finds_a_cell_inside_one_face) {
  const TriangleMesh mesh = test::planar_grid(1, 1, 4, 4);
  std::vector<SurfacePoint> points{{0, Vec3(0.34, 0.33, 0.33)}};
  for (const Vec3& b : {Vec3(0.4, 0.3, 0.3), Vec3(0.28, 0.42, 0.3), Vec3(0.3, 0.3, 0.4), Vec3(0.4, 0.36, 0.24)})
    points.push_back({0, b});
  const BisectorGraph graph = voronoi_of(mesh, points);
  expect_ties(mesh, graph, Alone(mesh, points));
  double around = 0;
  for (const auto& arc : graph.arcs) {
    if (arc.points[1].roots[0] == 0 || arc.points[1].roots[1] == 0) around += length_of(mesh, arc);
  }
  EXPECT_GT(around, 0);
}

/// The point of a mesh at a position; invalid where there is none.
SurfacePoint point_at(const TriangleMesh& mesh, const Vec3& position) {
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const auto [i, j, k] = mesh.triangle(f);
    const Vec3 o = mesh.position(i);
    const Vec3 u = mesh.position(j) - o;
    const Vec3 v = mesh.position(k) - o;
    const Vec3 w = position - o;
    const Vec3 n = u.cross(v);
    const Vec3 b(0, w.cross(v).dot(n) / n.squaredNorm(), u.cross(w).dot(n) / n.squaredNorm());
    const double rest = 1 - b.sum();
    if (b[1] > 0 && b[2] > 0 && rest > 0 && std::abs(w.dot(n)) < 1e-9 * n.norm()) return {f, Vec3(rest, b[1], b[2])};
  }
  return {};
}

TEST(voronoi_diagram, of_two_points_of_a_cylinder_are_two_lines) {
  // Half way round and at the same height: two lines along the cylinder, a quarter turn away.
  const int sides = 12;
  const double height = 8;
  const TriangleMesh mesh = test::open_cylinder(sides, 6, 3, height);
  test::Rng rng(7);
  const SurfacePoint first = test::random_surface_point(rng, mesh);
  const Vec3 p = position_of(mesh, first);
  const SurfacePoint second = point_at(mesh, Vec3(-p.x(), -p.y(), p.z()));
  ASSERT_TRUE(second.valid());
  const std::vector<SurfacePoint> points{first, second};
  const BisectorGraph graph = voronoi_of(mesh, points);
  expect_lengths(mesh, graph, {height, height}, 1e-9);
  expect_ties(mesh, graph, Alone(mesh, points));
  expect_complete(mesh, graph, Alone(mesh, points));
}

TEST(voronoi_diagram, of_opposite_points_of_a_sphere_is_the_great_circle_between) {
  const TriangleMesh mesh = test::icosphere(3, 10);
  test::Rng rng(5);
  const SurfacePoint first = test::random_surface_point(rng, mesh);
  const SurfacePoint second = point_at(mesh, -position_of(mesh, first));
  ASSERT_TRUE(second.valid());
  const std::vector<SurfacePoint> points{first, second};
  const BisectorGraph graph = voronoi_of(mesh, points);
  ASSERT_EQ(graph.arcs.size(), 1u);
  EXPECT_EQ(graph.arcs[0].from, graph.arcs[0].to);
  const Vec3 axis = position_of(mesh, first).normalized();
  for (const BisectorPoint& p : graph.arcs[0].points)
    EXPECT_LT(std::abs(position_of(mesh, p.point).dot(axis)), 0.1);  // to the sphere's own facets
  EXPECT_NEAR(length_of(mesh, graph.arcs[0]), 2 * std::numbers::pi * 10, 0.01 * 62.8);
  expect_ties(mesh, graph, Alone(mesh, points));
  expect_complete(mesh, graph, Alone(mesh, points));
}

TEST(voronoi_diagram, of_random_points_holds_by_definition) {
  const std::vector<TriangleMesh> meshes{test::torus(18, 9, 5, 2), test::wavy_sheet(8, 10, 1.5, 0.9, 1.1, 3)};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    const TriangleMesh& mesh = meshes[seed % 2];
    std::vector<SurfacePoint> points;
    for (int k = 0; k < 2 + static_cast<int>(seed) % 7; ++k) {
      points.push_back(seed % 3 == 0 ? test::random_supported_point(rng, mesh) : test::random_surface_point(rng, mesh));
    }
    const BisectorGraph graph = voronoi_of(mesh, points);
    const Alone alone(mesh, points);
    expect_ties(mesh, graph, alone);
    expect_complete(mesh, graph, alone);
    for (const auto& node : graph.nodes) {
      const bool on_boundary = [&] {
        const Vec3 x = position_of(mesh, node.point);
        const auto edges = boundary_edges(mesh);
        return std::any_of(edges.begin(), edges.end(), [&](const auto& e) {
          return distance_to_segment(e.first, e.second, x) < 1e-9 * mesh.size();
        });
      }();
      EXPECT_TRUE(node.arcs.size() > 1 || on_boundary) << "an arc ends inside the surface";
    }
  }
}

}  // namespace
}  // namespace isopath
