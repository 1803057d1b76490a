#include "isopath/impact/passes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/vertex_field.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

Passes passes_from_boundary(const TriangleMesh& mesh, double spacing) {
  return choose_passes(mesh, ExactField::compute(mesh, boundary_source(mesh)), spacing, Progress::none());
}

/// Every contour in one run, in ascending order, all of the run's kind.
void expect_each_in_one_run(const Passes& passes) {
  std::vector<int> seen(passes.contours.size(), 0);
  for (const Passes::Run& run : passes.runs) {
    ASSERT_FALSE(run.contours.empty());
    for (std::size_t i = 0; i < run.contours.size(); ++i) {
      const Contour& contour = passes.contours[run.contours[i]];
      ++seen[run.contours[i]];
      EXPECT_EQ(contour.closed, run.closed);
      if (i == 0) continue;
      EXPECT_LT(passes.contours[run.contours[i - 1]].level, contour.level);
    }
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(seen.size()));
}

/// Places k half spacings up from the least value; full levels are at odd ones.
long place_of(const Contour& contour, double low, double spacing) {
  const double place = (contour.level - low) / (0.5 * spacing);
  EXPECT_NEAR(place, std::round(place), 1e-6);
  return std::lround(place);
}

TEST(passes, divide_the_range_evenly_from_half_a_spacing_inside_its_ends) {
  const TriangleMesh mesh = test::planar_grid(10, 10, 20, 20, {.jitter = 0.2});
  for (const double spacing : {2.0, 2.1, 3.0, 0.77, 9.0, 10.0}) {
    const Passes passes = passes_from_boundary(mesh, spacing);
    expect_each_in_one_run(passes);
    const int count = static_cast<int>(std::ceil(10 / spacing - 1e-6));  // the least that is dense enough
    ASSERT_EQ(static_cast<int>(passes.contours.size()), count) << "spacing " << spacing;
    EXPECT_NEAR(passes.spacing, 10.0 / count, 0.01 * spacing / count + 1e-9);
    for (int k = 0; k < count; ++k) {
      EXPECT_NEAR(passes.contours[k].level, (k + 0.5) * 10 / count, 0.01 * spacing) << "spacing " << spacing;
      EXPECT_TRUE(passes.contours[k].closed);
    }
    EXPECT_EQ(passes.runs.size(), 1u);
  }
}

TEST(passes, of_two_rooms_and_a_corridor_fall_into_three_runs) {
  // Rooms of side 10 (inner distance up to 5), corridor of width 4 (up to 2): levels 0.5 and 1.5 go round everything,
  // 2.5, 3.5 and 4.5 round each room.
  const TriangleMesh mesh =
      test::planar_cells(30, 10, [](int i, int j) { return i < 10 || i >= 20 || (j >= 3 && j < 7); });
  const Passes passes = passes_from_boundary(mesh, 1);
  expect_each_in_one_run(passes);
  ASSERT_EQ(passes.runs.size(), 3u);
  std::multimap<std::size_t, double> first_level;
  for (const Passes::Run& run : passes.runs) {
    EXPECT_TRUE(run.closed);
    first_level.emplace(run.contours.size(), passes.contours[run.contours.front()].level);
  }
  EXPECT_EQ(first_level.count(2), 1u);
  EXPECT_EQ(first_level.count(3), 2u);
  for (const auto& [size, level] : first_level) EXPECT_NEAR(level, size == 2 ? 0.5 : 2.5, 1e-6);
}

