#include "isopath/tool/scallop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "isopath/contour/isolines.h"
#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/vertex_field.h"
#include "isopath/field/warp.h"
#include "isopath/impact/impact_plan.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

constexpr double ball = 5;
constexpr double height = 0.02;

TriangleMesh mapped(const TriangleMesh& mesh, const std::function<Vec3(const Vec3&)>& map) {
  TriangleSoup soup = mesh.soup();
  for (Vec3& p : soup.positions) p = map(p);
  return TriangleMesh(std::move(soup));
}

TriangleMesh turned_over(const TriangleMesh& mesh) {
  TriangleSoup soup = mesh.soup();
  for (Triangle& t : soup.triangles) std::swap(t[1], t[2]);
  return TriangleMesh(std::move(soup));
}

/// A sheet bent round a cylinder along y, normals outward; x is the arc length.
TriangleMesh bent(int n, double side, double radius) {
  return mapped(planar_grid(n, n, side, side), [=](const Vec3& p) {
    return Vec3(radius * std::sin(p.x() / radius), p.y(), radius * std::cos(p.x() / radius));
  });
}

ImpactCurve curve_of(const TriangleMesh& mesh, const std::vector<Contour>& contours) {
  ImpactCurve curve;
  for (const Contour& contour : contours) {
    std::vector<SurfacePoint> points = contour.points;
    if (contour.closed) points.push_back(points.front());
    for (std::size_t i = 0; i < points.size(); ++i) {
      ImpactPoint& point = curve.points.emplace_back();
      point.kind = i == 0 ? MoveKind::lift : MoveKind::cover;
      point.at = points[i];
      point.position = position_of(mesh, points[i]);
    }
  }
  return curve;
}

/// Passes a spacing apart, half a spacing from the value 0 on.
std::vector<Contour> passes(const TriangleMesh& mesh, const SurfaceFunction& function, double spacing, double most) {
  std::vector<double> levels;
  for (double level = 0.5 * spacing; level < most; level += spacing) levels.push_back(level);
  return isolines(mesh, function, levels, {.chord_tolerance = 1e-4 * spacing});
}

/// Passes that should leave cusps of this height everywhere, in the metric of the ball, around a vertex or from a side.
struct ConstantScallop {
  WarpedSurface surface;
  std::vector<Contour> contours;
  ScallopReport scallop;
};

ConstantScallop constant_scallop(const TriangleMesh& mesh, double radius, double cusp, const SurfacePoint& source) {
  ConstantScallop out;
  const SurfaceFit fit = fit_surface(mesh, SmoothNormals(mesh));
  out.surface = warp_surface(mesh, tool_metric(fit.curvatures, radius).tensors);
  const TriangleMesh& fine = out.surface.refined.mesh;
  SourceSet sources;
  sources.add_point(source);
  const ExactField field =
      ExactField::compute(fine, IntrinsicGeometry(fine, out.surface.edge_lengths), sources, {.accuracy = 1e-4});
  const double pitch = scallop_pitch(cusp, radius);
  out.contours = passes(fine, field, pitch, field.max_vertex_distance());
  out.scallop =
      measure_scallop(fine, CurvedSurface(mesh, fit).over(mesh, fine), curve_of(fine, out.contours), radius, pitch);
  return out;
}

/// Smallest and largest cusp, over the wanted height, whose top lies this far inside the square [0, side]².
std::pair<double, double> range_inside(const ScallopReport& report, double cusp, double side, double margin,
                                       const std::function<Vec2(const Vec3&)>& on_square) {
  std::pair<double, double> range(infinity, 0);
  int count = 0;
  for (const Cusp& c : report.cusps) {
    const Vec2 at = on_square(c.top);
    if (std::min(at.minCoeff(), side - at.maxCoeff()) < margin) continue;
    ++count;
    range = {std::min(range.first, c.height / cusp), std::max(range.second, c.height / cusp)};
  }
  EXPECT_GT(count, 100);
  return range;
}

Vec2 seen_from_above(const Vec3& p) { return p.head<2>(); }

/// x as a function on a sheet that was made from a square grid with this many cells.
VertexField column_field(const TriangleMesh& mesh, int n, double side) {
  std::vector<double> x;
  for (Index v = 0; v < mesh.n_vertices(); ++v) x.push_back(side * (v % (n + 1)) / n);
  return VertexField(mesh, std::move(x));
}

