#include "isopath/mesh/check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/mesh/read_mesh.h"
#include "isopath/mesh/repair.h"
#include "isopath/mesh/self_intersections.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {
namespace {

/// A grid of n × m quads over [0, n] × [0, m]; with `wrap_x`, `wrap_y` its sides are glued (a torus when both).
TriangleSoup grid(Index n, Index m, bool wrap_x = false, bool wrap_y = false) {
  TriangleSoup soup;
  const Index columns = wrap_x ? n : n + 1;
  const Index rows = wrap_y ? m : m + 1;
  for (Index i = 0; i < columns; ++i) {
    for (Index j = 0; j < rows; ++j) soup.positions.emplace_back(i, j, 0);
  }
  const auto at = [&](Index i, Index j) { return i % columns * rows + j % rows; };
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < m; ++j) {
      soup.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return soup;
}

TEST(Check, DescribesAPlate) {
  const MeshReport report = check_mesh(grid(4, 3));
  EXPECT_EQ(report.triangles, 24);
  EXPECT_EQ(report.vertices, 20);
  EXPECT_DOUBLE_EQ(report.area, 12);
  EXPECT_EQ(report.bounds.max(), Vec3(4, 3, 0));
  EXPECT_EQ(report.euler_characteristic, 1);
  EXPECT_EQ(report.genus, 0);
  EXPECT_EQ(report.components, 1);
  EXPECT_FALSE(report.closed);
  EXPECT_TRUE(report.manifold && report.orientable && report.sound());
  ASSERT_EQ(report.boundary_loops.size(), 1u);
  EXPECT_DOUBLE_EQ(report.boundary_loops[0].length, 14);
  EXPECT_EQ(report.boundary_loops[0].edges, 14);
  EXPECT_TRUE(report.defects.empty());
}

TEST(Check, FindsTheGenusOfTorusAndAnnulus) {
  const MeshReport torus = check_mesh(grid(5, 4, true, true));
  EXPECT_TRUE(torus.closed);
  EXPECT_EQ(torus.genus, 1);
  EXPECT_EQ(torus.euler_characteristic, 0);
  EXPECT_TRUE(torus.boundary_loops.empty());
  const MeshReport annulus = check_mesh(grid(5, 4, true, false));
  EXPECT_EQ(annulus.genus, 0);
  EXPECT_EQ(annulus.boundary_loops.size(), 2u);
}

TEST(Check, AddsUpComponents) {
  TriangleSoup two = grid(5, 4, true, true);
  const TriangleSoup plate = grid(2, 2);
  const auto offset = static_cast<Index>(two.positions.size());
  for (const Vec3& p : plate.positions) two.positions.push_back(p + Vec3(0, 0, 9));
  for (const auto& [a, b, c] : plate.triangles) two.triangles.push_back({a + offset, b + offset, c + offset});
  const MeshReport report = check_mesh(two);
  EXPECT_EQ(report.components, 2);
  EXPECT_EQ(report.genus, 1);
  EXPECT_EQ(report.boundary_loops.size(), 1u);
}

TEST(Check, NamesEveryDefectWithItsFirstElements) {
  TriangleSoup soup = grid(3, 3);  // 16 vertices, 18 triangles
  std::swap(soup.triangles[8][0], soup.triangles[8][1]);
  soup.triangles.push_back(soup.triangles[0]);  // 18: duplicate, crowds its two inner edges
  soup.triangles.push_back({0, 0, 1});          // 19: repeated vertex
  soup.triangles.push_back({0, 1, 99});         // 20: out of range
  soup.positions.insert(soup.positions.end(), {{9, 9, 0}, {10, 9, 0}, {11, 9, 0}, {9, 9, 0}, {12, 9, 1e-4}});
  soup.triangles.push_back({16, 17, 18});  // 21: zero area
  soup.triangles.push_back({16, 18, 20});  // 22: sliver; 19 unused, at 16's place
  soup.positions.insert(soup.positions.end(), {{std::nan(""), 0, 0}, {0, 1e80, 0}});  // 21, 22
  const MeshReport report = check_mesh(soup);
  const auto first = [&](DefectKind kind) { return report.find(kind)->first; };
  using Elements = std::vector<std::vector<Index>>;
  EXPECT_EQ(first(DefectKind::duplicate_triangle), (Elements{{18, 0}}));
  EXPECT_EQ(first(DefectKind::repeated_vertex), (Elements{{19}}));
  EXPECT_EQ(first(DefectKind::index_out_of_range), (Elements{{20}}));
  EXPECT_EQ(first(DefectKind::zero_area), (Elements{{21}}));
  EXPECT_EQ(first(DefectKind::sliver), (Elements{{22}}));
  EXPECT_EQ(first(DefectKind::duplicate_position), (Elements{{19, 16}}));
  EXPECT_EQ(first(DefectKind::non_finite_coordinate), (Elements{{21}}));
  EXPECT_EQ(first(DefectKind::overflowing_coordinate), (Elements{{22}}));
  EXPECT_EQ(first(DefectKind::unreferenced_vertex), (Elements{{19}, {21}, {22}}));
  EXPECT_EQ(report.count(DefectKind::inconsistent_orientation), 4) << "around triangle 8, and the duplicate's rim";
  EXPECT_EQ(report.count(DefectKind::non_manifold_edge), 2) << "the inner edges of the duplicate";
  EXPECT_FALSE(report.sound());
  EXPECT_FALSE(report.genus.has_value());
  EXPECT_EQ(name_of(DefectKind::duplicate_triangle), "duplicate_triangle");
  EXPECT_EQ(name_of(DefectKind::unreferenced_vertex), "unreferenced_vertex");
}

TEST(Check, ListsOnlyTheFirstElements) {
  TriangleSoup soup = grid(1, 1);
  for (int i = 0; i < 9; ++i) soup.positions.emplace_back(i + 5, 0, 0);
  const MeshReport report = check_mesh(soup, {.listed = 2});
  EXPECT_EQ(report.count(DefectKind::unreferenced_vertex), 9);
  EXPECT_EQ(report.find(DefectKind::unreferenced_vertex)->first, (std::vector<std::vector<Index>>{{4}, {5}}));
  EXPECT_TRUE(report.sound());
}

TEST(Check, TellsAMoebiusBandFromAReversedTriangle) {
  TriangleSoup band;
  constexpr Index n = 12;
  for (Index i = 0; i < n; ++i) {
    band.positions.emplace_back(std::cos(i), std::sin(i), 0);
    band.positions.emplace_back(2 * std::cos(i), 2 * std::sin(i), 1);
    const Index c = i + 1 < n ? 2 * i + 2 : 1;
    const Index d = i + 1 < n ? 2 * i + 3 : 0;
    band.triangles.push_back({2 * i, c, 2 * i + 1});
    band.triangles.push_back({2 * i + 1, c, d});
  }
  const MeshReport moebius = check_mesh(band);
  EXPECT_FALSE(moebius.orientable);
  EXPECT_FALSE(moebius.genus.has_value());
  EXPECT_EQ(moebius.euler_characteristic, 0);
  EXPECT_EQ(moebius.boundary_loops.size(), 1u);
  TriangleSoup plate = grid(3, 3);
  std::swap(plate.triangles[9][0], plate.triangles[9][1]);
  EXPECT_TRUE(check_mesh(plate).orientable);
  EXPECT_EQ(check_mesh(plate).genus, 0);
}

TEST(Check, FindsAVertexWhereFansTouch) {
  const TriangleSoup bow{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}};
  const MeshReport report = check_mesh(bow);
  EXPECT_EQ(report.find(DefectKind::non_manifold_vertex)->first, (std::vector<std::vector<Index>>{{0}}));
  EXPECT_EQ(report.components, 2);
  EXPECT_EQ(report.boundary_loops.size(), 2u);
}

