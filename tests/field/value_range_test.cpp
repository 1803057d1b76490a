#include "isopath/field/value_range.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/vertex_field.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

/// Distance from the line 0.6 x + 0.8 y = `line` in the plane z = 0. Counts how often it is asked.
class LineDistance final : public SurfaceFunction {
 public:
  LineDistance(const TriangleMesh& mesh, double line) : mesh_(mesh), line_(line) {}
  double value_at_vertex(Index v) const override { return along(mesh_.position(v)); }
  double value(const SurfacePoint& p) const override {
    ++asked;
    return along(position_of(mesh_, p));
  }
  Slope slope(const SurfacePoint&) const override { return {}; }
  void edge_crossings(Index, double, std::vector<double>&) const override {}
  bool linear_in_faces() const override { return false; }
  bool monotone_in_face(Index) const override { return false; }
  double max_slope() const override { return 1; }
  double lower_bound() const override { return 0; }

  mutable int asked = 0;

 private:
  double along(const Vec3& p) const { return std::abs(0.6 * p.x() + 0.8 * p.y() - line_); }

  const TriangleMesh& mesh_;
  double line_;
};

TEST(ValueRange, FindsTheTopInsideAFace) {
  // The middle of an equilateral triangle is farthest from its boundary: a third of the height.
  const TriangleMesh mesh(TriangleSoup{{{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}}, {{0, 1, 2}}});
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  for (const double tolerance : {1e-2, 1e-4}) {
    const ValueRange range = value_range(mesh, field, tolerance);
    EXPECT_EQ(range.low, 0);
    EXPECT_LE(range.high, std::sqrt(0.75) / 3 + 1e-12);
    EXPECT_GE(range.high, std::sqrt(0.75) / 3 - tolerance);
  }
}

TEST(ValueRange, DoesNotSearchBelowTheLowerBound) {
  const TriangleMesh mesh = planar_grid(10, 10, 10, 10);
  const LineDistance function(mesh, 6.3);
  const ValueRange range = value_range(mesh, function, 1e-4);
  EXPECT_NEAR(range.low, 0, 1e-4);
  EXPECT_NEAR(range.high, 7.7, 1e-4);
  // Without the bound every part that the line crosses is divided down to the tolerance: 10 / 1e-4 of them.
  EXPECT_LT(function.asked, 20 * mesh.n_faces());
}

TEST(ValueRange, TakesTheVerticesOfALinearFunctionAndLeavesOutTheUnreached) {
  const TriangleMesh mesh = planar_grid(1, 1, 1, 1);
  const ValueRange range = value_range(mesh, VertexField(mesh, {3, infinity, -1, 2}), 0);
  EXPECT_EQ(range.low, -1);
  EXPECT_EQ(range.high, 3);
  EXPECT_TRUE(value_range(mesh, VertexField(mesh, std::vector<double>(4, infinity)), 0).empty());
}

TEST(ValueRange, NoPointOfAnExcludedFaceComesUpToTheLevel) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rng rng(seed);
    const TriangleMesh mesh = random_mesh(rng);
    SourceSet sources;
    sources.add_point(random_surface_point(rng, mesh));
    const ExactField field = ExactField::compute(mesh, sources);
    const double level = random_real(rng, 0, 1) * field.max_vertex_distance();
    const std::vector<char> may = faces_that_may_reach(mesh, field, level);
    for (int k = 0; k < 300; ++k) {
      const SurfacePoint point = random_surface_point(rng, mesh);
      const double value = field.value(point);
      EXPECT_TRUE(may[point.face] || value < level || value == infinity) << "seed " << seed << ": " << value;
    }
    const std::vector<char> beyond = faces_that_may_reach(mesh, field, 4 * mesh.size() + field.max_vertex_distance());
    EXPECT_EQ(std::count(beyond.begin(), beyond.end(), 1), 0) << "seed " << seed;
  }
}

TEST(ValueRange, StopsOnRequest) {
  class Stop final : public Progress {
    bool cancelled() const override { return true; }
  };
  const TriangleMesh mesh = planar_grid(10, 10, 10, 10);
  EXPECT_THROW(value_range(mesh, LineDistance(mesh, 4.3), 1e-4, Stop{}), Error);
  EXPECT_THROW(faces_that_may_reach(mesh, LineDistance(mesh, 4.3), 1, Stop{}), Error);
}

}  // namespace
}  // namespace isopath::test
