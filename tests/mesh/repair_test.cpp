#include "isopath/mesh/repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/mesh/read_mesh.h"
#include "isopath/mesh/triangle_mesh.h"
#include "isopath/mesh/write_mesh.h"

namespace isopath {
namespace {

/// (n + 1)² vertices over the unit square, 2 n² triangles.
TriangleSoup grid(int n) {
  TriangleSoup soup;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) soup.positions.emplace_back(1.0 * i / n, 1.0 * j / n, 0);
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const Index a = i * (n + 1) + j;
      const Index b = a + n + 1;
      soup.triangles.push_back({a, b, b + 1});
      soup.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return soup;
}

TriangleSoup cube() {
  TriangleSoup soup;
  for (int i = 0; i < 8; ++i) soup.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  soup.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return soup;
}

const TriangleSoup a_cube = cube();
const TriangleSoup square = grid(1);

double volume(const TriangleSoup& soup) {
  double six = 0;
  for (const auto& [a, b, c] : soup.triangles) {
    six += soup.positions[a].dot(soup.positions[b].cross(soup.positions[c]));
  }
  return six / 6;
}

Index count_of(const RepairResult& result, const std::string& what) {
  for (const RepairChange& change : result.changes) {
    if (change.what.find(what) != std::string::npos) return change.count;
  }
  return 0;
}

void expect_unchanged(const TriangleSoup& soup, const std::string& name, const RepairOptions& options = {}) {
  const RepairResult again = repair_mesh(soup, options);
  EXPECT_EQ(again.soup.positions, soup.positions) << name;
  EXPECT_EQ(again.soup.triangles, soup.triangles) << name;
  for (const RepairChange& change : again.changes) ADD_FAILURE() << name << ": " << change.count << " " << change.what;
}

/// What every result promises.
void expect_promises(const TriangleSoup& input, const RepairResult& result, const std::string& name) {
  EXPECT_NO_THROW(TriangleMesh(result.soup)) << name;
  ASSERT_EQ(result.vertex_of_input.size(), input.positions.size()) << name;
  const auto n = static_cast<Index>(result.soup.positions.size());
  for (const Index v : result.vertex_of_input) EXPECT_TRUE(v >= no_index && v < n) << name;
  for (const RepairChange& change : result.changes) EXPECT_GT(change.count, 0) << name;
  expect_unchanged(result.soup, name);
}

TEST(Repair, CleanMeshesComeBackAsTheyWere) {
  expect_unchanged(grid(5), "grid");
  expect_unchanged(cube(), "cube");
  TriangleSoup inside_out = cube();
  for (Triangle& t : inside_out.triangles) std::swap(t[1], t[2]);
  expect_unchanged(inside_out, "a cavity stays a cavity");
}

TEST(Repair, DropsUnusableCoordinatesWithTheirTriangles) {
  for (const double bad : {std::nan(""), infinity, -infinity, 1e80}) {
    TriangleSoup soup = grid(4);
    soup.positions[12].y() = bad;  // the middle: six triangles
    const RepairResult result = repair_mesh(soup);
    expect_promises(soup, result, "bad coordinate");
    EXPECT_EQ(result.soup.triangles.size(), 32u - 6u);
    EXPECT_EQ(result.vertex_of_input[12], no_index);
    EXPECT_EQ(result.soup.positions[result.vertex_of_input[24]], soup.positions[24]);
  }
}

TEST(Repair, DropsIndicesOutOfRange) {
  TriangleSoup soup = grid(2);
  soup.triangles.push_back({0, 1, 9});
  soup.triangles.push_back({0, -5, 2});
  const RepairResult result = repair_mesh(soup);
  EXPECT_EQ(result.soup.triangles, grid(2).triangles);
  EXPECT_EQ(count_of(result, "out of range"), 2);
}

TEST(Repair, WeldsATriangleSoupIntoASurface) {
  TriangleSoup apart;
  for (const Triangle& t : a_cube.triangles) {
    for (const Index v : t) apart.positions.push_back(cube().positions[v]);
    const auto n = static_cast<Index>(apart.positions.size());
    apart.triangles.push_back({n - 3, n - 2, n - 1});
  }
  const RepairResult result = repair_mesh(apart);
  expect_promises(apart, result, "unwelded cube");
  EXPECT_EQ(result.soup.positions.size(), 8u);
  EXPECT_EQ(count_of(result, "welded"), 36 - 8);
  EXPECT_TRUE(TriangleMesh(result.soup).boundary_loops().empty());
  EXPECT_EQ(repair_mesh(apart, {.weld = false}).soup.positions.size(), 36u);
}

TEST(Repair, OrientsConsistentlyAndClosedSurfacesOutward) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    std::mt19937_64 random(seed);
    TriangleSoup soup = cube();
    for (Triangle& t : soup.triangles) {
      if (random() % 2) std::swap(t[0], t[2]);
    }
    const RepairResult result = repair_mesh(soup);
    expect_promises(soup, result, "seed " + std::to_string(seed));
    EXPECT_EQ(result.soup.triangles.size(), 12u);
    EXPECT_EQ(result.soup.positions.size(), 8u);
    EXPECT_NEAR(volume(result.soup), result.changes.empty() ? volume(soup) : 1, 1e-12) << "seed " << seed;
  }
}