TEST(passes, reach_every_top) {
  // A room of side 10 and one of side 7: whatever the spacing, a top must not rise by more than half a spacing above
  // the last pass inside it; and there is a pass between two full levels only where it would.
  const TriangleMesh mesh =
      test::planar_cells(22, 10, [](int i, int j) { return i < 10 || (i >= 15 && j < 7) || (j >= 2 && j < 5); });
  int extra = 0;
  for (const double spacing : {0.61, 0.73, 0.98, 1.1, 1.3, 1.45, 1.6, 1.9, 2.3}) {
    const Passes passes = passes_from_boundary(mesh, spacing);
    expect_each_in_one_run(passes);
    double highest = 0;       // in the small room
    double highest_full = 0;  // of the full levels there
    for (const Contour& contour : passes.contours) {
      const bool full = place_of(contour, 0, passes.spacing) % 2 == 1;
      const bool in_small_room = std::any_of(contour.points.begin(), contour.points.end(),
                                             [&](const SurfacePoint& p) { return position_of(mesh, p).x() > 15.2; });
      if (!in_small_room) {
        if (contour.level > 3.6) {
          EXPECT_TRUE(full) << "in the large room, level " << contour.level;
        }
        continue;
      }
      highest = std::max(highest, contour.level);
      if (full) {
        highest_full = std::max(highest_full, contour.level);
      } else {
        ++extra;
        EXPECT_GT(3.5 - (contour.level - 0.5 * passes.spacing), 0.5 * passes.spacing);
      }
    }
    EXPECT_LE(3.5 - highest, 0.5 * passes.spacing * (1 + 1e-6)) << "spacing " << spacing;
    if (3.5 - highest_full > 0.51 * passes.spacing) {
      EXPECT_GT(highest, highest_full) << "spacing " << spacing;
    }
  }
  EXPECT_GT(extra, 0) << "no spacing tried needed an extra pass";
}

TEST(passes, from_one_edge_of_a_plate_are_one_open_run) {
  const TriangleMesh mesh = test::planar_grid(20, 10, 20, 10);
  std::vector<Index> edge;
  for (const Index h : mesh.boundary_loops()[0]) {
    if (mesh.position(mesh.from(h)).y() == 0 && mesh.position(mesh.to(h)).y() == 0) edge.push_back(h);
  }
  std::sort(edge.begin(), edge.end(),
            [&](Index a, Index b) { return mesh.position(mesh.from(a)).x() < mesh.position(mesh.from(b)).x(); });
  SourceSet source;
  source.add_halfedges(mesh, edge, false);
  const Passes passes = choose_passes(mesh, ExactField::compute(mesh, source), 2, Progress::none());
  expect_each_in_one_run(passes);
  ASSERT_EQ(passes.runs.size(), 1u);
  EXPECT_FALSE(passes.runs[0].closed);
  ASSERT_EQ(passes.contours.size(), 5u);
  for (int k = 0; k < 5; ++k) {
    EXPECT_NEAR(length_of(mesh, passes.contours[k]), 20, 1e-9);
    for (const SurfacePoint& p : passes.contours[k].points) EXPECT_NEAR(position_of(mesh, p).y(), 2.0 * k + 1, 1e-9);
  }
}

TEST(passes, meet_a_component_too_narrow_for_any_level) {
  // a large plate, and one that is narrower than half a spacing
  TriangleSoup soup = test::planar_grid(8, 8, 20, 20).soup();
  const TriangleSoup narrow = test::planar_grid(4, 1, 4, 0.5).soup();
  const auto offset = static_cast<Index>(soup.positions.size());
  for (const Vec3& p : narrow.positions) soup.positions.push_back(p + Vec3(50, 0, 0));
  for (const Triangle& t : narrow.triangles) soup.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  const TriangleMesh mesh(soup);
  const Passes passes = choose_passes(mesh, ExactField::compute(mesh, boundary_source(mesh)), 3, Progress::none());
  expect_each_in_one_run(passes);
  int on_narrow = 0;
  for (const Contour& contour : passes.contours) {
    for (const SurfacePoint& p : contour.points) {
      if (position_of(mesh, p).x() < 40) continue;
      ++on_narrow;
      EXPECT_GE(position_of(mesh, p).y(), 0.05);
      EXPECT_LE(position_of(mesh, p).y(), 0.45);
    }
  }
  EXPECT_GT(on_narrow, 2);
}

