#include "isopath/field/smooth_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/exact_distances.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

using std::numbers::pi;

using Values = std::vector<double>;

Values sampled(const TriangleMesh& mesh, const std::function<double(const Vec3&)>& f) {
  Values values;
  for (Index v = 0; v < mesh.n_vertices(); ++v) values.push_back(f(mesh.position(v)));
  return values;
}

Values random_values(Rng& rng, Index n) {
  Values values;
  for (Index v = 0; v < n; ++v) values.push_back(random_real(rng, 0, 1));
  return values;
}

double largest_difference(const Values& a, const Values& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TriangleMesh stretched(const TriangleMesh& mesh, const Vec3& factors) {
  TriangleSoup soup = mesh.soup();
  for (Vec3& p : soup.positions) p = p.cwiseProduct(factors);
  return TriangleMesh(std::move(soup));
}

/// Meshes that break the cotangent formula: obtuse triangles, needles of 1:10000, slivers on the boundary.
std::vector<TriangleMesh> hard_meshes() {
  std::vector<TriangleMesh> meshes;
  meshes.push_back(stretched(planar_grid(12, 12, 1, 1, {.jitter = 0.2, .seed = 3}), {1e4, 1, 1}));
  meshes.push_back(stretched(planar_grid(12, 12, 1, 1, {.jitter = 0.2, .seed = 4}), {1, 1e4, 1}));
  meshes.push_back(lofted_blade(40, 30));
  meshes.push_back(stretched(notched_ellipse(10, 60, 3, 2), {1, 1, 200}));
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Rng rng(seed);
    meshes.push_back(random_mesh(rng, {.max_faces = 60, .closed = seed % 3 == 0, .slivers = true}));
  }
  return meshes;
}

TEST(IntrinsicDelaunay, KeepsTheSurfaceAndLeavesNoNegativeWeight) {
  for (const TriangleMesh& mesh : hard_meshes()) {
    const IntrinsicTriangulation t = intrinsic_delaunay(mesh, IntrinsicGeometry(mesh));
    double area = 0;
    for (Index h = 0; h < t.n_halfedges(); ++h) {
      if (h % 3 == 0) area += 0.5 * t.length[h] * t.apex(h).y();
      const Index twin = t.twin[h];
      if (twin == no_index) continue;
      ASSERT_EQ(t.twin[twin], h);
      ASSERT_EQ(t.length[twin], t.length[h]);
      ASSERT_EQ(t.tail[twin], t.tail[TriangleMesh::next(h)]);
      const double a = t.cotangent(h);
      const double b = t.cotangent(twin);
      ASSERT_GE(a + b, -1e-9 * std::max({1.0, std::abs(a), std::abs(b)}));
    }
    EXPECT_NEAR(area, mesh.area(), 1e-7 * mesh.area());
  }
}

