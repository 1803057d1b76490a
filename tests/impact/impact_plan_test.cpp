#include "isopath/impact/impact_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "impact/curve_checks.h"
#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/vertex_field.h"
#include "isopath/mesh/read_mesh.h"

namespace isopath {
namespace {

TriangleMesh data_mesh(const char* name) {
  return TriangleMesh(read_mesh(std::filesystem::path(ISOPATH_DATA_DIR) / name).soup);
}

/// A plan from the distance to the boundary.
ImpactPlan plan_from_boundary(const TriangleMesh& mesh, double spacing, Pattern pattern = Pattern::spiral) {
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  return plan_impact(mesh, field, {.pattern = pattern, .spacing = spacing});
}

ImpactPlan plan_from_vertex(const TriangleMesh& mesh, double spacing, Index vertex) {
  SourceSet source;
  source.add_vertex(mesh, vertex);
  const ExactField field = ExactField::compute(mesh, source);
  return plan_impact(mesh, field, {.spacing = spacing});
}

/// What a plan is for: everything is covered, no gap is much wider than the spacing, and the tool does not lift more
/// often than it has to.
void expect_covered(const TriangleMesh& mesh, const ImpactPlan& plan, double spacing, Index pieces = 1) {
  test::expect_valid(mesh, plan.curve);
  EXPECT_EQ(test::pieces_of(plan.curve), pieces);
  EXPECT_EQ(test::lifts_of(plan.curve), pieces - 1);
  EXPECT_TRUE(plan.warnings.empty()) << plan.warnings.front();
  EXPECT_FALSE(plan.contours.empty());
  const GapReport gap = measure_gap(mesh, plan.curve, spacing);
  EXPECT_LE(gap.max, 1.15 * spacing);
  EXPECT_GE(gap.covered_fraction, 0.99);
  const double ratio = length_of(plan.curve, MoveKind::cover) * spacing / mesh.area();
  EXPECT_GE(ratio, 0.9);
  EXPECT_LE(ratio, 1.45);
}

TEST(impact_plan, covers_a_hemisphere_in_one_piece) {
  const TriangleMesh mesh = test::hemisphere(24, 72, 50);
  expect_covered(mesh, plan_from_boundary(mesh, 5), 5);
}

TEST(impact_plan, covers_a_notched_ellipse_in_one_piece) {
  const TriangleMesh mesh = test::notched_ellipse(20, 96, 60, 40);
  expect_covered(mesh, plan_from_boundary(mesh, 5), 5);
}

TEST(impact_plan, covers_a_free_form_patch_in_one_piece) {
  const TriangleMesh mesh = data_mesh("patch_100mm_a.off");
  expect_covered(mesh, plan_from_boundary(mesh, 5), 5);
}

TEST(impact_plan, covers_plates_with_reflex_corners_and_slots) {
  for (const auto& mesh : {test::l_shape(8), test::notched_square(15), test::planar_star(5, 20, 9)}) {
    expect_covered(mesh, plan_from_boundary(mesh, 0.9), 0.9);
  }
}

TEST(impact_plan, covers_what_has_two_boundary_loops_or_none) {
  TriangleSoup soup = test::flat_disc(72, 12, 24).soup();
  std::erase_if(soup.triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](Index v) { return soup.positions[v].norm() < 11; });
  });
  const TriangleMesh annulus(std::move(soup));
  ASSERT_EQ(annulus.boundary_loops().size(), 2u);
  expect_covered(annulus, plan_from_boundary(annulus, 2), 2);
  const TriangleMesh pipe = test::open_cylinder(48, 8, 10, 30);
  expect_covered(pipe, plan_from_boundary(pipe, 2), 2);
  const TriangleMesh ring = test::torus(36, 18, 20, 7);
  expect_covered(ring, plan_from_vertex(ring, 3, 0), 3);
  const TriangleMesh ball = test::icosphere(3, 20);
  expect_covered(ball, plan_from_vertex(ball, 3, 5), 3);
}

TEST(impact_plan, covers_what_has_sharp_edges) {
  const TriangleMesh cube = test::cube(5, 20);
  expect_covered(cube, plan_from_vertex(cube, 2, 3), 2);
  const TriangleMesh knife =
      test::height_grid(20, 10, 20, 10, [](double x, double) { return -10 * std::abs(x - 10.3); });
  expect_covered(knife, plan_from_boundary(knife, 0.9), 0.9);
  const TriangleMesh blade = test::lofted_blade(3, 60);
  expect_covered(blade, plan_from_boundary(blade, 3), 3);
}

/// Rectangle of 30 x 20 with the distance from its lower edge.
struct PlateFromEdge {
  TriangleMesh mesh = test::planar_grid(15, 10, 30, 20, {.jitter = 0.2});
  ExactField field;

