// Exact fields in a metric that is given by edge lengths.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/intrinsic_geometry.h"
#include "support/random_sources.h"
#include "support/slow_exact.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

std::vector<double> lengths_of(const TriangleMesh& mesh, double factor = 1) {
  std::vector<double> lengths(mesh.edge_lengths().begin(), mesh.edge_lengths().end());
  for (double& l : lengths) l *= factor;
  return lengths;
}

ExactField field_in(const TriangleMesh& mesh, const std::vector<double>& lengths, const SourceSet& sources) {
  return ExactField::compute(mesh, IntrinsicGeometry(mesh, lengths), sources);
}

TriangleMesh stretched(const TriangleMesh& mesh, const Eigen::Matrix3d& map) {
  TriangleSoup soup = mesh.soup();
  for (Vec3& p : soup.positions) p = map * p;
  return TriangleMesh(std::move(soup));
}

std::string what_of(const TriangleMesh& mesh, const std::vector<double>& lengths) {
  try {
    IntrinsicGeometry(mesh, lengths);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(IntrinsicGeometry, LaysOutTheSameTrianglesFromLengthsAsFromPositions) {
  for (const TriangleMesh& mesh : {wavy_sheet(6, 10, 1, 1, 1, 3), icosphere(1, 2), lofted_blade(10, 3)}) {
    const IntrinsicGeometry space(mesh);
    const IntrinsicGeometry metric(mesh, mesh.edge_lengths());
    EXPECT_EQ(space.max_stretch(), 1);
    EXPECT_NEAR(metric.max_stretch(), 1, 1e-9);
    EXPECT_NEAR(metric.size(), mesh.size(), 1e-9 * mesh.size());
    for (Index h = 0; h < mesh.n_halfedges(); ++h) {
      EXPECT_EQ(metric.length(h), space.length(h));
      EXPECT_NEAR((metric.apex(h) - space.apex(h)).norm(), 0, 1e-9 * mesh.size()) << h;
      EXPECT_NEAR(metric.face_area(h / 3), mesh.face_area(h / 3), 1e-9 * mesh.area());
    }
  }
}

TEST(IntrinsicGeometry, StretchIsTheLargestSingularValueOfTheWarp) {
  // x times 3 and y times 0.5, in a plane that is turned by any angle against the edges
  for (int k = 0; k < 8; ++k) {
    const double angle = 0.4 * k;
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    turn.topLeftCorner<2, 2>() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    const TriangleMesh mesh = stretched(planar_grid(3, 3, 1, 1, {.jitter = 0.2}), turn);
    const TriangleMesh warped = stretched(mesh, Vec3(3, 0.5, 1).asDiagonal());
    EXPECT_NEAR(IntrinsicGeometry(mesh, warped.edge_lengths()).max_stretch(), 3, 1e-11);
  }
}

TEST(IntrinsicGeometry, RefusesLengthsThatNoTriangleHas) {
  const TriangleMesh mesh = planar_grid(2, 2, 1, 1);
  std::vector<double> lengths = lengths_of(mesh);
  EXPECT_EQ(what_of(mesh, lengths), "");
  const Index bad = 5;
  const auto with = [&](double value) {
    std::vector<double> changed = lengths;
    changed[bad] = value;
    return changed;
  };
  for (const double value : {0.0, -1.0, infinity, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_NE(what_of(mesh, with(value)).find("edge 5"), std::string::npos) << value;
  }
  const Index h = mesh.halfedge_of(bad);
  const Index face = mesh.twin(h) == no_index ? h / 3 : std::min(h / 3, mesh.twin(h) / 3);
  EXPECT_NE(what_of(mesh, with(10)).find("face " + std::to_string(face)), std::string::npos) << what_of(mesh, with(10));
  lengths.pop_back();
  EXPECT_NE(what_of(mesh, lengths).find("one length for each edge"), std::string::npos);
}

TEST(IntrinsicGeometry, FlatTrianglesAreAllowed) {
  const TriangleMesh mesh = planar_grid(1, 1, 1, 1);
  std::vector<double> lengths(mesh.n_edges(), 1.0);
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    if (!mesh.is_boundary_edge(e)) lengths[e] = 2;
  }
  const IntrinsicGeometry flat(mesh, lengths);
  for (Index f = 0; f < mesh.n_faces(); ++f) EXPECT_EQ(flat.face_area(f), 0);
}

TEST(MetricField, LengthsInSpaceGiveTheFieldInSpace) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Rng rng(seed);
    const TriangleMesh mesh = random_mesh(rng, {.max_faces = 60, .closed = seed % 3 == 0, .holes = seed % 2 == 0});
    const SourceSet sources = random_sources(rng, mesh);
    const ExactField space = ExactField::compute(mesh, sources);
    const ExactField metric = field_in(mesh, lengths_of(mesh), sources);
    for (int i = 0; i < 20; ++i) {
      const SurfacePoint p = random_supported_point(rng, mesh);
      const double d = space.value(p);
      if (d == infinity) {
        EXPECT_EQ(metric.value(p), infinity);
        continue;
      }
      EXPECT_NEAR(metric.value(p), d, 1e-9 * mesh.size()) << "seed " << seed;
    }
  }
}