TEST(IntrinsicDelaunay, FlipsTheLongDiagonalOfARhombus) {
  const TriangleMesh mesh(TriangleSoup{{{-3, 0, 0}, {0, -1, 0}, {3, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  const IntrinsicTriangulation t = intrinsic_delaunay(mesh, IntrinsicGeometry(mesh));
  EXPECT_TRUE(t.added.empty());
  for (Index h = 0; h < 6; ++h) EXPECT_NEAR(t.length[h], t.twin[h] == no_index ? std::sqrt(10.0) : 2, 1e-14);
}

TEST(SurfaceLaplacian, AreasAddUpToTheSurface) {
  for (const TriangleMesh& mesh :
       {torus(24, 12, 3, 1), notched_ellipse(8, 60, 3, 2), planar_grid(9, 9, 4, 3, {.jitter = 0.24})}) {
    const SurfaceLaplacian laplacian = surface_laplacian(mesh);
    double sum = 0;
    for (const double area : laplacian.area) {
      EXPECT_GT(area, 0);
      sum += area;
    }
    EXPECT_NEAR(sum, mesh.area(), 1e-9 * mesh.area());
  }
}

TEST(SurfaceLaplacian, OfALinearFunctionIsZeroInsideAFlatSurface) {
  std::vector<TriangleMesh> meshes = {planar_grid(10, 10, 1, 1, {.jitter = 0.24, .seed = 7})};
  meshes.push_back(stretched(meshes[0], {100, 1, 1}));
  meshes.push_back(planar_star(9, 3, 1));
  for (const TriangleMesh& mesh : meshes) {
    const SurfaceLaplacian laplacian = surface_laplacian(mesh);
    Values f = sampled(mesh, [](const Vec3& p) { return 2 * p.x() - 3 * p.y() + 5; });
    for (const auto& [a, b, t] : laplacian.added) f.push_back((1 - t) * f[a] + t * f[b]);
    Values sum(f.size(), 0.0);
    Values size(f.size(), 0.0);
    for (const auto& [a, b, weight] : laplacian.edges) {
      sum[a] += weight * (f[b] - f[a]);
      sum[b] += weight * (f[a] - f[b]);
      size[a] += weight * std::abs(f[b] - f[a]);
      size[b] += weight * std::abs(f[b] - f[a]);
    }
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      if (!mesh.is_boundary_vertex(v)) {
        EXPECT_NEAR(sum[v], 0, 1e-9 * size[v]) << v;
      }
    }
  }
}

TEST(SmoothField, KeepsConstants) {
  for (const TriangleMesh& mesh : hard_meshes()) {
    const SurfaceLaplacian laplacian = surface_laplacian(mesh);
    const Values ones(mesh.n_vertices(), 7.0);
    const double width = 0.1 * mesh.size();
    EXPECT_LT(largest_difference(diffused(laplacian, ones, {.width = width}), ones), 1e-12);
    EXPECT_LT(largest_difference(relaxed(laplacian, ones, {}), ones), 1e-12);
  }
  const TriangleMesh mesh = wavy_sheet(12, 10, 1, 1, 1, 3);
  const Values ones(mesh.n_vertices(), 7.0);
  EXPECT_LT(largest_difference(convolved(mesh, surface_laplacian(mesh), ones, {.radius = 3}), ones), 1e-12);
}

/// Σ A f, without what restores it, as nothing flows over the boundary.
TEST(SmoothField, ImplicitDiffusionConservesTheVolumeByItself) {
  Rng rng(5);
  for (const TriangleMesh& mesh : {torus(24, 12, 3, 1), wavy_sheet(15, 10, 1, 1, 1, 3), icosphere(3, 2)}) {
    const SurfaceLaplacian laplacian = surface_laplacian(mesh);
    ASSERT_TRUE(laplacian.added.empty());
    const Values f = random_values(rng, mesh.n_vertices());
    const double volume = volume_under(laplacian, f);
    const Values g = diffused(laplacian, f, {.width = 0.7, .conserve_volume = false});
    EXPECT_NEAR(volume_under(laplacian, g), volume, 1e-11 * volume);
    EXPECT_GT(largest_difference(f, g), 0.1);
  }
}

TEST(SmoothField, HeldValuesStayAndTheVolumeIsRestored) {
  const TriangleMesh mesh = wavy_sheet(20, 10, 0.5, 1, 1, 3);
  const SurfaceLaplacian laplacian = surface_laplacian(mesh);
  const Values f = exact_distances(mesh, boundary_source(mesh));
  Values local(mesh.n_vertices(), 1.0);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (mesh.is_boundary_vertex(v)) local[v] = 0;
  }
  const std::vector<Values> results = {diffused(laplacian, f, {.width = 1, .local = local}),
                                       relaxed(laplacian, f, {.steps = 20, .local = local}),
                                       convolved(mesh, laplacian, f, {.radius = 2, .local = local})};
  for (const Values& g : results) {
    EXPECT_NEAR(volume_under(laplacian, g), volume_under(laplacian, f), 1e-11 * volume_under(laplacian, f));
    for (Index v = 0; v < mesh.n_vertices(); ++v) EXPECT_EQ(g[v] == 0, mesh.is_boundary_vertex(v)) << v;
    EXPECT_GT(largest_difference(f, g), 0.05);
  }
}

/// Cosines are the natural modes of a square: one implicit step divides each by 1 + h c k².
TEST(SmoothField, ModesOfASquareDecayAsTheyShould) {
  const TriangleMesh mesh = planar_grid(60, 60, 1, 1, {.jitter = 0.2, .seed = 5});
  const SurfaceLaplacian laplacian = surface_laplacian(mesh);
  for (const auto& [m, n] : {std::pair{1, 0}, std::pair{1, 2}, std::pair{3, 1}}) {
    const Values f = sampled(mesh, [&](const Vec3& p) { return std::cos(m * pi * p.x()) * std::cos(n * pi * p.y()); });
    const double width = 0.2;
    const double k2 = pi * pi * (m * m + n * n);
    Values expected = f;
    for (double& value : expected) value /= 1 + 0.5 * width * width * k2;
    const Values g = diffused(laplacian, f, {.width = width, .steps = 1, .conserve_volume = false});
    EXPECT_LT(largest_difference(g, expected), 0.004) << m << n;
  }
}

/// Spherical harmonics of degree l decay with l (l + 1) / R².
TEST(SmoothField, HarmonicsOfASphereDecayAsTheyShould) {
  const double radius = 2;
  const TriangleMesh mesh = icosphere(4, radius);
  const SurfaceLaplacian laplacian = surface_laplacian(mesh);
  const auto check = [&](int degree, const std::function<double(const Vec3&)>& harmonic) {
    const Values f = sampled(mesh, harmonic);
    Values expected = f;
    const double width = 1;
    const int steps = 3;
    const double divisor = 1 + 0.5 * width * width / steps * degree * (degree + 1) / (radius * radius);
    for (double& value : expected) value /= std::pow(divisor, steps);
    const Values g = diffused(laplacian, f, {.width = width, .steps = steps, .conserve_volume = false});
    EXPECT_LT(largest_difference(g, expected), 0.003 * *std::max_element(f.begin(), f.end())) << degree;
  };
  check(1, [](const Vec3& p) { return p.z(); });
  check(2, [](const Vec3& p) { return p.x() * p.y(); });
  check(3, [](const Vec3& p) { return p.x() * (p.x() * p.x() - 3 * p.y() * p.y()); });
}

/// What the width means: the mean square distance of a spread peak is 2 width², whatever the triangles and the steps.
TEST(SmoothField, TheWidthIsTheStandardDeviationOfASpreadPeak) {
  const TriangleMesh mesh = planar_grid(60, 60, 60, 60, {.jitter = 0.24, .seed = 9});
  const SurfaceLaplacian laplacian = surface_laplacian(mesh);
  Values f(mesh.n_vertices(), 0.0);
  const Index peak = 30 * 61 + 30;
  f[peak] = 1;
  const auto mean_square = [&](const Values& g) {
    double sum = 0;
    for (Index v = 0; v < mesh.n_vertices(); ++v)
      sum += laplacian.area[v] * g[v] * (mesh.position(v) - mesh.position(peak)).squaredNorm();
    return sum / volume_under(laplacian, g);
  };
  for (const int steps : {1, 4}) {
    EXPECT_NEAR(mean_square(diffused(laplacian, f, {.width = 1.5, .steps = steps})), 2 * 1.5 * 1.5, 1e-5);
  }
  EXPECT_NEAR(mean_square(diffused(laplacian, f, {.scheme = DiffusionScheme::forward, .width = 1.5, .steps = 60})),
              2 * 1.5 * 1.5, 1e-5);
  // of the convolution, b / sqrt(8) by an integral that a sum over a disc of some 80 vertices stands for
  const double b = 1.5 * std::sqrt(8.0);
  EXPECT_NEAR(mean_square(convolved(mesh, laplacian, f, {.radius = b})), 2 * 1.5 * 1.5, 0.05 * 2 * 1.5 * 1.5);
}

TEST(SmoothField, NoValueLeavesTheRangeOfThoseBefore) {
  Rng rng(11);
  for (const TriangleMesh& mesh : hard_meshes()) {
    const SurfaceLaplacian laplacian = surface_laplacian(mesh);
    Values f = random_values(rng, mesh.n_vertices());
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      if (mesh.outgoing(v) == no_index) f[v] = 0.5;  // nothing flows there
    }
    const auto [low, high] = std::minmax_element(f.begin(), f.end());
    const auto expect_within = [&](const Values& g) {
      for (const double value : g) {
        EXPECT_GE(value, *low - 1e-9);
        EXPECT_LE(value, *high + 1e-9);
      }
    };
    for (const double width : {1e-3, 0.1, 10.0}) {
      expect_within(diffused(laplacian, f, {.width = width * mesh.size(), .conserve_volume = false}));
    }
    expect_within(relaxed(laplacian, f, {.share = 1, .conserve_volume = false}));
  }
}

TEST(SmoothField, DoesNotDependOnPlaceScaleAndMotion) {
  const TriangleMesh mesh = wavy_sheet(15, 10, 1, 0.7, 0.9, 4);
  Rng rng(2);
  const Values f = random_values(rng, mesh.n_vertices());
  const Values local = random_values(rng, mesh.n_vertices());
  const auto results = [&](const TriangleMesh& m, double scale) {
    const SurfaceLaplacian laplacian = surface_laplacian(m);
    return std::vector<Values>{diffused(laplacian, f, {.width = scale, .local = local}),
                               relaxed(laplacian, f, {.local = local}),
                               convolved(m, laplacian, f, {.radius = 2 * scale, .local = local})};
  };
  const std::vector<Values> here = results(mesh, 1);
  const std::vector<Values> there = results(moved(mesh, Vec3(1, 2, 3), 0.8, Vec3(20, -5, 7)), 1);
  const std::vector<Values> larger = results(scaled(mesh, 1000), 1000);
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_LT(largest_difference(here[i], there[i]), 1e-9);
    EXPECT_LT(largest_difference(here[i], larger[i]), 1e-9);
  }
}

