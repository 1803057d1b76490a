#include "isopath/impact/two_way.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "impact/curve_checks.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/vertex_field.h"
#include "isopath/impact/boundary_rings.h"
#include "isopath/impact/impact_plan.h"
#include "isopath/impact/passes.h"
#include "isopath/impact/ring.h"
#include "isopath/impact/ring_joints.h"

namespace isopath {
namespace {

struct Hole {
  Vec2 centre;
  double radius = 0;
};

/// A mesh over the plane without the faces inside the holes; the rims are drawn onto the circles, so that they are
/// smooth.
TriangleMesh with_holes(const TriangleMesh& mesh, const std::vector<Hole>& holes) {
  TriangleSoup soup = mesh.soup();
  const auto place = [&](Index v) { return Vec2(soup.positions[v].head<2>()); };
  std::vector<const Hole*> inside(soup.positions.size(), nullptr);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    for (const Hole& hole : holes) {
      if ((place(v) - hole.centre).norm() < hole.radius) inside[v] = &hole;
    }
  }
  std::erase_if(soup.triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](Index v) { return inside[v] != nullptr; });
  });
  for (const Triangle& t : soup.triangles) {
    for (const Index v : t) {
      if (!inside[v]) continue;
      const Vec2 out = inside[v]->radius * (place(v) - inside[v]->centre).normalized();
      soup.positions[v].head<2>() = inside[v]->centre + out;
    }
  }
  return TriangleMesh(std::move(soup));
}

TriangleMesh plate_with_holes(std::size_t n) {
  const std::vector<Hole> holes = {{{15.1, 20.2}, 6.8}, {{42.3, 26.4}, 5.7}, {{41.2, 9.4}, 4.1}};
  return with_holes(test::planar_grid(60, 40, 60, 40), {holes.begin(), holes.begin() + n});
}

ImpactPlan plan_two_way(const TriangleMesh& mesh, const SurfaceFunction& function, double spacing) {
  return plan_impact(mesh, function, {.pattern = Pattern::two_way, .spacing = spacing});
}

bool is_closed(const ImpactCurve& curve) { return curve.points.front().position == curve.points.back().position; }

/// One closed curve without a lift that leaves no gap.
void expect_one_closed_curve(const TriangleMesh& mesh, const ImpactPlan& plan, double spacing, double most_length) {
  test::expect_valid(mesh, plan.curve);
  EXPECT_EQ(test::pieces_of(plan.curve), 1);
  EXPECT_EQ(test::lifts_of(plan.curve), 0);
  EXPECT_TRUE(is_closed(plan.curve));
  EXPECT_TRUE(plan.warnings.empty());
  const GapReport gap = measure_gap(mesh, plan.curve, spacing);
  EXPECT_LE(gap.max, 1.05 * spacing);
  EXPECT_GE(gap.covered_fraction, 0.998);
  EXPECT_LE(length_of(plan.curve, MoveKind::cover) * spacing / mesh.area(), most_length);
}

void expect_one_closed_curve_from_boundary(const TriangleMesh& mesh, double spacing, double most_length) {
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  expect_one_closed_curve(mesh, plan_two_way(mesh, field, spacing), spacing, most_length);
}

ExactField from_vertex(const TriangleMesh& mesh, Index vertex) {
  SourceSet source;
  source.add_vertex(mesh, vertex);
  return ExactField::compute(mesh, source);
}

TEST(two_way, is_one_closed_curve_around_any_number_of_holes) {
  for (std::size_t n = 0; n < 4; ++n) {
    const TriangleMesh mesh = plate_with_holes(n);
    ASSERT_EQ(mesh.boundary_loops().size(), n + 1);
    SCOPED_TRACE(n);
    expect_one_closed_curve_from_boundary(mesh, 2, 1.3);
  }
}