TEST(Scallop, FormulasAreThoseOfCirclesThatMeet) {
  for (const double w : {0.1, 1.0, 4.0}) {
    const double on_plane = scallop_on_plane(w, ball);
    EXPECT_NEAR(std::hypot(0.5 * w, ball - on_plane), ball, 1e-14);
    for (const double radius : {3.0, 20.0}) {
      // the top of the cusp lies on both balls, whose centres are at a distance ρ + R from the axis
      const double top = radius + scallop_on_convex(w, ball, radius);
      const Vec2 centre = (radius + ball) * Vec2(std::sin(0.5 * w / radius), std::cos(0.5 * w / radius));
      EXPECT_NEAR((centre - Vec2(0, top)).norm(), ball, 1e-13);
    }
    EXPECT_NEAR(scallop_on_convex(w, ball, 1e7), on_plane, 1e-6);
  }
  EXPECT_EQ(scallop_on_plane(2 * ball, ball), infinity);
  EXPECT_EQ(scallop_on_convex(12, ball, 20), infinity);
  // the paper's formula is the first term of the plane's
  EXPECT_NEAR(scallop_on_plane(scallop_pitch(1e-6, ball), ball), 1e-6, 1e-12);
  EXPECT_THROW(scallop_pitch(0, ball), Error);
  EXPECT_THROW(scallop_pitch(ball, ball), Error);
}

TEST(Scallop, MeasuresTheCuspsBetweenStraightPasses) {
  const int n = 30;
  const double side = 12;
  const double radius = 15;
  const double w = 0.9;
  const TriangleMesh plane = planar_grid(n, n, side, side);
  const TriangleMesh convex = bent(n, side, radius);
  const TriangleMesh concave = turned_over(convex);
  // in a hollow the centres run at ρ - R from the axis, and the top is nearer to it than the surface
  const double cos_half = (radius - ball) * std::cos(0.5 * w / radius);
  const double sin_half = (radius - ball) * std::sin(0.5 * w / radius);
  const double hollow = radius - cos_half - std::sqrt((ball - sin_half) * (ball + sin_half));
  const std::pair<const TriangleMesh*, double> cases[] = {
      {&plane, scallop_on_plane(w, ball)}, {&convex, scallop_on_convex(w, ball, radius)}, {&concave, hollow}};
  for (const auto& [mesh, expected] : cases) {
    const auto contours = passes(*mesh, column_field(*mesh, n, side), w, side);
    const ScallopReport report = measure_scallop(*mesh, curve_of(*mesh, contours), ball, w);
    EXPECT_NEAR(report.min, expected, 0.004 * expected);
    EXPECT_NEAR(report.max, expected, 0.004 * expected);
    EXPECT_NEAR(report.mean, expected, 0.002 * expected);
    EXPECT_NEAR(report.open_share, 1.0 / static_cast<double>(contours.size()), 0.02);
    for (Index v = 0; v < mesh->n_vertices(); ++v) {
      const double x = side * (v % (n + 1)) / n;
      if (x > side - w) continue;  // behind the last pass
      const double off = std::remainder(x - 0.5 * w, w);
      EXPECT_NEAR(report.vertex_height[v], expected * 4 * off * off / (w * w), 0.02 * expected) << v;
    }
  }
}

TEST(Scallop, FlatPartsOfSplitTrianglesDoNotCount) {
  // the same passes, measured on the mesh as it is and on one whose triangles were split where they are flat
  const TriangleMesh mesh = bent(16, 12, 15);
  const TriangleMesh finer = split_uniformly(split_uniformly(mesh).mesh).mesh;
  const double w = 0.9;
  const auto along = [&](const TriangleMesh& m) {
    std::vector<double> angle;
    for (Index v = 0; v < m.n_vertices(); ++v) {
      angle.push_back(15 * std::atan2(m.position(v).x(), m.position(v).z()));
    }
    return curve_of(m, passes(m, VertexField(m, std::move(angle)), w, 12));
  };
  const ScallopReport whole = measure_scallop(mesh, along(mesh), ball, w);
  const CurvedSurface surface(mesh);
  const ScallopReport split = measure_scallop(finer, surface.over(mesh, finer), along(finer), ball, w);
  EXPECT_NEAR(split.min, whole.min, 0.01 * whole.min);
  EXPECT_NEAR(split.max, whole.max, 0.01 * whole.max);
  EXPECT_GT(measure_scallop(finer, along(finer), ball, w).max, 1.05 * whole.max) << "facets count";
}

TEST(Scallop, NeedsACurveAndSensibleLengths) {
  const TriangleMesh mesh = planar_grid(2, 2, 1, 1);
  EXPECT_THROW(measure_scallop(mesh, {}, 5, 1), Error);
  EXPECT_THROW(measure_scallop(mesh, {}, 0, 1), Error);
  EXPECT_THROW(measure_scallop(mesh, {}, 5, -1), Error);
}

/// Surfaces of constant or nearly constant curvature over the square of this side.
struct Shape {
  const char* name;
  std::function<Vec3(const Vec3&)> map;  ///< from the square into space
  bool turned = false;
  std::function<Vec2(const Vec3&)> on_square = seen_from_above;
};
constexpr double shape_side = 10;