/// Both are of first order: their difference halves with the step.
TEST(SmoothField, ExplicitAndImplicitStepsMeet) {
  const TriangleMesh mesh = wavy_sheet(12, 12, 0.5, 0.7, 0.9, 4);
  const SurfaceLaplacian laplacian = surface_laplacian(mesh);
  const Values f = sampled(mesh, [](const Vec3& p) { return 3 + std::sin(p.x()) * std::cos(p.y()); });
  Rng rng(8);
  const Values local = random_values(rng, mesh.n_vertices());
  const auto difference = [&](int steps) {
    const auto result = [&](DiffusionScheme scheme) {
      return diffused(laplacian, f, {.scheme = scheme, .width = 1, .steps = steps, .local = local});
    };
    return largest_difference(result(DiffusionScheme::forward), result(DiffusionScheme::backward));
  };
  const double coarse = difference(100);
  EXPECT_LT(coarse, 0.01);
  EXPECT_NEAR(difference(200) / coarse, 0.5, 0.05);
}

TEST(SmoothField, ConvolutionLeavesALinearFunctionAwayFromTheBoundary) {
  const double radius = 3.2;
  const auto error = [&](const TriangleMesh& mesh) {
    const Values f = sampled(mesh, [](const Vec3& p) { return 100 + 2 * p.x() - p.y(); });
    const Values g = convolved(mesh, surface_laplacian(mesh), f, {.radius = radius, .conserve_volume = false});
    double largest = 0;
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      const Vec3& p = mesh.position(v);
      if (std::min({p.x(), p.y(), 20 - p.x(), 20 - p.y()}) > radius) largest = std::max(largest, std::abs(g[v] - f[v]));
    }
    return largest;
  };
  EXPECT_LT(error(planar_grid(20, 20, 20, 20)), 1e-12);
  // sums over irregular vertices stand for integrals
  EXPECT_LT(error(planar_grid(20, 20, 20, 20, {.jitter = 0.2})), 0.03 * radius * std::sqrt(5.0));
}

