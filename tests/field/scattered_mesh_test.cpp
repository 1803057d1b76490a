// Fields on meshes whose vertices and faces lie in memory in random order, so that a propagation numbers them anew:
// nothing of that is to be seen outside.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "isopath/field/exact_distances.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/virtual_source.h"
#include "isopath/mesh/local_numbering.h"
#include "support/hard_meshes.h"
#include "support/random_sources.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

/// A mesh in order, and the same in none; sources of every kind on both.
struct Pair {
  Pair(Rng& rng, TriangleMesh in_order) : mesh(std::move(in_order)), other(renumbered(rng, mesh)) {
    EXPECT_TRUE(LocalNumbering(mesh).is_that_of_mesh());
    EXPECT_FALSE(LocalNumbering(other.mesh).is_that_of_mesh());
  }

  SurfacePoint moved(SurfacePoint point) const {
    point.face = other.face[point.face];
    return point;
  }
  void add_vertex(Index vertex) {
    sources.add_vertex(mesh, vertex);
    other_sources.add_vertex(other.mesh, other.vertex[vertex]);
  }
  void add_point(const SurfacePoint& point) {
    sources.add_point(point);
    other_sources.add_point(moved(point));
  }
  void add_polyline(std::vector<SurfacePoint> points) {
    sources.add_polyline(mesh, points, false);
    for (SurfacePoint& point : points) point = moved(point);
    other_sources.add_polyline(other.mesh, points, false);
  }
  void add_halfedges(std::vector<Index> halfedges, bool closed) {
    sources.add_halfedges(mesh, halfedges, closed);
    for (Index& h : halfedges) h = 3 * other.face[h / 3] + h % 3;
    other_sources.add_halfedges(other.mesh, halfedges, closed);
  }

  TriangleMesh mesh;
  Renumbered other;
  SourceSet sources;
  SourceSet other_sources;
};

void expect_same(const Pair& pair, const ExactField& field, const ExactField& other, Rng& rng) {
  const double tolerance = 1e-12 * pair.mesh.size();
  other.verify();
  const auto same = [&](double a, double b) { return a == b || std::abs(a - b) <= tolerance; };
  int other_roots = 0;
  for (Index v = 0; v < pair.mesh.n_vertices(); ++v) {
    ASSERT_TRUE(same(field.value_at_vertex(v), other.value_at_vertex(pair.other.vertex[v]))) << "vertex " << v;
    const Index root = field.nearest(point_at_vertex(pair.mesh, v)).root;
    const Index there = other.nearest(point_at_vertex(pair.other.mesh, pair.other.vertex[v])).root;
    other_roots += root == there ? 0 : 1;
  }
  EXPECT_LT(other_roots, pair.mesh.n_vertices() / 20);  // ties, as below
  other_roots = 0;
  constexpr int n = 2000;
  for (int k = 0; k < n; ++k) {
    const SurfacePoint p = random_surface_point(rng, pair.mesh);
    const ExactField::Nearest nearest = field.nearest(p);
    const ExactField::Nearest there = other.nearest(pair.moved(p));
    ASSERT_TRUE(same(nearest.distance, there.distance)) << "face " << p.face;
    other_roots += nearest.root == there.root ? 0 : 1;
  }
  EXPECT_LT(other_roots, n / 20);  // ties: where a path begins at a vertex, it and its first segment are as near
}

/// The share of faces of which it is known that the distance has no ridge in them.
double share_of_monotone(const ExactField& field) {
  int count = 0;
  for (Index f = 0; f < field.mesh().n_faces(); ++f) count += field.monotone_in_face(f) ? 1 : 0;
  return static_cast<double>(count) / field.mesh().n_faces();
}

TEST(ScatteredMesh, HasTheSameFieldFromSourcesOfEveryKind) {
  Rng rng(1);
  Pair pair(rng, wavy_sheet(120, 100, 10, 0.06, 0.05, 1));
  pair.add_vertex(pair.mesh.from(random_index(rng, pair.mesh.n_halfedges())));
  for (int i = 0; i < 5; ++i) pair.add_point(random_surface_point(rng, pair.mesh));
  for (int i = 0; i < 5; ++i) pair.add_polyline(random_polyline(rng, pair.mesh, 30));
  pair.add_halfedges({0, 1}, false);
  const ExactField field = ExactField::compute(pair.mesh, pair.sources);
  const ExactField other = ExactField::compute(pair.other.mesh, pair.other_sources);
  expect_same(pair, field, other, rng);
  EXPECT_NEAR(share_of_monotone(field), share_of_monotone(other), 1e-3);
  EXPECT_GT(share_of_monotone(field), 0.5);
  const std::vector<double> alone = exact_distances(pair.other.mesh, pair.other_sources);
  for (Index v = 0; v < pair.mesh.n_vertices(); ++v)
    ASSERT_NEAR(alone[v], other.value_at_vertex(v), 1e-12 * pair.mesh.size());
}