TEST(two_way, is_one_closed_curve_over_a_notch_and_over_a_bump) {
  expect_one_closed_curve_from_boundary(test::notched_ellipse(20, 96, 60, 40), 5, 1.2);
  // from one side the fronts go round the bump and meet behind it
  const TriangleMesh bump = test::height_grid(40, 40, 40, 40, [](double x, double y) {
    return 12 * std::exp(-((x - 20) * (x - 20) + (y - 20) * (y - 20)) / 30);
  });
  expect_one_closed_curve_from_boundary(bump, 2, 1.2);
  SourceSet side;
  std::vector<SurfacePoint> points;
  for (int i = 0; i <= 40; ++i) points.push_back(point_at_vertex(bump, i));
  side.add_polyline(bump, points, false);
  expect_one_closed_curve(bump, plan_two_way(bump, ExactField::compute(bump, side), 2), 2, 1.2);
}

TEST(two_way, is_one_closed_curve_on_closed_surfaces) {
  const TriangleMesh ball = test::icosphere(3, 20);
  expect_one_closed_curve(ball, plan_two_way(ball, from_vertex(ball, 5), 3), 3, 1.2);
  const TriangleMesh ring = test::torus(36, 18, 20, 7);
  expect_one_closed_curve(ring, plan_two_way(ring, from_vertex(ring, 0), 3), 3, 1.2);
  const TriangleMesh cube = test::cube(5, 20);
  expect_one_closed_curve(cube, plan_two_way(cube, from_vertex(cube, 3), 2), 2, 1.2);
}

TEST(two_way, is_one_closed_curve_on_a_pipe_from_any_source) {
  const TriangleMesh pipe = test::open_cylinder(48, 10, 10, 30);
  expect_one_closed_curve_from_boundary(pipe, 2, 1.2);
  expect_one_closed_curve(pipe, plan_two_way(pipe, from_vertex(pipe, 7), 2), 2, 1.3);
  expect_one_closed_curve(pipe, plan_two_way(pipe, height_field(pipe, Vec3::UnitZ()), 2), 2, 1.2);
}

TEST(two_way, joins_the_ends_of_open_passes_along_the_boundary) {
  for (const double depth : {20.0, 21.9}) {  // an even and an odd number of passes
    const TriangleMesh plate = test::planar_grid(15, 10, 30, depth, {.jitter = 0.2});
    expect_one_closed_curve(plate, plan_two_way(plate, height_field(plate, Vec3::UnitY()), 2), 2, 1.4);
  }
  const TriangleMesh plate = plate_with_holes(3);
  expect_one_closed_curve(plate, plan_two_way(plate, height_field(plate, Vec3::UnitX()), 2), 2, 1.4);
}

TEST(two_way, is_a_closed_curve_on_every_component) {
  TriangleSoup soup = test::planar_grid(8, 8, 16, 16).soup();
  const auto n = static_cast<Index>(soup.positions.size());
  const TriangleSoup other = soup;
  // the second plate lies over the first one, nearer than neighbouring passes
  for (const Vec3& p : other.positions) soup.positions.push_back(p + Vec3(1, 0, 1));
  for (const auto& [a, b, c] : other.triangles) soup.triangles.push_back({a + n, b + n, c + n});
  const TriangleMesh mesh(std::move(soup));
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  const Passes passes = choose_passes(mesh, field, 2, Progress::none());
  const SurfaceLocator locator(mesh);
  const std::vector<SurfaceCurve> curves = two_way({mesh, locator}, passes.contours, passes.spacing);
  ASSERT_EQ(curves.size(), 2u);
  std::set<Index> components;
  for (const SurfaceCurve& curve : curves) {
    test::expect_on_surface(mesh, curve);
    EXPECT_EQ(curve.positions.front(), curve.positions.back());
    components.insert(mesh.component_of(curve.points.front().face));
  }
  EXPECT_EQ(components.size(), 2u);
  const ImpactPlan plan = plan_two_way(mesh, field, 2);
  test::expect_valid(mesh, plan.curve);
  EXPECT_EQ(test::lifts_of(plan.curve), 1);
}

