#include "isopath/field/window_merge.h"

#include <gtest/gtest.h>

#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "support/random_sources.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

Window point_window(double begin, double end, const Vec2& source, double offset) {
  Window w;
  w.begin = begin;
  w.end = end;
  w.source = source;
  w.offset = offset;
  return w;
}

Window line_window(double begin, double end, double angle, double offset) {
  Window w = point_window(begin, end, Vec2(std::cos(angle), -std::sin(angle)), offset);
  w.kind = Window::Kind::line;
  return w;
}

/// Two windows side by side with one distance where they touch; rays fan out, meet, or have little to do with each
/// other.
std::vector<Window> random_pair(Rng& rng) {
  const double middle = random_real(rng, 0.3, 0.7);
  std::vector<Window> pair;
  for (int i = 0; i < 2; ++i) {
    const double begin = i == 0 ? 0 : middle;
    const double end = i == 0 ? middle : 1;
    pair.push_back(random_index(rng, 3) == 0
                       ? line_window(begin, end, random_real(rng, 0.3, 2.8), 0)
                       : point_window(begin, end, Vec2(random_real(rng, -2, 3), random_real(rng, 0.1, 5)), 0));
  }
  if (random_index(rng, 2) == 0) {  // nearly one front
    const Vec2 turn(random_real(rng, -1e-3, 1e-3), random_real(rng, -1e-3, 1e-3));
    pair[1] = pair[0];
    pair[1].begin = middle;
    pair[1].end = 1;
    pair[1].source += turn;
    if (pair[1].kind == Window::Kind::line) pair[1].source.normalize();
  }
  pair[0].offset += random_real(rng, 0, 10);
  pair[1].offset += pair[0].distance(middle) - pair[1].distance(middle);
  if (random_index(rng, 2) == 0) {
    for (Window& w : pair) w.source.y() = -w.source.y();  // from the other face
  }
  return pair;
}

TEST(MergeWindows, KeepsTheEndsTheBeamAndTheBound) {
  int merged_pairs = 0;
  for (std::uint64_t seed = 0; seed < 5000; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const std::vector<Window> pair = random_pair(rng);
    const MergeLimits limits{.accuracy = 0.05, .size = 10, .reach = 1e-9};
    Window merged;
    if (!merge_windows(pair[0], pair[1], limits, merged)) continue;
    ++merged_pairs;
    EXPECT_EQ(merged.begin, 0);
    EXPECT_EQ(merged.end, 1);
    EXPECT_EQ(merged.source_side(), pair[0].source_side());
    EXPECT_NEAR(merged.distance(0), pair[0].distance(0), 1e-11);
    EXPECT_NEAR(merged.distance(1), pair[1].distance(1), 1e-11);
    EXPECT_LE(merged.direction(0).x(), pair[0].direction(0).x() + 1e-12);
    EXPECT_GE(merged.direction(1).x(), pair[1].direction(1).x() - 1e-12);
    const double middle = pair[0].end;
    double change = std::abs(merged.distance(middle) - pair[0].distance(middle));
    for (int k = 0; k <= 200; ++k) {
      const double x = k / 200.0;
      const Window& old = x <= pair[0].end ? pair[0] : pair[1];
      change = std::max(change, std::abs(merged.distance(x) - old.distance(x)));
    }
    EXPECT_LE(change, merged.error + 1e-12);
    EXPECT_LE(merged.error, 1.05 * change + 1e-9);  // not needlessly careful
    EXPECT_LE(merged.error, limits.accuracy);
  }
  EXPECT_GT(merged_pairs, 1000);
}

TEST(MergeWindows, ErrorsAddUp) {
  const MergeLimits limits{.accuracy = 1, .size = 10, .reach = 1};
  Window left = line_window(0, 1, 1.5, 5);
  Window right = line_window(1, 2, 1.6, left.distance(1) - std::cos(1.6));
  Window fresh;
  ASSERT_TRUE(merge_windows(left, right, limits, fresh));
  left.error = 0.25;
  right.error = 0.5;
  Window merged;
  ASSERT_TRUE(merge_windows(left, right, limits, merged));
  EXPECT_NEAR(merged.error, fresh.error + 0.5, 1e-12);
  right.error = 1 - 0.5 * fresh.error;
  EXPECT_FALSE(merge_windows(left, right, limits, merged));
}

TEST(MergeWindows, JoinsOneFrontAtNoCost) {
  const MergeLimits exact{.size = 10};
  Window left = point_window(0, 0.4, Vec2(0.5, 2), 3);
  Window right = point_window(0.4, 1, Vec2(0.5, 2 + 1e-14), 3);
  Window merged;
  ASSERT_TRUE(merge_windows(left, right, exact, merged));
  EXPECT_EQ(merged.error, 0);
  EXPECT_NEAR(merged.distance(0.1), left.distance(0.1), 1e-13);
  right.root = 4;
  EXPECT_FALSE(merge_windows(left, right, exact, merged));
  right = point_window(0.4, 1, Vec2(0.5, 2 + 1e-9), 3);
  EXPECT_FALSE(merge_windows(left, right, exact, merged));
}

