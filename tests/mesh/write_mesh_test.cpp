#include "isopath/mesh/write_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"
#include "isopath/mesh/read_mesh.h"

namespace isopath {
namespace {

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / ("isopath_write_mesh_" + name);
}

TriangleSoup random_soup(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TriangleSoup soup;
  for (int v = 0; v < 20; ++v) {
    const double scale = std::pow(10.0, normal(random) * 6);
    soup.positions.emplace_back(scale * normal(random), scale * normal(random), scale * normal(random));
  }
  for (int t = 0; t < 30; ++t) {
    soup.triangles.push_back(
        {static_cast<Index>(random() % 20), static_cast<Index>(random() % 20), static_cast<Index>(random() % 20)});
  }
  return soup;
}

TEST(WriteMesh, IndexedFormatsComeBackBitForBit) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const TriangleSoup soup = random_soup(seed);
    for (const char* name : {"a.obj", "a.off", "a.ply", "A.PLY"}) {
      write_mesh(temporary(name), soup);
      const MeshFile back = read_mesh(temporary(name), {.weld = false});
      EXPECT_EQ(back.soup.positions, soup.positions) << name << " seed " << seed;
      EXPECT_EQ(back.soup.triangles, soup.triangles) << name << " seed " << seed;
      EXPECT_TRUE(back.notes.empty()) << name;
    }
  }
}

TEST(WriteMesh, StlComesBackInSinglePrecision) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const TriangleSoup soup = random_soup(seed);
    write_mesh(temporary("a.stl"), soup);
    const MeshFile back = read_mesh(temporary("a.stl"));
    ASSERT_EQ(back.soup.triangles.size(), soup.triangles.size());
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
      for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) {
          const auto expected = static_cast<float>(soup.positions[soup.triangles[t][i]][k]);
          EXPECT_EQ(back.soup.positions[back.soup.triangles[t][i]][k], expected) << "seed " << seed;
        }
      }
    }
  }
}

TEST(WriteMesh, KeepsNumbersThatAreNone) {
  const TriangleSoup soup{{{infinity, -infinity, 0}, {1e300, -0.0, 5e-324}, {0, 1, 0}}, {{0, 1, 2}}};
  for (const char* name : {"b.obj", "b.off", "b.ply"}) {
    write_mesh(temporary(name), soup);
    EXPECT_EQ(read_mesh(temporary(name)).soup.positions, soup.positions) << name;
  }
  EXPECT_THROW(write_mesh(temporary("b.stl"), soup), Error);
}

TEST(WriteMesh, PlyCarriesTheDistance) {
  const TriangleSoup soup = random_soup(7);
  std::vector<double> distance(soup.positions.size());
  for (std::size_t v = 0; v < distance.size(); ++v) distance[v] = 1.0 / (1.0 + static_cast<double>(v));
  write_mesh(temporary("d.ply"), soup, {.distance = distance});
  const std::string content = read_whole_file(temporary("d.ply"));
  EXPECT_NE(content.find("property double z\nproperty double distance\n"), std::string::npos);
  EXPECT_EQ(read_mesh(temporary("d.ply"), {.weld = false}).soup.positions, soup.positions);
  // The vertex rows are four doubles: the fourth is the distance.
  const std::size_t begin = content.find("end_header\n") + 11;
  for (std::size_t v = 0; v < distance.size(); ++v) {
    double value = 0;
    content.copy(reinterpret_cast<char*>(&value), sizeof value, begin + 32 * v + 24);
    EXPECT_EQ(value, distance[v]);
  }
}

TEST(WriteMesh, RefusesWhatItCannotWrite) {
  const TriangleSoup soup = random_soup(1);
  const auto code_of = [&](const char* name, std::vector<double> distance) {
    try {
      write_mesh(temporary(name), soup, {.distance = distance});
    } catch (const Error& error) {
      EXPECT_FALSE(error.where().advice.empty());
      return error.code();
    }
    return ErrorCode::internal;
  };
  EXPECT_EQ(code_of("a.txt", {}), ErrorCode::bad_usage);
  EXPECT_EQ(code_of("a.ply", {1, 2}), ErrorCode::bad_usage);
  EXPECT_EQ(code_of("a.stl", std::vector<double>(20)), ErrorCode::bad_usage);
}

}  // namespace
}  // namespace isopath