TEST(two_way, inserts_rings_into_a_curve_that_keeps_its_ends) {
  const TriangleMesh mesh = test::planar_grid(20, 20, 20, 20);
  const SurfaceLocator locator(mesh);
  const SurfaceLinker linker(mesh, locator);
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  const std::vector<double> levels = {4.5, 5.5};
  const std::vector<Contour> rings = isolines(mesh, field, levels);
  SurfaceCurve line;  // beside the outer one of them
  for (int i = 1; i < 40; ++i) line.add(mesh, locator.nearest(Vec3(0.5 * i, 3.5, 0)).at);
  const std::vector<SurfaceCurve> joined = joined_to_curve(linker, line, rings, 1);
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_EQ(joined[0].positions.front(), line.positions.front());
  EXPECT_EQ(joined[0].positions.back(), line.positions.back());
  // each joint takes out two cuts of 0.18 and adds two rungs of 1
  const double all = length_of(line) + length_of(mesh, rings[0]) + length_of(mesh, rings[1]);
  EXPECT_NEAR(length_of(joined[0]), all + 2 * (2 - 2 * 0.18), 1e-6);

  const std::vector<SurfaceCurve> alone = joined_to_curve(linker, line, {}, 1);
  ASSERT_EQ(alone.size(), 1U);
  EXPECT_EQ(alone[0].positions, line.positions);
}

TEST(two_way, walks_every_pass_but_for_its_cuts) {
  const TriangleMesh disc = test::flat_disc(72, 12, 24);
  const ExactField field = from_vertex(disc, 0);
  const Passes passes = choose_passes(disc, field, 2, Progress::none());
  const SurfaceLocator locator(disc);
  const SurfaceLinker linker(disc, locator);
  const std::vector<SurfaceCurve> curves = two_way(linker, passes.contours, passes.spacing);
  ASSERT_EQ(curves.size(), 1u);
  double length = 0;
  for (const Contour& contour : passes.contours) length += length_of(disc, contour);
  // a tree of n passes has n - 1 edges, each with a turn and a stretch of the lane, or another turn; a pass loses no
  // more than 1.2 spacings where it is cut
  const double edges = static_cast<double>(passes.contours.size()) - 1;
  EXPECT_LE(length_of(curves[0]), length + 2 * edges * passes.spacing * 1.1);
  EXPECT_GE(length_of(curves[0]), length + (2 * edges - 1.2 * (edges + 1)) * passes.spacing);
  // off the circles the curve is on rungs only
  double off = 0;
  for (std::size_t i = 1; i < curves[0].size(); ++i) {
    const double mean = 0.5 * (field.value(curves[0].points[i]) + field.value(curves[0].points[i - 1]));
    const double level = (std::round(mean / passes.spacing - 0.5) + 0.5) * passes.spacing;
    if (std::abs(mean - level) > 0.05 * passes.spacing)
      off += (curves[0].positions[i] - curves[0].positions[i - 1]).norm();
  }
  EXPECT_LE(off, 2 * edges * passes.spacing * 1.1);
  EXPECT_GE(off, 2 * edges * passes.spacing * 0.5);
}

