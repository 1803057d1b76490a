#include "isopath/field/warp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

std::vector<MetricTensor> tensors_on(const TriangleMesh& mesh, const std::function<MetricTensor(const Vec3&)>& at) {
  std::vector<MetricTensor> tensors;
  for (Index v = 0; v < mesh.n_vertices(); ++v) tensors.push_back(at(mesh.position(v)));
  return tensors;
}

MetricTensor round(double stretch) { return {Vec3::UnitX(), Vec3::UnitY(), stretch, stretch}; }

TriangleMesh turned_over(const TriangleMesh& mesh) {
  TriangleSoup soup = mesh.soup();
  for (Triangle& t : soup.triangles) std::swap(t[1], t[2]);
  return TriangleMesh(std::move(soup));
}

ToolMetric tool_metric_of(const TriangleMesh& mesh, double radius) {
  return tool_metric(principal_curvatures(mesh, SmoothNormals(mesh)), radius);
}

/// Distance from the side x = 0 of a sheet of width 1, in the metric, at (1, 0).
double width_in(const TriangleMesh& mesh, const std::vector<MetricTensor>& tensors, const WarpOptions& options) {
  const WarpedSurface surface = warp_surface(mesh, tensors, options);
  const TriangleMesh& fine = surface.refined.mesh;
  SourceSet sources;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (mesh.position(v).x() == 0) sources.add_point(point_at_vertex(fine, v));
  }
  const ExactField field = ExactField::compute(fine, IntrinsicGeometry(fine, surface.edge_lengths), sources);
  double found = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (mesh.position(v) == Vec3(1, 0, 0)) found = field.value_at_vertex(v);
  }
  return found;
}

TEST(Warp, ConstantTensorsStretchAPlaneAndSplitNothing) {
  const TriangleMesh mesh = planar_grid(5, 4, 3, 2, {.jitter = 0.2});
  const double c = std::cos(0.4);
  const double s = std::sin(0.4);
  const MetricTensor tensor{Vec3(c, s, 0), Vec3(-s, c, 0), 2, 0.3};
  for (const TensorBlend blend : {TensorBlend::linear, TensorBlend::paper}) {
    const WarpedSurface surface =
        warp_surface(mesh, tensors_on(mesh, [&](const Vec3&) { return tensor; }), {.blend = blend});
    ASSERT_EQ(surface.refined.mesh.n_faces(), mesh.n_faces());
    EXPECT_EQ(surface.added_length, 0);
    for (Index e = 0; e < mesh.n_edges(); ++e) {
      const Index h = mesh.halfedge_of(e);
      const Vec3 edge = mesh.position(mesh.to(h)) - mesh.position(mesh.from(h));
      EXPECT_NEAR(surface.edge_lengths[e], std::hypot(2 * tensor.first.dot(edge), 0.3 * tensor.second.dot(edge)),
                  1e-13);
    }
  }
}

TEST(Warp, DirectionsMayPointEitherWay) {
  const TriangleMesh mesh = icosphere(2, 3);
  Rng rng(2);
  std::vector<MetricTensor> tensors;
  std::vector<MetricTensor> flipped;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 n = mesh.position(v).normalized();
    MetricTensor t{n.unitOrthogonal(), n.cross(n.unitOrthogonal()), 1 + 0.1 * n.x(), 1 - 0.1 * n.y()};
    tensors.push_back(t);
    if (random_index(rng, 2) == 0) t.first = -t.first;
    if (random_index(rng, 2) == 0) t.second = -t.second;
    flipped.push_back(t);
  }
  const WarpedSurface a = warp_surface(mesh, tensors);
  const WarpedSurface b = warp_surface(mesh, flipped);
  ASSERT_EQ(a.edge_lengths.size(), b.edge_lengths.size());
  for (std::size_t e = 0; e < a.edge_lengths.size(); ++e) EXPECT_NEAR(a.edge_lengths[e], b.edge_lengths[e], 1e-12);
}

TEST(Warp, SplittingBringsTheLengthOfARapidlyChangingMetricNear) {
  // stretch 1 + 20 x²: the side at x = 1 is 1 + 20/3 away; the mesh has four cells along x
  const TriangleMesh mesh = planar_grid(4, 4, 1, 1);
  const auto tensors = tensors_on(mesh, [](const Vec3& p) { return round(1 + 20 * p.x() * p.x()); });
  const double truth = 1 + 20.0 / 3;
  const double whole = std::abs(width_in(mesh, tensors, {.max_levels = 0}) - truth);
  const double split = std::abs(width_in(mesh, tensors, {.max_levels = 6}) - truth);
  EXPECT_GT(whole, 0.04 * truth);
  // what stays is that squared stretches are interpolated between the given vertices
  double between = 0;
  for (int i = 0; i < 4; ++i) {
    const auto square = [](double x) { return (1 + 20 * x * x) * (1 + 20 * x * x); };
    for (int k = 0; k < 1000; ++k) {
      const double t = (k + 0.5) / 1000;
      between += std::sqrt((1 - t) * square(0.25 * i) + t * square(0.25 * (i + 1))) / 4000;
    }
  }
  EXPECT_NEAR(width_in(mesh, tensors, {.max_levels = 6}), between, 0.004 * truth);
  EXPECT_LT(split, whole);
}