TEST(Check, AgreesWithTriangleMeshOnWhatIsSound) {
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    std::mt19937_64 random(seed);
    TriangleSoup soup;
    const auto n = static_cast<Index>(3 + random() % 8);
    for (Index v = 0; v < n; ++v) {
      soup.positions.emplace_back(static_cast<double>(random() % 100), static_cast<double>(random() % 100), 1.0 * v);
    }
    if (random() % 20 == 0) soup.positions[0].x() = random() % 2 ? std::nan("") : 1e99;
    for (std::uint64_t t = 1 + random() % 4; t > 0; --t) {
      const auto pick = [&] { return static_cast<Index>(random() % n); };
      soup.triangles.push_back({pick(), pick(), pick()});
    }
    bool accepted = true;
    try {
      const TriangleMesh mesh(soup);
      const MeshReport report = check_mesh(soup);
      EXPECT_EQ(report.boundary_loops.size(), mesh.boundary_loops().size()) << "seed " << seed;
      EXPECT_EQ(report.components, mesh.n_components()) << "seed " << seed;
      EXPECT_EQ(report.edges, mesh.n_edges()) << "seed " << seed;
      EXPECT_NEAR(report.area, mesh.area(), 1e-9 * mesh.area()) << "seed " << seed;
    } catch (const Error&) {
      accepted = false;
    }
    EXPECT_EQ(check_mesh(soup).sound(), accepted) << "seed " << seed;
  }
}

TEST(TriangleMesh, RefusesWhatIsTooSmallToSquare) {
  const TriangleSoup soup = grid(3, 3);
  const auto scaled = [&](double factor) {
    TriangleSoup result = soup;
    for (Vec3& p : result.positions) p *= factor;
    return result;
  };
  for (const double factor : {1e-100, 1e-200, 1e-320}) {
    EXPECT_THROW(TriangleMesh(scaled(factor)), Error);
    EXPECT_THROW(repair_mesh(scaled(factor)), Error);
  }
  for (const double factor : {1e-69, 0.0}) {
    EXPECT_NO_THROW(TriangleMesh(scaled(factor)));
  }
}

