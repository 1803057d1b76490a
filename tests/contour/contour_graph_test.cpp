#include "isopath/contour/contour_graph.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "contour/functions.h"
#include "isopath/contour/bands.h"
#include "isopath/contour/level_cut.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/vertex_field.h"

namespace isopath {
namespace {

using test::PointDistance;
using test::random_values;
using test::square;

VertexField sampled(const TriangleMesh& mesh, const std::function<double(const Vec3&)>& f) {
  std::vector<double> values;
  for (Index v = 0; v < mesh.n_vertices(); ++v) values.push_back(f(mesh.position(v)));
  return {mesh, std::move(values)};
}

std::vector<double> steps(double first, double step, int n) {
  std::vector<double> levels;
  for (int i = 0; i < n; ++i) levels.push_back(first + step * i);
  return levels;
}

/// What every graph must satisfy, whatever the function.
void expect_consistent(const ContourSet& set) {
  const ContourGraph& g = set.graph;
  const std::size_t n = set.contours.size();
  ASSERT_EQ(g.children.size(), n);
  ASSERT_EQ(g.parents.size(), n);
  std::set<std::pair<Index, Index>> down;
  std::set<std::pair<Index, Index>> up;
  for (Index k = 0; k < static_cast<Index>(n); ++k) {
    for (const Index c : g.children[k]) ASSERT_TRUE(down.insert({k, c}).second);
    for (const Index p : g.parents[k]) ASSERT_TRUE(up.insert({p, k}).second);
  }
  EXPECT_EQ(down, up);
  std::vector<Index> rank(n, no_index);
  for (std::size_t i = 0; i < n; ++i) rank[g.order[i]] = static_cast<Index>(i);
  for (const auto& [parent, child] : down) {
    EXPECT_LT(rank[parent], rank[child]);
    EXPECT_LT(set.contours[parent].level, set.contours[child].level);
  }
  std::vector<int> seen(n, 0);
  for (std::size_t r = 0; r < g.runs.size(); ++r) {
    const auto& run = g.runs[r];
    for (std::size_t i = 0; i < run.contours.size(); ++i) {
      ++seen[run.contours[i]];
      EXPECT_EQ(set.contours[run.contours[i]].closed, run.closed);
      if (i == 0) continue;
      EXPECT_EQ(g.children[run.contours[i - 1]], std::vector<Index>{run.contours[i]});
      EXPECT_EQ(g.parents[run.contours[i]], std::vector<Index>{run.contours[i - 1]});
    }
    for (const Index child : run.children) {
      EXPECT_GT(child, static_cast<Index>(r)) << "topological order";
      EXPECT_TRUE(down.count({run.contours.back(), g.runs[child].contours.front()}));
    }
    if (run.children.size() == 1) {
      const auto& child = g.runs[run.children[0]];
      EXPECT_TRUE(child.parents.size() > 1 || child.closed != run.closed) << "a run that is not maximal";
    }
  }
  for (const int times : seen) EXPECT_EQ(times, 1);
}

TEST(contour_graph, parallel_cuts_of_a_square_are_one_open_run) {
  const TriangleMesh mesh = square(6);
  const ContourSet set = contour_set(mesh, height_field(mesh, {1, 0.2, 0}), steps(0.05, 0.09, 10));
  expect_consistent(set);
  ASSERT_EQ(set.graph.runs.size(), 1u);
  EXPECT_FALSE(set.graph.runs[0].closed);
  EXPECT_EQ(set.graph.runs[0].contours.size(), 10u);
}

TEST(contour_graph, offsets_of_a_square_are_one_closed_run) {
  const TriangleMesh mesh = square(20);
  const auto inset = sampled(mesh, [](const Vec3& p) { return std::min({p.x(), p.y(), 1 - p.x(), 1 - p.y()}); });
  const ContourSet set = contour_set(mesh, inset, steps(0.02, 0.06, 9));  // the last is above the top
  expect_consistent(set);
  ASSERT_EQ(set.graph.runs.size(), 1u);
  EXPECT_TRUE(set.graph.runs[0].closed);
  EXPECT_EQ(set.graph.runs[0].contours.size(), 8u);
}

TEST(contour_graph, two_peaks_branch) {
  const TriangleMesh mesh = square(40);
  const auto peaks = sampled(mesh, [](const Vec3& p) {
    return std::max({0.0, 0.3 - (p - Vec3(0.3, 0.5, 0)).norm(), 0.3 - (p - Vec3(0.7, 0.5, 0)).norm()});
  });
  const ContourSet set = contour_set(mesh, peaks, steps(0.015, 0.03, 9));  // the saddle is at 0.1
  expect_consistent(set);
  ASSERT_EQ(set.graph.runs.size(), 3u);
  EXPECT_EQ(set.graph.runs[0].children, (std::vector<Index>{1, 2}));
  EXPECT_EQ(set.graph.runs[0].contours.size(), 3u);
  EXPECT_EQ(set.graph.runs[1].contours.size(), set.graph.runs[2].contours.size());
}

TEST(contour_graph, a_cylinder_is_one_closed_run) {
  const TriangleMesh mesh = test::open_cylinder(12, 5, 1, 3);
  const ContourSet set = contour_set(mesh, height_field(mesh, {0, 0, 1}), steps(0.1, 0.35, 8));
  expect_consistent(set);
  ASSERT_EQ(set.graph.runs.size(), 1u);
  EXPECT_TRUE(set.graph.runs[0].closed);
}

TEST(contour_graph, a_lying_torus_splits_and_joins) {
  const TriangleMesh mesh = test::torus(40, 20, 3, 1);
  const ContourSet set = contour_set(mesh, height_field(mesh, {1, 0, 0}), steps(-3.9, 0.3, 27));  // saddles at ±2
  expect_consistent(set);
  const auto& runs = set.graph.runs;
  ASSERT_EQ(runs.size(), 4u);
  EXPECT_EQ(runs[0].children, (std::vector<Index>{1, 2}));
  EXPECT_EQ(runs[1].children, std::vector<Index>{3});
  EXPECT_EQ(runs[2].children, std::vector<Index>{3});
  for (const auto& run : runs) EXPECT_TRUE(run.closed);
}

TEST(contour_graph, sees_loops_inside_one_face) {
  const TriangleMesh mesh = square(1, 10);
  const PointDistance distance(mesh, {{6, 2, 0}, {8, 2.3, 0}, {2, 8, 0}});
  // Discs touch at 1.01; up to 1.6 nothing meets the diagonal or the sides.
  const ContourSet set = contour_set(mesh, distance, std::vector<double>{0.3, 0.6, 0.9, 1.2, 1.5});
  expect_consistent(set);
  ASSERT_EQ(set.contours.size(), 3u * 3 + 2 * 2);
  ASSERT_EQ(set.graph.runs.size(), 4u);
  std::multiset<std::size_t> lengths;
  int joined = 0;
  for (const auto& run : set.graph.runs) {
    lengths.insert(run.contours.size());
    joined += run.parents.size() == 2 ? 1 : 0;
  }
  EXPECT_EQ(joined, 1);
  EXPECT_EQ(lengths, (std::multiset<std::size_t>{2, 3, 3, 5}));
}

TEST(contour_graph, keeps_pairs_of_one_band_only_where_a_descent_leads) {
  // Two troughs at x = 1 and x = 5; between them two plateaus, parted by flat corridors that make all one band.
  const TriangleMesh mesh = test::planar_grid(60, 10, 6, 1);
  const auto f = sampled(mesh, [](const Vec3& p) {
    const double to_trough = std::min(std::abs(p.x() - 1), std::abs(p.x() - 5));
    const bool corridor = p.y() > 0.75 || std::abs(p.x() - 3) < 0.15;
    return std::min(to_trough, corridor ? 1.1 : 1.3);
  });
  const ContourSet set = contour_set(mesh, f, std::vector<double>{0.55, 1.2});
  expect_consistent(set);
  const auto x_of = [&](Index k) { return position_of(mesh, set.contours[k].points.front()).x(); };
  int linked = 0;
  ASSERT_EQ(set.contours.size(), 6u);  // 4 below and 2 above
  for (Index k = 0; k < 6; ++k) {
    for (const Index child : set.graph.children[k]) {
      ++linked;
      EXPECT_LT(std::abs(x_of(k) - x_of(child)), 1.4);
      EXPECT_EQ(x_of(k) < 3, x_of(child) < 3);
    }
  }
  EXPECT_EQ(linked, 2);
}

TEST(bands, and_contours_of_random_values_have_the_cycles_that_the_surface_allows) {
  const std::vector<std::pair<TriangleMesh, int>> cases = {
      {test::icosphere(2, 1), 0}, {square(6), 0}, {test::torus(12, 6, 3, 1), 1}, {test::open_cylinder(8, 4, 1, 2), 1}};
  const std::vector<double> levels{0.2, 0.35, 0.5, 0.51, 0.8};
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto& [mesh, most_cycles] = cases[seed % cases.size()];
    const VertexField field(mesh, random_values(mesh, random));
    const LevelCut cut = cut_levels(mesh, field, levels, 1e-3, Progress::none());
    Bands bands(mesh, field, cut);
    std::map<Index, std::set<Index>> lower_levels;
    std::map<Index, std::set<Index>> upper_levels;
    std::set<Index> components;
    for (Index piece = 0; piece < static_cast<Index>(cut.pieces.size()); ++piece) {
      components.insert({bands.above(piece), bands.below(piece)});
      lower_levels[bands.above(piece)].insert(cut.pieces[piece].level);
      upper_levels[bands.below(piece)].insert(cut.pieces[piece].level);
    }
    for (const Index component : components) {
      ASSERT_LE(lower_levels[component].size(), 1u);
      ASSERT_LE(upper_levels[component].size(), 1u);
      if (lower_levels[component].empty() || upper_levels[component].empty()) continue;
      ASSERT_EQ(*lower_levels[component].begin() + 1, *upper_levels[component].begin());
    }
    const ContourSet set = contour_set(mesh, field, levels);
    expect_consistent(set);
    // Bands as nodes and contours as links: connected, with no more independent cycles than cuts that do not divide
    // the surface: genus + boundary loops - 1.
    const auto cycles = static_cast<int>(set.contours.size()) - static_cast<int>(components.size()) + 1;
    ASSERT_GE(cycles, 0);
    ASSERT_LE(cycles, most_cycles);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(contour_graph, of_random_point_distances_is_consistent) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    const TriangleMesh mesh = square(1 + int(seed % 6));
    std::vector<Vec3> centres;
    for (std::uint64_t i = 0; i <= seed % 6; ++i) centres.emplace_back(uniform(random), uniform(random), 0);
    const PointDistance distance(mesh, centres);
    const ContourSet set = contour_set(mesh, distance, steps(0.03, 0.05, 12));
    expect_consistent(set);
    // A distance has no minimum but its sources: every contour but the first around a source comes from one below.
    for (std::size_t k = 0; k < set.contours.size(); ++k) {
      EXPECT_EQ(set.graph.parents[k].empty(), set.contours[k].level == set.contours[0].level) << "contour " << k;
    }
  }
}

TEST(contour_graph, of_many_sources_on_few_faces_is_consistent) {
  // as a path on a coarse part: fronts meet everywhere inside the faces, and contours of neighbouring levels may touch
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    test::Rng rng(seed);
    const TriangleMesh mesh = test::cube(1, 10);
    SourceSet sources;
    for (int i = 0; i < 40; ++i) {
      const SurfacePoint a = test::random_surface_point(rng, mesh);
      SurfacePoint b = test::random_surface_point(rng, mesh);
      b.face = a.face;
      b.barycentric = 0.7 * a.barycentric + 0.3 * b.barycentric;
      const SurfacePoint segment[] = {a, b};
      sources.add_polyline(mesh, segment, false);
    }
    expect_consistent(contour_set(mesh, ExactField::compute(mesh, sources), steps(0.3, 0.25, 12)));
  }
}

}  // namespace
}  // namespace isopath