/// Values and vertex distances are within the accuracy of the exact ones, and never of fewer points.
void expect_accurate(const TriangleMesh& mesh, const SourceSet& sources, double accuracy, Rng& rng, int points) {
  const ExactField exact = ExactField::compute(mesh, sources);
  const ExactField field = ExactField::compute(mesh, sources, {.accuracy = accuracy});
  const double tolerance = accuracy + 1e-10 * mesh.size();
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (exact.value_at_vertex(v) == infinity) {
      EXPECT_EQ(field.value_at_vertex(v), infinity) << v;
    } else {
      EXPECT_NEAR(field.value_at_vertex(v), exact.value_at_vertex(v), tolerance) << v;
    }
  }
  for (int k = 0; k < points; ++k) {
    const SurfacePoint point = random_supported_point(rng, mesh);
    if (exact.value(point) < infinity) {
      EXPECT_NEAR(field.value(point), exact.value(point), tolerance) << k;
    }
  }
}

TEST(FieldAccuracy, HoldsOnRandomMeshes) {
  for (std::uint64_t seed = 0; seed < 1500 && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const TriangleMesh mesh =
        random_mesh(rng, {.max_faces = 80, .closed = seed % 3 == 0, .holes = seed % 5 == 0, .slivers = seed % 4 == 0});
    const double accuracy = std::pow(10.0, random_real(rng, -9, -2)) * mesh.size();
    expect_accurate(mesh, random_sources(rng, mesh), accuracy, rng, 40);
  }
}

TEST(FieldAccuracy, HoldsOnCurvedSheets) {
  Rng rng(1);
  const TriangleMesh wavy = wavy_sheet(30, 100, 10, 0.06, 0.05, 1);
  const TriangleMesh ball = hemisphere(20, 40, 50);
  for (const double accuracy : {1e-8, 1e-6, 1e-4}) {
    for (const TriangleMesh& mesh : {wavy, ball}) {
      SourceSet vertex;
      vertex.add_vertex(mesh, mesh.n_vertices() / 2);
      expect_accurate(mesh, vertex, accuracy * mesh.size(), rng, 1000);
      expect_accurate(mesh, boundary_source(mesh), accuracy * mesh.size(), rng, 1000);
    }
  }
}

TEST(FieldAccuracy, SavesWindows) {
  const TriangleMesh wavy = wavy_sheet(40, 100, 10, 0.06, 0.05, 1);
  const SourceSet boundary = boundary_source(wavy);
  std::size_t kept = ExactField::compute(wavy, boundary).windows_kept();
  for (const double accuracy : {1e-7, 1e-5}) {
    const std::size_t fewer = ExactField::compute(wavy, boundary, {.accuracy = accuracy * wavy.size()}).windows_kept();
    EXPECT_LT(fewer, kept);
    kept = fewer;
  }
  EXPECT_LT(kept, 4 * static_cast<std::size_t>(wavy.n_edges()));
}

TEST(FieldAccuracy, PlanesNeedOneWindowASide) {
  // A front that crosses flat vertices stays whole; an edge has windows from both its faces and along it at most.
  const TriangleMesh plane = planar_grid(40, 40, 1, 1, {.jitter = 0.2});
  SourceSet sources;
  sources.add_vertex(plane, 20 * 41 + 20);
  EXPECT_LT(ExactField::compute(plane, sources).windows_kept(), 3 * static_cast<std::size_t>(plane.n_edges()));
}

TEST(FieldAccuracy, FacesAwayFromTheRidgeAreMonotone) {
  // From the boundary, fronts pass most faces in about one direction: pseudo-sources at corners must not hide that.
  const TriangleMesh wavy = wavy_sheet(60, 100, 10, 0.06, 0.05, 1);
  for (const double accuracy : {0.0, 1e-6}) {
    const ExactField field = ExactField::compute(wavy, boundary_source(wavy), {.accuracy = accuracy * wavy.size()});
    Index monotone = 0;
    for (Index face = 0; face < wavy.n_faces(); ++face) monotone += field.monotone_in_face(face) ? 1 : 0;
    EXPECT_GT(monotone, wavy.n_faces() * 9 / 10);
  }
}

TEST(FieldAccuracy, MustBeALength) {
  const TriangleMesh mesh = planar_grid(2, 2, 1, 1);
  EXPECT_EQ(ExactFieldOptions{}.accuracy, 0);
  for (const double accuracy : {-1e-9, infinity, std::nan("")}) {
    EXPECT_THROW(ExactField::compute(mesh, boundary_source(mesh), {.accuracy = accuracy}), Error) << accuracy;
  }
}

}  // namespace
}  // namespace isopath::test