TEST(Check, RefusesOptionsOutOfRange) {
  EXPECT_THROW(check_mesh(grid(1, 1), {.listed = -1}), Error);
  EXPECT_THROW(check_mesh(grid(1, 1), {.sliver_aspect = std::nan("")}), Error);
}

TEST(SelfIntersections, FindsTrianglesThatCross) {
  const TriangleSoup crossing{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {9, 9, 1}},
                              {{0, 1, 2}, {3, 4, 5}}};
  using Pairs = std::vector<std::array<Index, 2>>;
  EXPECT_EQ(find_self_intersections(crossing), (Pairs{{0, 1}}));
  TriangleSoup apart = crossing;
  for (int v = 3; v < 6; ++v) apart.positions[v] += Vec3(2, 2, 0);
  EXPECT_TRUE(find_self_intersections(apart).empty());
  TriangleSoup touching = crossing;
  touching.positions[3].z() = 0;  // a corner stands on the other triangle
  touching.positions[5].z() = 1;
  EXPECT_TRUE(find_self_intersections(touching).empty());
}

TEST(SelfIntersections, FindsOverlapInAPlaneButNotNeighbours) {
  const TriangleSoup overlap{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {5, 1, 0}, {1, 5, 0}},
                             {{0, 1, 2}, {3, 4, 5}}};
  EXPECT_EQ(find_self_intersections(overlap).size(), 1u);
  EXPECT_TRUE(find_self_intersections(grid(6, 6)).empty());
  TriangleSoup loose;  // the same plate with every triangle on its own
  for (const TriangleSoup plate = grid(6, 6); const auto& t : plate.triangles) {
    for (const Index v : t) loose.positions.push_back(plate.positions[v]);
    const auto n = static_cast<Index>(loose.positions.size());
    loose.triangles.push_back({n - 3, n - 2, n - 1});
  }
  EXPECT_TRUE(find_self_intersections(loose).empty());
}

TEST(SelfIntersections, TreeFindsWhatTryingAllPairsFinds) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const auto point = [&] { return Vec3(normal(random), normal(random), normal(random)); };
    TriangleSoup soup;
    for (Index t = 0; t < 60; ++t) {
      const Vec3 centre = 2 * point();
      for (int i = 0; i < 3; ++i) soup.positions.emplace_back(centre + 0.7 * point());
      soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    std::vector<std::array<Index, 2>> expected;
    for (Index s = 0; s < 60; ++s) {
      for (Index t = s + 1; t < 60; ++t) {
        const TriangleSoup pair{soup.positions, {soup.triangles[s], soup.triangles[t]}};
        if (!find_self_intersections(pair).empty()) expected.push_back({s, t});
      }
    }
    EXPECT_FALSE(expected.empty());
    EXPECT_EQ(find_self_intersections(soup), expected) << "seed " << seed;
  }
}

struct Known {
  const char* file;
  DefectKind kind;
  Index count;
};

/// What other programs counted in these files.
TEST(Check, CountsTheDefectsOfSharedFiles) {
  const std::filesystem::path folder = ISOPATH_SHARED_DIR;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no folder " << folder;
  for (const auto& [name, kind, count] : {Known{"flipped_blobby.off", DefectKind::inconsistent_orientation, 3069},
                                          Known{"flipped_cube.off", DefectKind::inconsistent_orientation, 9},
                                          Known{"degenerate_sliding.off", DefectKind::zero_area, 4},
                                          Known{"doubled_faces_cone.stl", DefectKind::duplicate_triangle, 338},
                                          Known{"doubled_faces_cone.stl", DefectKind::non_manifold_edge, 507},
                                          Known{"scan_swri_part_nonmanifold.stl", DefectKind::non_manifold_edge, 18},
                                          Known{"scan_swri_part_nonmanifold.stl", DefectKind::duplicate_triangle, 11},
                                          Known{"cad_assembly_mess.stl", DefectKind::non_manifold_edge, 7233},
                                          Known{"cad_assembly_mess.stl", DefectKind::duplicate_triangle, 3622},
                                          Known{"sphere_pinched_hole.stl", DefectKind::non_manifold_vertex, 2},
                                          Known{"unwelded_not_convex.obj", DefectKind::duplicate_position, 244},
                                          Known{"nan_two_vertices.off", DefectKind::non_finite_coordinate, 2}}) {
    const MeshFile file = read_mesh(folder / "broken" / name, {.weld = false});
    EXPECT_EQ(check_mesh(file.soup).count(kind), count) << name << " " << name_of(kind);
  }
  const auto crossings = [&](const char* name) {
    const MeshFile file = read_mesh(folder / "broken" / name);
    return check_mesh(file.soup, {.self_intersections = true}).count(DefectKind::self_intersection);
  };
  EXPECT_GT(crossings("intersecting_tetra_triangle.off"), 0);
  EXPECT_GT(crossings("self_intersect_A.obj"), 0);
  EXPECT_EQ(crossings("flipped_cube.off"), 0);
}

}  // namespace
}  // namespace isopath
