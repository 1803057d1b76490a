#include "isopath/mesh/read_mesh.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "isopath/core/error.h"

namespace isopath {
namespace {

template <typename T>
std::string bytes(T value, bool big_endian = false) {
  std::string out(reinterpret_cast<const char*>(&value), sizeof(T));
  if (big_endian) std::reverse(out.begin(), out.end());
  return out;
}

/// A unit tetrahedron, the same in every format.
const TriangleSoup tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                               {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};

std::string binary_stl(const TriangleSoup& soup, std::string header = "test") {
  header.resize(80);
  std::string out = header + bytes(static_cast<std::uint32_t>(soup.triangles.size()));
  for (const Triangle& t : soup.triangles) {
    out += std::string(12, '\0');
    for (const Index v : t) {
      for (int k = 0; k < 3; ++k) out += bytes(static_cast<float>(soup.positions[v][k]));
    }
    out += std::string(2, '\0');
  }
  return out;
}

std::string ascii_stl(const TriangleSoup& soup) {
  std::string out = "solid test\n";
  for (const Triangle& t : soup.triangles) {
    out += "facet normal 0 0 0\n outer loop\n";
    for (const Index v : t) {
      const Vec3& p = soup.positions[v];
      out += fmt::format("  vertex {} {} {}\n", p.x(), p.y(), p.z());
    }
    out += " endloop\nendfacet\n";
  }
  return out + "endsolid test\n";
}

std::string binary_ply(const TriangleSoup& soup, bool big_endian, const std::string& newline) {
  std::string out = "ply" + newline + "format binary_" + (big_endian ? "big" : "little") + "_endian 1.0" + newline;
  out += fmt::format("comment made for a test{0}element vertex {1}{0}property uchar red{0}property double x{0}",
                     newline, soup.positions.size());
  out += fmt::format("property float y{0}property double z{0}property list uchar short tags{0}", newline);
  out += fmt::format("element stuff 2{0}property int8 a{0}element face {1}{0}", newline, soup.triangles.size());
  out += fmt::format("property list ushort uint vertex_indices{0}property float64 quality{0}end_header{0}", newline);
  for (const Vec3& p : soup.positions) {
    out += '\x0a';
    out += bytes(p.x(), big_endian) + bytes(static_cast<float>(p.y()), big_endian) + bytes(p.z(), big_endian);
    out += '\x01' + bytes(std::int16_t{-7}, big_endian);
  }
  out += "ab";
  for (const Triangle& t : soup.triangles) {
    out += bytes(std::uint16_t{3}, big_endian);
    for (const Index v : t) out += bytes(static_cast<std::uint32_t>(v), big_endian);
    out += bytes(0.5, big_endian);
  }
  return out;
}

const std::string ascii_ply =
    "ply\r\nformat ascii 1.0\r\nobj_info none\r\nelement vertex 4\r\nproperty float x\r\nproperty float y\r\n"
    "property float z\r\nproperty uchar red\r\nelement face 4\r\nproperty list uchar int vertex_index\r\n"
    "end_header\r\n0 0 0 9\r\n1 0 0 9\r\n0 1 0 9\r\n0 0 1 9\r\n3 0 2 1\r\n3 0 1 3\r\n3 1 2 3\r\n3 0 3 2\r\n";

const std::string obj =
    "# tetrahedron\nmtllib a.mtl\nv 0 0 0\nv 1 0 0 1.0\nv 0 1 0 0.5 0.5 0.5\nvn 0 0 1\nvt 0 0\nv 0 0 1\n"
    "o part\nf 1/1/1 3/1/1 2/1/1\nf 1//1 2//1 4//1\nf -3/1 -2/1 -1/1\nf 1 \\\n 4 3\n";

const std::string off =
    "# first\n\nCOFF\n4 4\n\n0 0 0 255 0 0 255\n1 0 0\n 0 1 0 # here\n0\t0\t1\n3 0 2 1 0.5 0.5 0.5\n"
    "3 0 1 3\n3 1 2 3\n3 0 3 2\n";

std::string off_binary(const TriangleSoup& soup) {
  std::string out = "OFF BINARY\n" + bytes(static_cast<std::uint32_t>(soup.positions.size())) +
                    bytes(static_cast<std::uint32_t>(soup.triangles.size())) + bytes(std::uint32_t{0});
  for (const Vec3& p : soup.positions) {
    for (int k = 0; k < 3; ++k) out += bytes(static_cast<float>(p[k]));
  }
  for (const Triangle& t : soup.triangles) {
    out += bytes(std::uint32_t{3});
    for (const Index v : t) out += bytes(v);
  }
  return out;
}

struct Sample {
  std::string name;
  std::string content;
};

std::vector<Sample> sample_files() {
  return {{"binary.stl", binary_stl(tetrahedron)},
          {"solid_binary.stl", binary_stl(tetrahedron, "solid and yet binary")},
          {"ascii.stl", ascii_stl(tetrahedron)},
          {"a.ply", ascii_ply},
          {"little.ply", binary_ply(tetrahedron, false, "\n")},
          {"big.ply", binary_ply(tetrahedron, true, "\r\n")},
          {"a.obj", obj},
          {"a.off", off},
          {"binary.off", off_binary(tetrahedron)}};
}

/// The corners of every triangle in space, which is what a file means.
std::vector<std::array<double, 9>> corners(const TriangleSoup& soup) {
  std::vector<std::array<double, 9>> out;
  for (const Triangle& t : soup.triangles) {
    auto& row = out.emplace_back();
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) row[3 * i + k] = soup.positions[t[i]][k];
    }
  }
  return out;
}