/// The rings are one tree, cuts do not overlap, and every end of a cut has one rung.
void expect_tree(const TriangleMesh& mesh, const std::vector<Ring>& rings, const std::vector<RingJoint>& joints) {
  std::vector<std::size_t> root(rings.size());
  for (std::size_t k = 0; k < root.size(); ++k) root[k] = k;
  std::vector<std::vector<std::pair<double, double>>> cuts(rings.size());
  std::size_t edges = 0;
  for (const RingJoint& joint : joints) {
    ASSERT_GE(joint.cuts.size(), 2u);
    for (std::size_t c = 1; c < joint.cuts.size(); ++c) {
      const std::size_t a = root[joint.cuts[c - 1].ring];
      const std::size_t b = root[joint.cuts[c].ring];
      ASSERT_NE(a, b) << "a joint closes a loop";
      std::replace(root.begin(), root.end(), a, b);
      ++edges;
    }
    for (const auto& cut : joint.cuts) {
      const Ring& ring = rings[cut.ring];
      const double length = ring.wrapped(cut.high - cut.low);
      EXPECT_GT(length, 0);
      EXPECT_LT(length, 0.3 * ring.length());
      for (const auto& [low, other] : cuts[cut.ring]) {
        EXPECT_GT(ring.wrapped(cut.low - low), other);
        EXPECT_GT(ring.wrapped(low - cut.low), length);
      }
      cuts[cut.ring].emplace_back(cut.low, length);
    }
    std::set<std::pair<Index, bool>> ends;
    const auto expect_at = [&](const Vec3& position, const RingJoint::End& end) {
      const RingJoint::Cut& cut = joint.cuts[end.cut];
      EXPECT_NEAR((position - rings[cut.ring].position(end.high ? cut.high : cut.low)).norm(), 0, 1e-9);
      EXPECT_TRUE(ends.insert({end.cut, end.high}).second) << "two rungs at one end";
    };
    for (const RingJoint::Rung& rung : joint.rungs) {
      test::expect_on_surface(mesh, rung.curve);
      expect_at(rung.curve.positions.front(), rung.from);
      expect_at(rung.curve.positions.back(), rung.to);
    }
    EXPECT_EQ(ends.size(), 2 * joint.cuts.size());
  }
  EXPECT_EQ(edges + 1, rings.size());
}

TEST(ring_joints, make_a_tree_whose_cuts_do_not_overlap) {
  for (std::size_t holes = 0; holes < 4; ++holes) {
    SCOPED_TRACE(holes);
    const TriangleMesh mesh = plate_with_holes(holes);
    const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
    const Passes passes = choose_passes(mesh, field, 1.5, Progress::none());
    const std::vector<Ring> rings = rings_of(mesh, passes.contours);
    const SurfaceLocator locator(mesh);
    Progress progress;
    expect_tree(mesh, rings, choose_joints({mesh, locator}, rings, passes.spacing, progress));
  }
}

TEST(ring_joints, of_rings_in_a_row_leave_no_gap_and_cost_less_than_a_spacing_each) {
  const double w = 2;
  const TriangleMesh mesh = test::planar_grid(20, 20, 40, 40);  // ten squares
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  const Passes passes = choose_passes(mesh, field, w, Progress::none());
  const std::vector<Ring> rings = rings_of(mesh, passes.contours);
  ASSERT_EQ(rings.size(), 10u);
  const SurfaceLocator locator(mesh);
  const SurfaceLinker linker(mesh, locator);
  Progress progress;
  const std::vector<RingJoint> joints = choose_joints(linker, rings, w, progress);
  ASSERT_GE(joints.front().cuts.size(), 8u) << "but for the innermost, all can be in one row";
  const std::vector<SurfaceCurve> curves = two_way(linker, passes.contours, w);
  ASSERT_EQ(curves.size(), 1u);
  double length = 0;
  for (const Ring& ring : rings) length += ring.length();
  EXPECT_LT(length_of(curves[0]), length + 10 * w);
  // two by two it would be two rungs less two cuts of 0.18 spacings each
  EXPECT_LT(length_of(curves[0]), length + 0.8 * 9 * (2 - 0.36) * w);

  SourceSet source;
  source.add_polyline(mesh, curves[0].points, false);
  const ExactField cover = ExactField::compute(mesh, source);
  int looked_at = 0;
  for (double x = 0.1; x < 40; x += 0.2) {
    for (double y = 0.1; y < 40; y += 0.2) {
      if (std::abs(std::abs(x - 20) - std::abs(y - 20)) < 1.5 * w) continue;  // corners of squares have gaps
      const NearestPoint at = locator.nearest(Vec3(x, y, 0));
      EXPECT_LE(2 * cover.value(at.at), 1.05 * w) << x << " " << y;
      ++looked_at;
    }
  }
  EXPECT_GT(looked_at, 20000);
}