TEST(passes, on_missed_components_are_those_of_each_component_alone) {
  // a plate, and strips of different widths below half a spacing: each has its one pass round it, half way in
  TriangleSoup soup = test::planar_grid(8, 8, 20, 20).soup();
  const std::vector<double> widths = {0.3, 0.5, 0.8, 1.1};
  for (std::size_t k = 0; k < widths.size(); ++k) {
    const TriangleSoup strip = test::planar_grid(6, 2, 6, widths[k]).soup();
    const auto offset = static_cast<Index>(soup.positions.size());
    const auto shift = 30.0 + 10.0 * static_cast<double>(k);
    for (const Vec3& p : strip.positions) soup.positions.push_back(p + Vec3(shift, 0, 0));
    for (const Triangle& t : strip.triangles) soup.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  const TriangleMesh mesh(soup);
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  const Passes passes = choose_passes(mesh, field, 3, Progress::none());
  expect_each_in_one_run(passes);
  std::map<Index, int> contours_of;
  for (const Contour& contour : passes.contours) {
    const Index component = mesh.component_of(contour.points.front().face);
    if (component == 0) continue;
    ++contours_of[component];
    EXPECT_TRUE(contour.closed);
    EXPECT_NEAR(contour.level, widths[component - 1] / 4, 1e-9);
    for (const SurfacePoint& p : contour.points) {
      EXPECT_EQ(mesh.component_of(p.face), component);
      EXPECT_NEAR(field.value(p), contour.level, 1e-9 * mesh.size());
    }
  }
  for (Index c = 1; c <= 4; ++c) EXPECT_EQ(contours_of[c], 1) << "component " << c;
}

TEST(passes, beyond_all_counting_are_refused) {
  const TriangleMesh mesh = test::planar_grid(3, 3, 3, 3);
  const VertexField field = height_field(mesh, Vec3::UnitX());
  for (const double spacing : {1e-7, 1e-12, 1e-300}) {
    EXPECT_THROW(choose_passes(mesh, field, spacing, Progress::none()), Error) << spacing;
  }
}

TEST(passes, of_a_function_without_range_are_none) {
  const TriangleMesh mesh = test::planar_grid(3, 3, 3, 3);
  for (const double value : {infinity, 4.0}) {
    const VertexField field(mesh, std::vector<double>(mesh.n_vertices(), value));
    const Passes passes = choose_passes(mesh, field, 1, Progress::none());
    EXPECT_TRUE(passes.contours.empty());
    EXPECT_TRUE(passes.runs.empty());
  }
}

TEST(passes, of_exact_layout_are_the_asked_spacing_apart) {
  const TriangleMesh disc = test::open_cone(72, 12, 24, 24);
  SourceSet source;
  source.add_vertex(disc, 0);
  const ExactField field = ExactField::compute(disc, source);
  for (const double spacing : {1.9, 2.2, 5.3, 11.0}) {
    const Passes passes = choose_passes(disc, field, spacing, Progress::none(), PassLayout::exact);
    EXPECT_EQ(passes.spacing, spacing);
    double last = 0;
    for (const Contour& contour : passes.contours) {
      const double place = contour.level / spacing - 0.5;
      // whole numbers, and at the top a half
      EXPECT_NEAR(2 * place, std::round(2 * place), 1e-9) << spacing;
      if (contour.level < 24 - spacing) {
        EXPECT_NEAR(place, std::round(place), 1e-9) << spacing;
      }
      EXPECT_LE(contour.level - last, (1 + 1e-9) * spacing) << spacing;
      last = contour.level;
    }
    EXPECT_LE(24 - last, (0.5 + 1e-9) * spacing) << spacing;
  }
  // a range below the spacing has nothing to be exact about
  const Passes one = choose_passes(disc, field, 30, Progress::none(), PassLayout::exact);
  ASSERT_EQ(one.contours.size(), 1u);
  EXPECT_NEAR(one.contours[0].level, 12, 1e-6);
}

}  // namespace
}  // namespace isopath