TEST(Warp, TrianglesAreSplitUntilBothTestsHold) {
  const TriangleMesh mesh = planar_grid(4, 4, 1, 1);
  const auto tensors = tensors_on(mesh, [](const Vec3& p) { return round(std::exp(3 * p.x())); });
  const WarpOptions options{.midpoint_shift = 0.01, .length_excess = 0.002, .max_levels = 8};
  const WarpedSurface surface = warp_surface(mesh, tensors, options);
  const TriangleMesh& fine = surface.refined.mesh;
  EXPECT_GT(fine.n_faces(), 4 * mesh.n_faces());
  for (Index e = 0; e < fine.n_edges(); ++e) {
    const Index h = fine.halfedge_of(e);
    const MetricTensor& a = surface.tensors[fine.from(h)];
    const MetricTensor& b = surface.tensors[fine.to(h)];
    const Vec3 half = 0.5 * (fine.position(fine.to(h)) - fine.position(fine.from(h)));
    const MetricTensor middle = blended({a, b, b}, {0.5, 0.5, 0}, TensorBlend::linear);
    const double first = edge_length(half, a, middle, TensorBlend::linear);
    const double sum = first + edge_length(half, middle, b, TensorBlend::linear);
    EXPECT_LE(std::abs(first / sum - 0.5), 0.01 + 1e-12);
    EXPECT_LE(std::abs(sum / surface.edge_lengths[e] - 1), 0.002 + 1e-12);
  }
}

TEST(Warp, ShortEdgesAreNotWorthSplitting) {
  const TriangleMesh mesh = planar_grid(4, 4, 1, 1);
  const auto tensors = tensors_on(mesh, [](const Vec3& p) { return round(std::exp(3 * p.x())); });
  const auto n_faces = [&](double shortest) {
    return warp_surface(mesh, tensors, {.midpoint_shift = 0.001, .shortest_edge = shortest, .max_levels = 5})
        .refined.mesh.n_faces();
  };
  const WarpedSurface surface =
      warp_surface(mesh, tensors, {.midpoint_shift = 0.001, .shortest_edge = 0.5, .max_levels = 5});
  const TriangleMesh& fine = surface.refined.mesh;
  EXPECT_GT(fine.n_faces(), mesh.n_faces());
  EXPECT_LT(fine.n_faces(), n_faces(0) / 10);
  EXPECT_EQ(n_faces(100), mesh.n_faces());
  for (Index f = 0; f < fine.n_faces(); ++f) {
    double longest = 0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) longest = std::max(longest, surface.edge_lengths[fine.edge_of(h)]);
    EXPECT_GT(longest, 0.2) << "what was split had an edge longer than 0.5";
  }
}

TEST(Warp, BrokenTrianglesAreMendedBySplittingFirst) {
  // every second vertex stretches along the diagonals: they get longer than the two sides together
  const TriangleMesh mesh = planar_grid(4, 4, 1, 1);
  const double r = std::sqrt(0.5);
  std::vector<MetricTensor> tensors(mesh.n_vertices());
  for (Index v = 0; v < mesh.n_vertices(); v += 2) tensors[v] = {Vec3(r, r, 0), Vec3(-r, r, 0), 3, 1};
  const WarpedSurface whole = warp_surface(mesh, tensors, {.max_levels = 0});
  EXPECT_GT(whole.broken_faces, 0);
  EXPECT_GT(whole.added_length, 0);
  EXPECT_NO_THROW(IntrinsicGeometry(mesh, whole.edge_lengths));
  std::vector<double> less = whole.edge_lengths;
  for (double& l : less) l -= 0.01 * whole.added_length;
  EXPECT_THROW(IntrinsicGeometry(mesh, less), Error) << "what was added is the least";

  // here only splitting helps: no test but the triangle inequality asks for it
  const WarpOptions lax{.midpoint_shift = 0.49, .length_excess = 100, .max_levels = 6};
  const WarpedSurface split = warp_surface(mesh, tensors, lax);
  EXPECT_EQ(split.broken_faces, 0);
  EXPECT_EQ(split.added_length, 0);
  EXPECT_GT(split.refined.mesh.n_faces(), mesh.n_faces());
  EXPECT_NO_THROW(IntrinsicGeometry(split.refined.mesh, split.edge_lengths));
}