  PlateFromEdge() : field(ExactField::compute(mesh, lower_edge(mesh))) {}

  static SourceSet lower_edge(const TriangleMesh& mesh) {
    SourceSet source;
    std::vector<SurfacePoint> points;
    for (int i = 0; i <= 15; ++i) points.push_back(point_at_vertex(mesh, i));
    source.add_polyline(mesh, points, false);
    return source;
  }
};

TEST(impact_plan, meanders_over_a_plate_from_one_edge) {
  const PlateFromEdge plate;
  for (const Pattern pattern : {Pattern::meander, Pattern::spiral}) {
    const ImpactPlan plan = plan_impact(plate.mesh, plate.field, {.pattern = pattern, .spacing = 2});
    expect_covered(plate.mesh, plan, 2);
    double x = 0;
    for (std::size_t i = 1; i < plan.curve.points.size(); ++i) {
      const ImpactPoint& p = plan.curve.points[i];
      const Vec3 step = p.position - plan.curve.points[i - 1].position;
      if (p.kind == MoveKind::link) {
        EXPECT_TRUE(test::on_boundary(plate.mesh, p.at)) << "link " << i;
        EXPECT_NEAR(step.x(), 0, 1e-9) << "link " << i;
      } else {
        EXPECT_NEAR(step.y(), 0, 1e-9) << "cover " << i;
        x += std::abs(step.x());
      }
    }
    EXPECT_NEAR(std::remainder(x, 30), 0, 1e-6);
    const auto passes = static_cast<double>(plan.contours.size());
    EXPECT_NEAR(x, 30 * passes, 1e-6);
    // one link between two passes, of their distance
    EXPECT_NEAR(length_of(plan.curve, MoveKind::link), (passes - 1) * 20 / passes, 1e-6);
  }
}

TEST(impact_plan, leaves_contours_as_they_are_where_that_is_the_pattern) {
  const TriangleMesh mesh = test::planar_grid(15, 15, 30, 30, {.jitter = 0.2});
  const ImpactPlan plan = plan_from_boundary(mesh, 2, Pattern::contour);
  expect_covered(mesh, plan, 2);
  double length = 0;
  for (const Contour& contour : plan.contours) length += length_of(mesh, contour);
  // corners outside the first contour take detours besides
  EXPECT_GE(length_of(plan.curve, MoveKind::cover), length * (1 - 1e-9));
  EXPECT_LE(length_of(plan.curve, MoveKind::cover), length + 4 * 2 * 2);
  // a covering move that is not on a level belongs to a detour
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  std::set<double> levels;
  for (const Contour& contour : plan.contours) levels.insert(contour.level);
  double off_level = 0;
  for (std::size_t i = 1; i < plan.curve.points.size(); ++i) {
    const ImpactPoint& p = plan.curve.points[i];
    const double value = field.value(p.at);
    const bool on_level =
        std::any_of(levels.begin(), levels.end(), [&](double level) { return std::abs(level - value) < 1e-6; });
    if (p.kind == MoveKind::cover && !on_level) off_level += (p.position - plan.curve.points[i - 1].position).norm();
  }
  EXPECT_LE(off_level, 4 * 2 * 2);
}

TEST(impact_plan, of_planes_over_a_plate_is_exactly_parallel) {
  const TriangleMesh mesh = test::planar_grid(14, 9, 40, 20, {.jitter = 0.2});
  for (const double angle : {0.0, 0.4, 0.5 * std::numbers::pi}) {
    const Vec3 up(std::sin(angle), std::cos(angle), 0);
    const double height = 40 * up.x() + 20 * up.y();
    const ImpactPlan plan = plan_impact(mesh, height_field(mesh, up), {.pattern = Pattern::planar, .spacing = 2});
    test::expect_valid(mesh, plan.curve);
    EXPECT_EQ(test::pieces_of(plan.curve), 1);
    const double passes = static_cast<double>(plan.contours.size());
    EXPECT_GE(passes, height / 2);
    EXPECT_LE(passes, height / 1.8);
    for (std::size_t k = 0; k < plan.contours.size(); ++k) {
      const double level = (static_cast<double>(k) + 0.5) * height / passes;
      for (const SurfacePoint& p : plan.contours[k].points) {
        ASSERT_NEAR(position_of(mesh, p).dot(up), level, 1e-7) << "pass " << k;
      }
    }
    if (angle == 0.4) continue;  // the corners that slanted passes leave open take detours
    for (std::size_t i = 1; i < plan.curve.points.size(); ++i) {
      const ImpactPoint& p = plan.curve.points[i];
      if (p.kind == MoveKind::cover) {
        ASSERT_NEAR((p.position - plan.curve.points[i - 1].position).dot(up), 0, 1e-7) << "cover " << i;
      } else {
        ASSERT_TRUE(test::on_boundary(mesh, p.at)) << "link " << i;
      }
    }
    const GapReport gap = measure_gap(mesh, plan.curve, height / passes);
    EXPECT_NEAR(gap.max, height / passes, 1e-6);
    EXPECT_NEAR(gap.mean, 0.5 * height / passes, 0.01 * height / passes);
  }
}