std::vector<Shape> shapes() {
  const auto bend = [](const Vec3& p) { return Vec3(15 * std::sin(p.x() / 15), p.y(), 15 * std::cos(p.x() / 15)); };
  const auto unrolled = [](const Vec3& p) { return Vec2(15 * std::atan2(p.x(), p.z()), p.y()); };
  const auto ball_top = [](const Vec3& p) {
    return Vec3(p.x(), p.y(), std::sqrt(400 - (p.x() - 5) * (p.x() - 5) - (p.y() - 5) * (p.y() - 5)));
  };
  const auto pass = [](const Vec3& p) {
    return Vec3(p.x(), p.y(), ((p.x() - 5) * (p.x() - 5) - (p.y() - 5) * (p.y() - 5)) / 30);
  };
  return {{"plane", [](const Vec3& p) { return p; }}, {"convex cylinder", bend, false, unrolled},
          {"concave cylinder", bend, true, unrolled}, {"convex ball", ball_top},
          {"concave ball", ball_top, true},           {"saddle", pass}};
}

/// Range of the cusps, over the wanted height, that passes around a corner leave: they run in every direction.
std::pair<double, double> cusps_on(const Shape& shape, const TriangleMesh& square) {
  SCOPED_TRACE(shape.name);
  TriangleMesh mesh = mapped(square, shape.map);
  if (shape.turned) mesh = turned_over(mesh);
  const ConstantScallop planned = constant_scallop(mesh, ball, height, point_at_vertex(mesh, 0));
  EXPECT_EQ(planned.surface.added_length, 0);
  return range_inside(planned.scallop, height, shape_side, 2, shape.on_square);
}

TEST(ConstantScallop, IsConstantOnCylindersSpheresAndSaddles) {
  for (const Shape& shape : shapes()) {
    const auto [least, most] = cusps_on(shape, planar_grid(30, 30, shape_side, shape_side));
    EXPECT_GT(least, 0.995) << shape.name;
    EXPECT_LT(most, 1.01) << shape.name;
  }
}

TEST(ConstantScallop, IsConstantOnIrregularTrianglesNearlyAsLargeAsThePitch) {
  const TriangleMesh square = scattered_square(14, shape_side, 7);
  for (const Shape& shape : shapes()) {
    const auto [least, most] = cusps_on(shape, square);
    EXPECT_GT(least, 0.98) << shape.name;
    EXPECT_LT(most, 1.02) << shape.name;
  }
}

TEST(ConstantScallop, EvenPassesLeaveUnevenCuspsOnACylinder) {
  const TriangleMesh mesh = bent(40, 12, 15);
  SourceSet sources;
  sources.add_point(point_at_vertex(mesh, 0));
  const ExactField field = ExactField::compute(mesh, sources, {.accuracy = 1e-4});
  const double pitch = scallop_pitch(height, ball);
  const auto contours = passes(mesh, field, pitch, field.max_vertex_distance());
  const ScallopReport report = measure_scallop(mesh, curve_of(mesh, contours), ball, pitch);
  const auto [least, most] =
      range_inside(report, height, 12, 2, [](const Vec3& p) { return Vec2(15 * std::atan2(p.x(), p.z()), p.y()); });
  EXPECT_NEAR(least, 1, 0.05);
  EXPECT_GT(most, 1.25) << "across the axis cusps are higher by R / ρ = 1/3";
}

double length_of(const TriangleMesh& mesh, const std::vector<Contour>& contours) {
  double sum = 0;
  for (const Contour& contour : contours) sum += isopath::length_of(mesh, contour);
  return sum;
}

TEST(ConstantScallop, IsShorterThanPlanesAtTheSameLargestCusp) {
  constexpr int n = 64;
  constexpr double side = 32;
  constexpr double radius = 3;
  constexpr double wanted = 0.04;
  const TriangleMesh mesh = wavy_sheet(n, side, 4.2, 0.2, 0.2, 11);  // slopes to 40 degrees
  const auto largest = [&](const ScallopReport& report) {
    return wanted * range_inside(report, wanted, side, 2, seen_from_above).second;
  };
  const ConstantScallop planned = constant_scallop(mesh, radius, wanted, point_at_vertex(mesh, 0));
  const double most = largest(planned.scallop);
  const double length = length_of(planned.surface.refined.mesh, planned.contours);
  const VertexField planes = height_field(mesh, Vec3::UnitX());
  double spacing = 0.75 * scallop_pitch(most, radius);
  std::vector<Contour> contours;
  double cusp = 0;
  for (int i = 0; i < 4; ++i) {  // cusps grow with the square of the spacing
    contours = passes(mesh, planes, spacing, side);
    cusp = largest(measure_scallop(mesh, curve_of(mesh, contours), radius, spacing));
    if (std::abs(cusp - most) < 0.01 * most) break;
    spacing *= std::sqrt(most / cusp);
  }
  EXPECT_NEAR(cusp, most, 0.02 * most);
  EXPECT_LT(length, 0.9 * length_of(mesh, contours));
}

}  // namespace
}  // namespace isopath::test