TEST(Repair, ReversesTheMinority) {
  TriangleSoup soup = grid(6);
  for (const std::size_t t : {3u, 17u, 40u}) std::swap(soup.triangles[t][0], soup.triangles[t][1]);
  const RepairResult result = repair_mesh(soup);
  expect_promises(soup, result, "grid with three reversed");
  EXPECT_EQ(count_of(result, "reversed"), 3);
  const TriangleMesh mesh(result.soup);
  for (Index f = 0; f < mesh.n_faces(); ++f) EXPECT_EQ(mesh.face_normal(f), Vec3(0, 0, 1));
}

TEST(Repair, CutsAMoebiusBandOpen) {
  TriangleSoup band;
  constexpr int n = 20;
  for (int i = 0; i < n; ++i) {
    const double u = 2 * M_PI * i / n;
    for (const double w : {-0.3, 0.3}) {
      const double r = 1 + w * std::cos(u / 2);
      band.positions.emplace_back(r * std::cos(u), r * std::sin(u), w * std::sin(u / 2));
    }
  }
  for (Index i = 0; i < n; ++i) {
    const Index a = 2 * i;
    const Index b = a + 1;
    const Index c = i + 1 < n ? a + 2 : 1;
    const Index d = i + 1 < n ? a + 3 : 0;
    band.triangles.push_back({a, c, b});
    band.triangles.push_back({b, c, d});
  }
  const RepairResult result = repair_mesh(band);
  expect_promises(band, result, "Moebius band");
  EXPECT_EQ(count_of(result, "one-sided"), 1);
  EXPECT_EQ(result.soup.triangles.size(), band.triangles.size());
  const TriangleMesh mesh(result.soup);
  EXPECT_EQ(mesh.n_components(), 1);
  EXPECT_EQ(mesh.boundary_loops().size(), 1u);
  EXPECT_EQ(mesh.n_vertices() - mesh.n_edges() + mesh.n_faces(), 1) << "cut across, it is a disc";
}

TEST(Repair, PartsBoxesThatShareAnEdge) {
  TriangleSoup two = cube();
  for (const Triangle& t : a_cube.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  for (const Vec3& p : a_cube.positions) two.positions.push_back(p + Vec3(1, 1, 0));
  const RepairResult result = repair_mesh(two);
  expect_promises(two, result, "two boxes");
  EXPECT_EQ(result.soup.triangles.size(), 24u);
  EXPECT_EQ(count_of(result, "more than two triangles"), 1);
  EXPECT_TRUE(TriangleMesh(result.soup).boundary_loops().empty());
  EXPECT_NEAR(volume(result.soup), 2, 1e-5);
}

TEST(Repair, PartsFansThatTouchInAVertex) {
  const TriangleSoup bow{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}};
  const RepairResult result = repair_mesh(bow);
  expect_promises(bow, result, "bow tie");
  ASSERT_EQ(result.soup.positions.size(), 6u);
  EXPECT_EQ(result.vertex_of_input, (std::vector<Index>{0, 1, 2, 3, 4}));
  const double moved = (result.soup.positions[5] - result.soup.positions[0]).norm();
  EXPECT_GT(moved, 0) << "the copies would be welded again";
  EXPECT_LT(moved, 1e-6);
}