TEST(impact_plan, lifts_once_between_two_components) {
  TriangleSoup soup = test::hemisphere(10, 36, 10).soup();
  const auto n = static_cast<Index>(soup.positions.size());
  const TriangleSoup other = test::hemisphere(10, 36, 10).soup();
  for (const Vec3& p : other.positions) soup.positions.push_back(p + Vec3(25, 3, 0));
  for (const auto& [a, b, c] : other.triangles) soup.triangles.push_back({a + n, b + n, c + n});
  const TriangleMesh mesh(std::move(soup));
  ASSERT_EQ(mesh.n_components(), 2);
  const ImpactPlan plan = plan_from_boundary(mesh, 2);
  expect_covered(mesh, plan, 2, 2);
  const SurfaceLocator surface(mesh);
  const auto& points = plan.curve.points;
  int ways = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (points[i].kind != MoveKind::lift) continue;
    ++ways;
    // off the surface at both ends by a little, no leg meets it
    const bool takes_off = points[i - 1].at.valid();
    const bool touches_down = points[i].at.valid();
    const Vec3 from = points[i - 1].position + (takes_off ? 0.01 : 0.0) * points[i - 1].normal;
    const Vec3 to = points[i].position + (touches_down ? 0.01 : 0.0) * points[i].normal;
    EXPECT_FALSE(surface.intersects(from, to)) << "lift " << i;
  }
  EXPECT_GE(ways, 3);
}

TEST(impact_plan, leaves_alone_what_the_function_does_not_reach) {
  TriangleSoup soup = test::planar_grid(8, 8, 16, 16).soup();
  const auto n = static_cast<Index>(soup.positions.size());
  const TriangleSoup other = soup;
  for (const Vec3& p : other.positions) soup.positions.push_back(p + Vec3(20, 0, 0));
  for (const auto& [a, b, c] : other.triangles) soup.triangles.push_back({a + n, b + n, c + n});
  const TriangleMesh mesh(std::move(soup));
  SourceSet source;
  source.add_halfedges(mesh, mesh.boundary_loops()[0], true);
  const ExactField field = ExactField::compute(mesh, source);
  const ImpactPlan plan = plan_impact(mesh, field, {.spacing = 2});
  test::expect_valid(mesh, plan.curve);
  EXPECT_EQ(test::pieces_of(plan.curve), 1);
  const Index component = mesh.component_of(TriangleMesh::face_of(mesh.boundary_loops()[0][0]));
  for (const ImpactPoint& p : plan.curve.points) EXPECT_EQ(mesh.component_of(p.at.face), component);
  const GapReport gap = measure_gap(mesh, plan.curve, 2);
  EXPECT_NEAR(gap.covered_fraction, 0.5, 0.01);
  EXPECT_EQ(gap.max, infinity);
}

TEST(impact_plan, says_why_when_there_is_none) {
  const TriangleMesh mesh = test::planar_grid(3, 3, 3, 3);
  const VertexField nowhere(mesh, std::vector<double>(mesh.n_vertices(), infinity));
  try {
    plan_impact(mesh, nowhere, {.spacing = 1});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::no_plan);
    EXPECT_FALSE(error.where().advice.empty());
  }
  const VertexField height = height_field(mesh, Vec3::UnitX());
  const auto refused = [&](const ImpactOptions& options, const char* element) {
    try {
      plan_impact(mesh, height, options);
      ADD_FAILURE() << element;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_usage);
      EXPECT_EQ(error.where().element, element);
      EXPECT_FALSE(error.where().value.empty());
    }
  };
  for (const double spacing : {0.0, -1.0, std::nan(""), infinity}) refused({.spacing = spacing}, "option spacing");
  for (const double clearance : {-1.0, std::nan(""), infinity}) {
    refused({.spacing = 1, .clearance = clearance}, "option clearance");
  }
}

TEST(impact_plan, has_the_documented_defaults) {
  const ImpactOptions options;
  EXPECT_EQ(options.pattern, Pattern::spiral);
  EXPECT_EQ(options.spacing, 0);
  EXPECT_EQ(options.clearance, 0);
  EXPECT_EQ(name_of(Pattern::contour), "contour");
  EXPECT_EQ(name_of(Pattern::spiral), "spiral");
  EXPECT_EQ(name_of(Pattern::meander), "meander");
  EXPECT_EQ(name_of(Pattern::planar), "planar");
  EXPECT_EQ(name_of(Pattern::two_way), "two-way");
}

}  // namespace
}  // namespace isopath