TEST(MetricField, ScaledLengthsScaleDistances) {
  const TriangleMesh mesh = wavy_sheet(8, 10, 1, 1, 1, 5);
  Rng rng(3);
  const SourceSet sources = random_sources(rng, mesh);
  const ExactField space = ExactField::compute(mesh, sources);
  for (const double factor : {0.1, 0.3, 7.0}) {
    const ExactField metric = field_in(mesh, lengths_of(mesh, factor), sources);
    EXPECT_NEAR(metric.max_slope(), factor, 1e-9 * factor);
    for (int i = 0; i < 100; ++i) {
      const SurfacePoint p = random_supported_point(rng, mesh);
      EXPECT_NEAR(metric.value(p), factor * space.value(p), 1e-10 * factor * mesh.size()) << factor;
    }
  }
}

TEST(MetricField, LengthsOfAStretchedSheetGiveItsField) {
  const TriangleMesh mesh = planar_grid(9, 7, 3, 2, {.jitter = 0.24, .seed = 8});
  Eigen::Matrix3d map = Eigen::Matrix3d::Identity();
  map.topLeftCorner<2, 2>() << 2.5, 0.7, -0.2, 0.6;
  const TriangleMesh warped = stretched(mesh, map);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Rng rng(seed);
    const SourceSet sources = random_sources(rng, mesh);
    const ExactField expected = ExactField::compute(warped, sources);
    const ExactField metric = field_in(mesh, lengths_of(warped), sources);
    for (int i = 0; i < 50; ++i) {
      const SurfacePoint p = random_supported_point(rng, mesh);
      const ExactField::Nearest nearest = metric.nearest(p);
      EXPECT_NEAR(nearest.distance, expected.value(p), 1e-9) << "seed " << seed;
      // The way towards the source, drawn on the unstretched sheet, is the stretched one's image.
      const Vec3 there = expected.nearest(p).towards_source;
      const Vec3 mapped = (map * nearest.towards_source).stableNormalized();
      if (nearest.distance < 1e-3) continue;
      EXPECT_NEAR((mapped - there).norm(), 0, 1e-6) << "seed " << seed;
    }
  }
}

TEST(MetricField, PathsHaveTheLengthThatTheFieldSays) {
  const TriangleMesh mesh = planar_grid(9, 7, 3, 2, {.jitter = 0.24, .seed = 8});
  const Eigen::Matrix3d map = Vec3(3, 0.4, 1).asDiagonal();
  Rng rng(4);
  const SourceSet sources = random_sources(rng, mesh);
  const ExactField metric = field_in(mesh, lengths_of(stretched(mesh, map)), sources);
  for (int i = 0; i < 100; ++i) {
    const SurfacePoint p = random_supported_point(rng, mesh);
    const std::vector<SurfacePoint> path = metric.shortest_path(p);
    double length = 0;
    for (std::size_t k = 1; k < path.size(); ++k) {
      length += (map * (position_of(mesh, path[k]) - position_of(mesh, path[k - 1]))).norm();
    }
    EXPECT_NEAR(length, metric.value(p), 1e-9);
  }
}

TEST(MetricField, AgreesWithExhaustiveUnfoldingInRandomMetrics) {
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    Rng rng(seed);
    const TriangleMesh mesh = random_mesh(rng, {.closed = seed % 3 == 0, .holes = seed % 5 == 0});
    // any three lengths from [1, 2) make a triangle; the whole need not fit into space
    std::vector<double> lengths;
    for (Index e = 0; e < mesh.n_edges(); ++e) lengths.push_back(random_real(rng, 1, 1.95));
    const SourceSet sources = random_sources(rng, mesh);
    const ExactField field = field_in(mesh, lengths, sources);
    const SlowExact judge(mesh, lengths, sources.elements());
    for (int i = 0; i < 20; ++i) {
      const SurfacePoint p = random_supported_point(rng, mesh);
      const double expected = judge.distance(p);
      if (expected == infinity) continue;
      EXPECT_NEAR(field.value(p), expected, 1e-9) << "seed " << seed;
    }
  }
}

TEST(MetricField, AccuracyIsKept) {
  const TriangleMesh mesh = icosphere(3, 10);
  std::vector<double> lengths = lengths_of(mesh);
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    const Index h = mesh.halfedge_of(e);
    lengths[e] *= 1 + 0.01 * (mesh.position(mesh.from(h)).z() + mesh.position(mesh.to(h)).z());
  }
  SourceSet sources;
  sources.add_point(point_at_vertex(mesh, 0));
  const ExactField exact = field_in(mesh, lengths, sources);
  for (const double accuracy : {1e-6, 1e-3}) {
    const ExactField field =
        ExactField::compute(mesh, IntrinsicGeometry(mesh, lengths), sources, ExactFieldOptions{.accuracy = accuracy});
    EXPECT_LT(field.windows_kept(), exact.windows_kept());
    for (Index v = 0; v < mesh.n_vertices(); ++v)
      EXPECT_NEAR(field.value_at_vertex(v), exact.value_at_vertex(v), accuracy);
  }
}

}  // namespace
}  // namespace isopath::test