TEST(ScatteredMesh, HasTheSameFieldFromItsBoundaryAndUpToAStop) {
  Rng rng(2);
  Pair pair(rng, wavy_sheet(120, 100, 10, 0.06, 0.05, 2));
  pair.add_halfedges(pair.mesh.boundary_loops()[0], true);
  for (const double stop : {infinity, 20.0}) {
    const ExactFieldOptions options{.stop_distance = stop};
    const ExactField field = ExactField::compute(pair.mesh, pair.sources, options);
    const ExactField other = ExactField::compute(pair.other.mesh, pair.other_sources, options);
    for (Index v = 0; v < pair.mesh.n_vertices(); ++v) {
      const double expected = field.value_at_vertex(v);
      if (expected > stop) continue;
      ASSERT_NEAR(other.value_at_vertex(pair.other.vertex[v]), expected, 1e-12 * pair.mesh.size());
    }
    if (stop == infinity) expect_same(pair, field, other, rng);
  }
}

/// Virtual sources take what comes first of what is nearly as near: so their errors depend on the order a little.
TEST(ScatteredMesh, HasNearlyTheSameDistancesByVirtualSources) {
  Rng rng(5);
  Pair pair(rng, wavy_sheet(120, 100, 10, 0.06, 0.05, 5));
  pair.add_vertex(pair.mesh.from(random_index(rng, pair.mesh.n_halfedges())));
  pair.add_point(random_surface_point(rng, pair.mesh));
  pair.add_polyline(random_polyline(rng, pair.mesh, 30));
  pair.add_halfedges({0, 1}, false);
  const std::vector<double> expected = virtual_source_distances(pair.mesh, pair.sources);
  const std::vector<double> found = virtual_source_distances(pair.other.mesh, pair.other_sources);
  double sum = 0;
  for (Index v = 0; v < pair.mesh.n_vertices(); ++v) {
    const double off = std::abs(found[pair.other.vertex[v]] - expected[v]);
    ASSERT_LT(off, 1e-3 * pair.mesh.size()) << "vertex " << v;
    sum += off;
  }
  EXPECT_LT(sum / pair.mesh.n_vertices(), 1e-6 * pair.mesh.size());
}

TEST(ScatteredMesh, KeepsTheBoundThatWasAskedFor) {
  Rng rng(3);
  Pair pair(rng, wavy_sheet(120, 100, 10, 0.06, 0.05, 3));
  pair.add_halfedges(pair.mesh.boundary_loops()[0], true);
  const ExactField exact = ExactField::compute(pair.mesh, pair.sources);
  const double accuracy = 1e-4 * pair.mesh.size();
  const ExactField other = ExactField::compute(pair.other.mesh, pair.other_sources, {.accuracy = accuracy});
  EXPECT_LT(other.windows_kept(), exact.windows_kept() / 4);
  for (Index v = 0; v < pair.mesh.n_vertices(); ++v)
    ASSERT_NEAR(other.value_at_vertex(pair.other.vertex[v]), exact.value_at_vertex(v), accuracy);
}

TEST(ScatteredMesh, MayHaveHardPartsAndUnusedVertices) {
  Rng rng(4);
  TriangleSoup all;
  std::vector<Index> first_vertex_of_parts;
  while (all.triangles.size() < 30000) {
    const TriangleMesh part = hard_mesh(rng, {.least_height = 1e-8, .least_distance = 1e-6}).mesh;
    const auto first = static_cast<Index>(all.positions.size());
    first_vertex_of_parts.push_back(first + part.from(0));
    for (const Vec3& p : part.soup().positions) all.positions.emplace_back(p / part.size());
    for (Triangle triangle : part.soup().triangles) {
      for (Index& v : triangle) v += first;
      all.triangles.push_back(triangle);
    }
    all.positions.emplace_back(Vec3::Zero());
  }
  Pair pair(rng, TriangleMesh(std::move(all)));
  for (const Index vertex : first_vertex_of_parts) pair.add_vertex(vertex);
  const ExactField field = ExactField::compute(pair.mesh, pair.sources);
  const ExactField other = ExactField::compute(pair.other.mesh, pair.other_sources);
  for (Index v = 0; v < pair.mesh.n_vertices(); ++v) {
    const double expected = field.value_at_vertex(v);
    const double found = other.value_at_vertex(pair.other.vertex[v]);
    ASSERT_TRUE(found == expected || std::abs(found - expected) <= 1e-9 * expected + 1e-10) << "vertex " << v;
  }
}

}  // namespace
}  // namespace isopath::test