/// On a surface without saddles straight ways are all there are: distances are exact.
TEST(SmoothField, ConvolutionMeasuresGeodesicDistances) {
  const TriangleMesh mesh = icosphere(2, 1);
  const SurfaceLaplacian laplacian = surface_laplacian(mesh);
  Rng rng(3);
  const Values f = random_values(rng, mesh.n_vertices());
  const double radius = 0.9;
  Values expected;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    SourceSet source;
    source.add_vertex(mesh, v);
    const Values distance = exact_distances(mesh, source);
    double sum = 0;
    double weights = 0;
    for (Index other = 0; other < mesh.n_vertices(); ++other) {
      if (!(distance[other] < radius)) continue;
      const double t = 1 - std::pow(distance[other] / radius, 2);
      sum += laplacian.area[other] * t * t * f[other];
      weights += laplacian.area[other] * t * t;
    }
    expected.push_back(sum / weights);
  }
  EXPECT_LT(largest_difference(convolved(mesh, laplacian, f, {.radius = radius, .conserve_volume = false}), expected),
            1e-9);
}

TEST(SmoothField, NothingFlowsWhereNothingIsReached) {
  const TriangleMesh mesh = planar_grid(20, 4, 20, 4);
  const SurfaceLaplacian laplacian = surface_laplacian(mesh);
  const Values f = sampled(mesh, [](const Vec3& p) { return p.x() > 12 ? infinity : p.x() < 5 ? 1.0 : 2.0; });
  for (const Values& g : {diffused(laplacian, f, {.width = 2}), relaxed(laplacian, f, {}),
                          convolved(mesh, laplacian, f, {.radius = 2.5})}) {
    for (std::size_t v = 0; v < f.size(); ++v) {
      EXPECT_EQ(g[v] == infinity, f[v] == infinity);
      if (f[v] < infinity) {
        EXPECT_LE(g[v], 2.001);
      }
    }
    EXPECT_NEAR(volume_under(laplacian, g), volume_under(laplacian, f), 1e-10);
  }
}