TEST(Repair, KeepsTwoSheetsOfThreeTogether) {
  const TriangleSoup fan{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0.1}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
  const RepairResult result = repair_mesh(fan);
  expect_promises(fan, result, "three sheets");
  const TriangleMesh mesh(result.soup);
  ASSERT_EQ(mesh.n_components(), 2);
  EXPECT_EQ(mesh.component_of(0), mesh.component_of(1)) << "the flattest pair stays joined";
}

TEST(Repair, RemovesDuplicates) {
  TriangleSoup soup = grid(3);
  soup.triangles.push_back(soup.triangles[4]);
  soup.triangles.push_back({soup.triangles[7][1], soup.triangles[7][0], soup.triangles[7][2]});
  const RepairResult result = repair_mesh(soup);
  EXPECT_EQ(result.soup.triangles, grid(3).triangles);
  EXPECT_EQ(count_of(result, "duplicate"), 2);
}

TEST(Repair, ReplacesACapWithoutOpeningACrack) {
  // Vertex 4 lies on the diagonal: a T-junction, closed by a triangle without area.
  const TriangleSoup soup{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}},
                          {{0, 1, 4}, {1, 2, 4}, {0, 4, 2}, {0, 2, 3}}};
  const RepairResult result = repair_mesh(soup);
  expect_promises(soup, result, "cap");
  const TriangleMesh mesh(result.soup);
  EXPECT_EQ(mesh.n_faces(), 4);
  EXPECT_EQ(mesh.boundary_loops().size(), 1u);
  EXPECT_DOUBLE_EQ(mesh.area(), 1);
  for (Index f = 0; f < mesh.n_faces(); ++f) EXPECT_GT(mesh.face_area(f), 0.1);
  EXPECT_EQ(count_of(result, "tip"), 1);
}

TEST(Repair, CollapsesNeedles) {
  // The middle vertex of the grid twice, 1e-14 apart, with two needles between.
  TriangleSoup soup = grid(2);
  soup.positions.push_back(soup.positions[4] + Vec3(1e-14, 0, 0));
  for (Triangle& t : soup.triangles) {
    if (std::find(t.begin(), t.end(), 4) != t.end() && std::find(t.begin(), t.end(), 8) != t.end()) {
      std::replace(t.begin(), t.end(), 4, 9);
    }
  }
  soup.triangles.push_back({4, 7, 9});
  soup.triangles.push_back({4, 9, 5});
  const RepairResult result = repair_mesh(soup);
  expect_promises(soup, result, "needles");
  EXPECT_EQ(result.soup.triangles, grid(2).triangles);
  EXPECT_EQ(result.vertex_of_input[9], result.vertex_of_input[4]);
}

TEST(Repair, KeepsTheLargestComponentOnRequest) {
  TriangleSoup soup = cube();
  for (const Vec3& p : square.positions) soup.positions.push_back(p + Vec3(5, 0, 0));
  for (const Triangle& t : square.triangles) soup.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  EXPECT_EQ(repair_mesh(soup).soup.triangles.size(), 14u);
  EXPECT_EQ(repair_mesh(soup, {.largest_component = true}).soup.triangles, cube().triangles);
}

TEST(Repair, FillsSmallHolesOnRequest) {
  TriangleSoup soup = grid(6);
  // Out with the six triangles around the middle: a hexagon of length (4 + 2 √2) / 6.
  std::erase_if(soup.triangles, [](const Triangle& t) { return std::find(t.begin(), t.end(), 24) != t.end(); });
  const RepairResult open = repair_mesh(soup);
  EXPECT_EQ(TriangleMesh(open.soup).boundary_loops().size(), 2u);
  const RepairResult filled = repair_mesh(soup, {.fill_holes_length = 1.2});
  const TriangleMesh mesh(filled.soup);
  EXPECT_EQ(mesh.boundary_loops().size(), 1u);
  EXPECT_NEAR(mesh.area(), 1, 1e-12);
  EXPECT_EQ(mesh.n_faces(), 72 - 6 + 4);
  for (Index f = 0; f < mesh.n_faces(); ++f) EXPECT_NEAR(mesh.face_normal(f).z(), 1, 1e-12);
  EXPECT_EQ(TriangleMesh(repair_mesh(soup, {.fill_holes_length = 1.1}).soup).boundary_loops().size(), 2u);
  EXPECT_EQ(
      TriangleMesh(repair_mesh(soup, {.fill_holes_length = 9, .fill_holes_edges = 5}).soup).boundary_loops().size(),
      2u);
}