Error error_of(const std::string& content, const std::string& name) {
  try {
    read_mesh_content(content, name);
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << name << " was read";
  return {ErrorCode::internal, "no error"};
}

TEST(ReadMesh, EveryFormatGivesTheSameTetrahedron) {
  for (const auto& [name, content] : sample_files()) {
    const MeshFile file = read_mesh_content(content, name);
    EXPECT_EQ(corners(file.soup), corners(tetrahedron)) << name;
    EXPECT_EQ(file.soup.positions.size(), 4u) << name;
    EXPECT_EQ(file.vertex_of_file_vertex.size(), 4u) << name;
  }
}

TEST(ReadMesh, ContentDecidesBeforeExtension) {
  for (const auto& [name, content] : sample_files()) {
    EXPECT_EQ(read_mesh_content(content, "part.dat").soup.triangles.size(), 4u) << name;
    EXPECT_EQ(read_mesh_content(content, "part.stl").soup.triangles.size(), 4u) << name;
  }
}

TEST(ReadMesh, UnitScalesPositions) {
  const MeshFile file = read_mesh_content(obj, "a.obj", {.unit_mm = 25.4});
  EXPECT_EQ(file.soup.positions[1], Vec3(25.4, 0, 0));
  EXPECT_THROW(read_mesh_content(obj, "a.obj", {.unit_mm = 0}), Error);
  EXPECT_THROW(read_mesh_content(obj, "a.obj", {.unit_mm = std::nan("")}), Error);
}

TEST(ReadMesh, WeldsOnRequestAndMapsFileVertices) {
  const std::string doubled = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv -0 1 0\nf 1 2 3\nf 4 5 6\n";
  const MeshFile welded = read_mesh_content(doubled, "a.obj");
  EXPECT_EQ(welded.soup.positions.size(), 4u);
  EXPECT_EQ(welded.vertex_of_file_vertex, (std::vector<Index>{0, 1, 2, 1, 3, 2}));
  EXPECT_EQ(welded.soup.triangles[1], (Triangle{1, 3, 2}));
  EXPECT_EQ(welded.notes.size(), 1u);
  const MeshFile apart = read_mesh_content(doubled, "a.obj", {.weld = false});
  EXPECT_EQ(apart.soup.positions.size(), 6u);
  EXPECT_EQ(apart.soup.triangles[1], (Triangle{3, 4, 5}));
  EXPECT_TRUE(apart.notes.empty());
}

TEST(ReadMesh, SplitsPolygonsIntoFans) {
  const MeshFile file = read_mesh_content("v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\n", "a.obj");
  EXPECT_EQ(file.soup.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
  ASSERT_EQ(file.notes.size(), 1u);
  EXPECT_NE(file.notes[0].find("1 polygons"), std::string::npos);
}

TEST(ReadMesh, KeepsDoublePrecision) {
  const MeshFile file = read_mesh_content("v 0.1 1e38 -1e-300\nv 1e400 nan -inf\nv 1e-400 +1 0\nf 1 2 3\n", "a.obj");
  EXPECT_EQ(file.soup.positions[0], Vec3(0.1, 1e38, -1e-300));
  EXPECT_EQ(file.soup.positions[1].x(), infinity);
  EXPECT_TRUE(std::isnan(file.soup.positions[1].y()));
  EXPECT_EQ(file.soup.positions[1].z(), -infinity);
  EXPECT_EQ(file.soup.positions[2], Vec3(0, 1, 0));
}

TEST(ReadMesh, ToleratesTrailingBytesWithANote) {
  for (const std::string& header : {std::string("test"), std::string("solid x")}) {
    const MeshFile file = read_mesh_content(binary_stl(tetrahedron, header) + "garbage", "a.stl");
    EXPECT_EQ(file.soup.triangles.size(), 4u);
    ASSERT_EQ(file.notes.size(), 1u);
    EXPECT_NE(file.notes[0].find("7 bytes"), std::string::npos);
  }
}

TEST(ReadMesh, JoinsSolidsAlsoEmptyOnes) {
  const MeshFile file =
      read_mesh_content("solid e\nendsolid e\n" + ascii_stl(tetrahedron) + "SOLID\nENDSOLID\n", "a.stl");
  EXPECT_EQ(corners(file.soup), corners(tetrahedron));
  EXPECT_EQ(file.notes.size(), 1u);
}

struct Malformed {
  const char* name;
  std::string content;
  std::string element;
  const char* summary;
};
void PrintTo(const Malformed& malformed, std::ostream* out) { *out << malformed.name; }

class MalformedInput : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedInput, IsRefusedWithPlaceAndAdvice) {
  const Error error = error_of(GetParam().content, GetParam().name);
  EXPECT_EQ(error.code(), ErrorCode::bad_input);
  EXPECT_EQ(error.where().file, GetParam().name);
  EXPECT_EQ(error.where().element, GetParam().element) << error.what();
  EXPECT_NE(error.summary().find(GetParam().summary), std::string::npos) << error.what();
  EXPECT_FALSE(error.where().advice.empty());
}

const std::string ply_start =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n";
const std::string ply_binary_start =
    "ply\nformat binary_little_endian 1.0\nelement vertex 900000\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

// Each face has 22 bytes: 30 less end in the last number of the last face but one.
const std::string cut_ply = [] {
  const std::string whole = binary_ply(tetrahedron, true, "\n");
  return whole.substr(0, whole.size() - 30);
}();

INSTANTIATE_TEST_SUITE_P(
    Table, MalformedInput,
    testing::Values(
        Malformed{"empty.stl", "", "byte 0", "empty"}, Malformed{"a.xyz", "hello", "byte 0", "unknown mesh format"},
        Malformed{"a.step", "ISO-10303-21;", "format .step", "STEP"},
        Malformed{"wide.obj", std::string("\xff\xfe#\0", 4), "byte 0", "UTF-16"},
        Malformed{"cut.stl", binary_stl(tetrahedron).substr(0, 240), "triangle 3, byte 234", "ends before"},
        Malformed{"short.stl", "abc", "byte 3", "shorter than its header"},
        Malformed{"none.stl", "solid a\nendsolid a\n", "byte 19", "no triangles"},
        Malformed{"word.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 blah\n", "line 4", "not a number"},
        Malformed{"loop.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\n", "line 5", "'vertex'"},
        Malformed{"junk.stl", ascii_stl(tetrahedron) + "\nend\n", "line 32", "expected"},
        Malformed{"a.obj", "v 0 0\n", "line 1", "missing"}, Malformed{"b.obj", "v 0 0 1x\n", "line 1", "not a number"},
        Malformed{"c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "line 4", "does not exist"},
        Malformed{"d.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 0\n", "line 5", "does not exist"},
        Malformed{"e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 2 1\n", "line 4", "does not exist"},
        Malformed{"f.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "line 3", "three corners"},
        Malformed{"g.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 x/1\n", "line 4", "whole number"},
        Malformed{"h.obj", "v 0 0 0\n", "byte 8", "no triangles"},
        Malformed{"a.off", "OFF\n900000000000 1 0\n0 0 0\n", "line 2", "announces more"},
        Malformed{"b.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "line 6", "out of range"},
        Malformed{"c.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 -1 2\n", "line 6", "out of range"},
        Malformed{"d.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 zero\n3 0 1 2\n", "line 5", "not a number"},
        Malformed{"e.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0.000000\n", "line 5", "ends before face 0"},
        Malformed{"f.off", "OFF\n-3 1 0\n", "line 2", "negative"}, Malformed{"g.off", "3 1 0\n", "line 1", "OFF"},
        Malformed{"h.off", "4OFF\n3 1 0\n", "line 1", "three dimensions"},
        Malformed{"i.off", off_binary(tetrahedron).substr(0, 80), "byte 11", "announces more"},
        Malformed{"a.ply", "ply\nformat ascii 1.0\nend_header\n", "PLY header", "'vertex'"},
        Malformed{"b.ply", ply_start + "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "line 11", "missing"},
        Malformed{"c.ply", ply_start + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "line 13", "out of range"},
        Malformed{"d.ply", ply_start + "0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "line 13", "three corners"},
        Malformed{"e.ply", ply_start + "0 0 0\n1 0 0\n0 1 0\n3 0 1.5 2\n", "line 13", "whole number"},
        Malformed{"f.ply", ply_binary_start + "0123", "line 3", "announces more"},
        Malformed{"g.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty quux x\n", "line 4", "unknown PLY type"},
        Malformed{"h.ply", "ply\nformat binary_middle_endian 1.0\n", "line 2", "encoding"},
        Malformed{"i.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", "line 3", "end_header"},
        Malformed{"j.ply", cut_ply, fmt::format("face 2, byte {}", cut_ply.size()), "ends inside"}));

TEST(ReadMesh, MissingFileIsNamed) {
  try {
    read_mesh("no/such/file.stl");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.where().file, "no/such/file.stl");
  }
}

/// Truncates, flips, removes and doubles bytes: the reader returns or throws Error, nothing else.
TEST(ReadMesh, SurvivesMutatedFiles) {
  const auto all = sample_files();
  for (std::uint64_t seed = 0; seed < 1000 * all.size(); ++seed) {
    std::mt19937_64 random(seed);
    auto [name, content] = all[seed % all.size()];
    const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    for (std::size_t edits = 1 + pick(4); edits > 0 && !content.empty(); --edits) {
      const std::size_t at = pick(content.size());
      switch (pick(5)) {
        case 0:
          content.resize(at);
          break;
        case 1:
          content[at] = static_cast<char>(content[at] ^ (1 << pick(8)));
          break;
        case 2:
          content[at] = static_cast<char>(random());
          break;
        case 3:
          content.erase(at, pick(8));
          break;
        default:
          content.insert(at, content.substr(pick(content.size()), pick(12)));
      }
    }
    try {
      const MeshFile file = read_mesh_content(content, name);
      const auto n = static_cast<Index>(file.soup.positions.size());
      for (const Triangle& t : file.soup.triangles) {
        for (const Index v : t) ASSERT_TRUE(v >= 0 && v < n) << "seed " << seed;
      }
    } catch (const Error& error) {
      EXPECT_FALSE(error.where().element.empty()) << "seed " << seed << ": " << error.what();
    } catch (const std::exception& error) {
      FAIL() << "seed " << seed << " " << name << ": " << error.what();
    }
  }
}

TEST(ReadMesh, SharedFilesAreReadOrRefusedWithAdvice) {
  const std::filesystem::path folder = ISOPATH_SHARED_DIR;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no folder " << folder;
  for (const char* part : {"broken", "surfaces"}) {
    for (const auto& entry : std::filesystem::directory_iterator(folder / part)) {
      try {
        const MeshFile file = read_mesh(entry.path());
        EXPECT_FALSE(file.soup.triangles.empty());
      } catch (const Error& error) {
        EXPECT_STREQ(part, "broken") << error.what();
        EXPECT_EQ(error.where().file, entry.path().string());
        EXPECT_FALSE(error.where().element.empty()) << error.what();
        EXPECT_FALSE(error.where().advice.empty()) << error.what();
        RecordProperty(entry.path().filename().string(), error.what());
      }
    }
  }
}

}  // namespace
}  // namespace isopath