TEST(boundary_rings, use_every_pass_once_and_close) {
  const TriangleMesh mesh = plate_with_holes(3);
  for (const double angle : {0.0, 0.3, 1.2}) {
    const VertexField height = height_field(mesh, Vec3(std::cos(angle), std::sin(angle), 0));
    const std::vector<double> levels = {2.1, 6.3, 10.5, 14.7, 18.9, 23.1, 27.3, 31.5, 35.7};
    const std::vector<Contour> contours = isolines(mesh, height, levels);
    const std::vector<Ring> rings = rings_of(mesh, contours);
    double off_boundary = 0;
    for (const Ring& ring : rings) {
      SurfaceCurve round;
      ring.append_forward(round, 0, 0);
      test::expect_on_surface(mesh, round);
      EXPECT_LE((round.positions.front() - round.positions.back()).norm(), 1e-12);
      for (std::size_t i = 1; i < round.size(); ++i) {
        const bool joins = test::on_boundary(mesh, round.points[i]) && test::on_boundary(mesh, round.points[i - 1]) &&
                           std::abs(height.value(round.points[i]) - height.value(round.points[i - 1])) > 1e-9;
        if (!joins) off_boundary += (round.positions[i] - round.positions[i - 1]).norm();
      }
    }
    double length = 0;
    for (const Contour& contour : contours) length += length_of(mesh, contour);
    // a join along a level of the height counts with the passes
    EXPECT_GE(off_boundary, length * (1 - 1e-9)) << angle;
    EXPECT_LE(off_boundary, length + (angle == 0 ? 80.0 : 1e-6)) << angle;
  }
}

TEST(boundary_rings, walk_to_and_back_where_an_end_is_inside) {
  const TriangleMesh mesh = test::planar_grid(4, 4, 4, 4);
  Contour contour;
  for (const Index v : {6, 7, 8}) contour.points.push_back(point_at_vertex(mesh, v));
  const std::vector<Ring> rings = rings_of(mesh, std::vector<Contour>{contour});
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_NEAR(rings[0].length(), 4, 1e-12);
}

TEST(ring, is_walked_by_arc_length) {
  const TriangleMesh mesh = test::planar_grid(6, 6, 6, 6);
  std::vector<SurfacePoint> square;  // of side 2 from (1, 1)
  for (const Index v : {8, 9, 10, 17, 24, 23, 22, 15}) square.push_back(point_at_vertex(mesh, v));
  const Ring ring(mesh, square);
  ASSERT_NEAR(ring.length(), 8, 1e-12);
  EXPECT_NEAR(ring.wrapped(-1), 7, 1e-12);
  EXPECT_NEAR((ring.position(2.5) - Vec3(3, 1.5, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((position_of(mesh, ring.point(-0.25)) - Vec3(1, 1.25, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR(ring.nearest_arc(Vec3(2.2, 0, 0), 0, 2), 1.2, 1e-12);
  EXPECT_NEAR(ring.nearest_arc(Vec3(0, 1.5, 0), 0.5, 1.5), 7.5, 1e-12);
  test::Rng rng(7);
  for (int i = 0; i < 200; ++i) {
    const double from = test::random_real(rng, -8, 16);
    const double to = test::random_real(rng, -8, 16);
    SurfaceCurve forward;
    ring.append_forward(forward, from, to);
    SurfaceCurve backward;
    ring.append_backward(backward, from, to);
    test::expect_on_surface(mesh, forward);
    test::expect_on_surface(mesh, backward);
    EXPECT_NEAR(length_of(forward), ring.wrapped(to - from), 1e-9) << "case " << i;
    EXPECT_NEAR(length_of(backward), ring.wrapped(from - to), 1e-9) << "case " << i;
    EXPECT_NEAR((forward.positions.back() - ring.position(to)).norm(), 0, 1e-12) << "case " << i;
    EXPECT_NEAR((backward.positions.back() - ring.position(to)).norm(), 0, 1e-12) << "case " << i;
  }
}

}  // namespace
}  // namespace isopath