TEST(Warp, RefusesTensorsThatMeasureNothing) {
  const TriangleMesh mesh = planar_grid(2, 2, 1, 1);
  const std::vector<MetricTensor> good(mesh.n_vertices());
  const auto what = [&](const std::vector<MetricTensor>& tensors, const WarpOptions& options = {}) -> std::string {
    try {
      warp_surface(mesh, tensors, options);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(what(good), "");
  EXPECT_NE(what({}).find("one tensor for each vertex"), std::string::npos);
  std::vector<MetricTensor> bad = good;
  bad[3].second_stretch = 0;
  EXPECT_NE(what(bad).find("vertex 3"), std::string::npos);
  bad = good;
  bad[4].first = Vec3(1, 1, 0);
  EXPECT_NE(what(bad).find("vertex 4"), std::string::npos);
  EXPECT_NE(what(good, {.midpoint_shift = 0.5}).find("midpoint_shift"), std::string::npos);
  EXPECT_NE(what(good, {.length_excess = 0}).find("length_excess"), std::string::npos);
  EXPECT_NE(what(good, {.shortest_edge = -1}).find("shortest_edge"), std::string::npos);
  EXPECT_NE(what(good, {.max_levels = -1}).find("max_levels"), std::string::npos);
}

/// Edges by their lengths in the metric over those in space.
std::pair<double, double> stretch_range(const WarpedSurface& surface, const std::function<bool(const Vec3&)>& counts) {
  const TriangleMesh& mesh = surface.refined.mesh;
  std::pair<double, double> range(infinity, 0);
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    const Index h = mesh.halfedge_of(e);
    if (!counts((mesh.position(mesh.to(h)) - mesh.position(mesh.from(h))).normalized())) continue;
    const double stretch = surface.edge_lengths[e] / mesh.edge_length(e);
    range = {std::min(range.first, stretch), std::max(range.second, stretch)};
  }
  return range;
}

TEST(ToolMetric, BallsStretchEvenlyByTheirCurvature) {
  const auto all = [](const Vec3&) { return true; };
  const TriangleMesh convex = icosphere(4, 20);
  const auto [low, high] = stretch_range(warp_surface(convex, tool_metric_of(convex, 5).tensors), all);
  EXPECT_NEAR(low, std::sqrt(1.25), 0.005);
  EXPECT_NEAR(high, std::sqrt(1.25), 0.005);
  const TriangleMesh concave = turned_over(convex);
  const auto [least, most] = stretch_range(warp_surface(concave, tool_metric_of(concave, 5).tensors), all);
  EXPECT_NEAR(least, std::sqrt(0.75), 0.005);
  EXPECT_NEAR(most, std::sqrt(0.75), 0.005);
}

TEST(ToolMetric, CylindersStretchAcrossAndNotAlong) {
  const TriangleMesh mesh = open_cylinder(100, 10, 20, 30);
  const WarpedSurface surface = warp_surface(mesh, tool_metric_of(mesh, 5).tensors);
  EXPECT_EQ(surface.refined.mesh.n_faces(), mesh.n_faces());
  const auto along = stretch_range(surface, [](const Vec3& d) { return std::abs(d.z()) > 0.999; });
  const auto across = stretch_range(surface, [](const Vec3& d) { return std::abs(d.z()) < 1e-6; });
  EXPECT_NEAR(along.first, 1, 1e-3);
  EXPECT_NEAR(along.second, 1, 1e-3);
  EXPECT_NEAR(across.first, std::sqrt(1.25), 2e-3);
  EXPECT_NEAR(across.second, std::sqrt(1.25), 2e-3);
}

TEST(ToolMetric, NormalsTellTheSameOnEvenMeshes) {
  const TriangleMesh mesh = open_cylinder(100, 10, 20, 30);
  const std::vector<double> lengths = edge_lengths_by_normals(mesh, SmoothNormals(mesh), 5);
  const std::vector<double> by_tensors = warp_surface(mesh, tool_metric_of(mesh, 5).tensors).edge_lengths;
  for (Index e = 0; e < mesh.n_edges(); ++e) EXPECT_NEAR(lengths[e] / by_tensors[e], 1, 0.002);
  EXPECT_NO_THROW(IntrinsicGeometry(mesh, lengths));
}

TEST(ToolMetric, ReportsWhereTheBallHardlyFitsAndWhereItDoesNot) {
  // hollows of radius 10 and tools of several radii
  const TriangleMesh mesh = turned_over(open_cylinder(100, 10, 10, 30));
  const auto metric = [&](double radius) { return tool_metric_of(mesh, radius); };
  EXPECT_TRUE(metric(9).clamped.empty());
  EXPECT_EQ(static_cast<Index>(metric(9.7).clamped.size()), mesh.n_vertices());
  EXPECT_TRUE(metric(9.7).gouged.empty());
  const ToolMetric too_large = metric(12);
  EXPECT_EQ(static_cast<Index>(too_large.gouged.size()), mesh.n_vertices());
  for (const MetricTensor& t : too_large.tensors) EXPECT_EQ(t.first_stretch, 0.25);
  EXPECT_THROW(metric(0), Error);
  EXPECT_THROW(tool_metric({}, 5, 0), Error);
  EXPECT_THROW(tool_metric({}, 5, 1.1), Error);
}

}  // namespace
}  // namespace isopath::test