TEST(SmoothField, RefusesWhatItCannotDo) {
  const TriangleMesh mesh = planar_grid(10, 10, 10, 10);
  const SurfaceLaplacian laplacian = surface_laplacian(mesh);
  const Values f(mesh.n_vertices(), 1.0);
  EXPECT_THROW(diffused(laplacian, f, {}), Error);
  EXPECT_THROW(diffused(laplacian, f, {.width = 1, .steps = 0}), Error);
  EXPECT_THROW(diffused(laplacian, Values(3, 1.0), {.width = 1}), Error);
  EXPECT_THROW(diffused(laplacian, Values(f.size(), -1.0), {.width = 1}), Error);
  EXPECT_NO_THROW(diffused(laplacian, Values(f.size(), -1.0), {.width = 1, .conserve_volume = false}));
  EXPECT_THROW(diffused(laplacian, f, {.width = 1, .local = Values(f.size(), 2.0)}), Error);
  EXPECT_THROW(relaxed(laplacian, f, {.share = 1.5}), Error);
  EXPECT_THROW(convolved(mesh, laplacian, f, {.radius = 0}), Error);
  try {
    diffused(laplacian, f, {.scheme = DiffusionScheme::forward, .width = 2, .steps = 1});
    FAIL() << "unit squares allow c h = 1/4";
  } catch (const Error& error) {
    EXPECT_NE(error.where().value.find("at least 8"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace isopath::test