TEST(Repair, SaysWhyNothingIsLeft) {
  const TriangleSoup soup{{{0, 0, 0}, {1, 0, 0}, {std::nan(""), 1, 0}}, {{0, 1, 2}, {0, 0, 1}}};
  try {
    repair_mesh(soup);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_input);
    EXPECT_NE(error.where().value.find("1 triangles that use a vertex twice dropped"), std::string::npos);
    EXPECT_FALSE(error.where().advice.empty());
  }
  EXPECT_THROW(repair_mesh({}), Error);
}

TEST(Repair, RefusesOptionsOutOfRange) {
  EXPECT_THROW(repair_mesh(cube(), {.fill_holes_length = -1}), Error);
  EXPECT_THROW(repair_mesh(cube(), {.fill_holes_edges = 2}), Error);
  EXPECT_THROW(repair_mesh(cube(), {.separation = std::nan("")}), Error);
}

/// Few vertices on a coarse lattice and many triangles: every defect at once.
TriangleSoup random_soup(std::mt19937_64& random) {
  TriangleSoup soup;
  const auto n = static_cast<Index>(3 + random() % 12);
  for (Index v = 0; v < n; ++v) {
    Vec3 p(static_cast<double>(random() % 4), static_cast<double>(random() % 3), static_cast<double>(random() % 2));
    if (random() % 40 == 0) p[static_cast<Index>(random() % 3)] = random() % 2 ? std::nan("") : 1e300;
    if (random() % 10 == 0) p += Vec3::Constant(1e-13);
    soup.positions.push_back(p);
  }
  for (std::uint64_t t = 1 + random() % 30; t > 0; --t) {
    const auto pick = [&] { return static_cast<Index>(random() % n); };
    soup.triangles.push_back({pick(), pick(), random() % 100 == 0 ? n + 3 : pick()});
  }
  return soup;
}

TEST(Repair, KeepsItsPromisesOnRandomSoups) {
  int repaired = 0;
  for (std::uint64_t seed = 0; seed < 5000; ++seed) {
    std::mt19937_64 random(seed);
    const TriangleSoup soup = random_soup(random);
    try {
      const RepairResult result = repair_mesh(soup);
      expect_promises(soup, result, "seed " + std::to_string(seed));
      const RepairResult filled = repair_mesh(soup, {.largest_component = true, .fill_holes_length = 10});
      EXPECT_NO_THROW(TriangleMesh(filled.soup)) << "seed " << seed;
      ++repaired;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_input) << "seed " << seed << ": " << error.what();
    }
    ASSERT_FALSE(HasFailure()) << "seed " << seed;
  }
  EXPECT_GT(repaired, 3000);
}

TEST(Repair, MendsEverySharedFileThatCanBeRead) {
  const std::filesystem::path folder = ISOPATH_SHARED_DIR;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no folder " << folder;
  const auto again = std::filesystem::path(testing::TempDir()) / "isopath_repaired.";
  for (const char* part : {"broken", "surfaces"}) {
    for (const auto& entry : std::filesystem::directory_iterator(folder / part)) {
      const std::string name = entry.path().filename().string();
      MeshFile file;
      try {
        file = read_mesh(entry.path());
      } catch (const Error&) {
        continue;  // the readers' tests look at these
      }
      const RepairResult result = repair_mesh(file.soup);
      expect_promises(file.soup, result, name);
      // What was mended stays so in a file, also in single precision.
      write_mesh(again.string() + "ply", result.soup);
      EXPECT_NO_THROW(TriangleMesh(read_mesh(again.string() + "ply").soup)) << name;
      std::string changes;
      for (const RepairChange& change : result.changes)
        changes += std::to_string(change.count) + " " + change.what + "; ";
      RecordProperty(name, changes);
    }
  }
}

}  // namespace
}  // namespace isopath
