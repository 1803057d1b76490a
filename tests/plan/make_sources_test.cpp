#include "isopath/plan/make_sources.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

std::vector<Index> identity(const TriangleMesh& mesh) {
  std::vector<Index> map(mesh.n_vertices());
  std::iota(map.begin(), map.end(), 0);
  return map;
}

SourceSet sources_of(const TriangleMesh& mesh, const std::vector<std::string>& texts) {
  std::vector<SourceSpec> specs;
  for (const std::string& text : texts) specs.push_back(parse_source_spec(text));
  return make_sources(mesh, specs, identity(mesh));
}

double segment_length(const TriangleMesh& mesh, const SourceSet& sources) {
  double sum = 0;
  for (const SourceElement& element : sources.elements()) {
    sum += (position_of(mesh, element.a) - position_of(mesh, element.b)).norm();
  }
  return sum;
}

/// Expects an Error(bad_usage) whose message holds all the parts.
void expect_refused(const TriangleMesh& mesh, const std::string& text, const std::vector<const char*>& parts) {
  try {
    sources_of(mesh, {text});
    ADD_FAILURE() << text << " was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_usage) << error.what();
    EXPECT_NE(std::string(error.what()).find("source '" + text), std::string::npos) << error.what();
    for (const char* part : parts) EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(MakeSources, BoundaryIsAllLoopsOrOne) {
  const TriangleMesh mesh = test::open_cylinder(12, 4, 5, 8);
  const double ring = 12 * 2 * 5 * std::sin(std::numbers::pi / 12);
  EXPECT_NEAR(segment_length(mesh, sources_of(mesh, {"boundary"})), 2 * ring, 1e-9);
  EXPECT_NEAR(segment_length(mesh, sources_of(mesh, {"boundary:1"})), ring, 1e-9);
  EXPECT_NEAR(segment_length(mesh, sources_of(mesh, {"boundary:0", "boundary:1"})), 2 * ring, 1e-9);
  EXPECT_NEAR(segment_length(mesh, sources_of(mesh, {"auto"})), 2 * ring, 1e-9);
  expect_refused(mesh, "boundary:2", {"loop 2 of 2", "0 to 1"});
  expect_refused(test::cube(2, 1), "boundary", {"closed"});
}

TEST(MakeSources, AutoIsTheLongestLoopOfEveryComponentOnRequest) {
  const TriangleMesh tube = test::open_cylinder(12, 4, 5, 8);
  const TriangleMesh cube = test::cube(2, 1);
  TriangleSoup soup = tube.soup();
  const TriangleSoup other = cube.soup();
  for (const Vec3& p : other.positions) soup.positions.push_back(p + Vec3(50, 0, 0));
  const Index first = tube.n_vertices();
  for (const Triangle& t : other.triangles) soup.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  for (Vec3& p : soup.positions) {
    if (p.x() < 40 && p.z() < 1e-9) p *= 1.5;  // the lower loop becomes the longer one
  }
  const TriangleMesh mesh = TriangleMesh(soup);
  const SourceSet sources =
      make_sources(mesh, std::vector{SourceSpec{}}, identity(mesh), Progress::none(), AutoLoops::longest);
  EXPECT_NEAR(segment_length(mesh, sources), 12 * 2 * 7.5 * std::sin(std::numbers::pi / 12), 1e-9);
  EXPECT_TRUE(std::any_of(sources.elements().begin(), sources.elements().end(), [&](const SourceElement& e) {
    return position_of(mesh, e.a).x() > 40;  // a closed component keeps its vertex
  }));
}

TEST(MakeSources, VerticesAreThoseOfTheFile) {
  const TriangleMesh mesh = test::planar_grid(3, 3, 3, 3);
  const std::vector<SourceSpec> specs = {parse_source_spec("vertex:1,0")};
  const std::vector<Index> map = {7, 5, no_index};
  const SourceSet sources = make_sources(mesh, specs, map);
  ASSERT_EQ(sources.elements().size(), 2u);
  EXPECT_EQ(position_of(mesh, sources.elements()[0].a), mesh.position(5));
  EXPECT_EQ(position_of(mesh, sources.elements()[1].a), mesh.position(7));
  EXPECT_THROW(make_sources(mesh, std::vector{parse_source_spec("vertex:2")}, map), Error);
  expect_refused(mesh, "vertex:16", {"vertex 16 of 16", "0 to 15"});
}

TEST(MakeSources, PointsGoToTheNearestPlaceOnTheSurface) {
  const TriangleMesh mesh = test::planar_grid(3, 3, 3, 3);
  const SourceSet sources = sources_of(mesh, {"point:1.3,2.2,9"});
  ASSERT_EQ(sources.elements().size(), 1u);
  EXPECT_NEAR((position_of(mesh, sources.elements()[0].a) - Vec3(1.3, 2.2, 0)).norm(), 0, 1e-12);
}

TEST(MakeSources, APlaneCutsWhereItsEquationHolds) {
  const TriangleMesh mesh = test::planar_grid(7, 5, 7, 5);
  for (const char* text : {"plane:1,0,0,2.5", "plane:-2,0,0,-5"}) {
    const SourceSet sources = sources_of(mesh, {text});
    EXPECT_NEAR(segment_length(mesh, sources), 5, 1e-9) << text;
    for (const auto& element : sources.elements()) EXPECT_NEAR(position_of(mesh, element.a).x(), 2.5, 1e-9);
  }
  expect_refused(mesh, "plane:1,0,0,8", {"D = 8", "0 and 7"});
}

TEST(MakeSources, APlaneThatOnlyTouchesThePartGivesWhatLiesInIt) {
  const TriangleMesh mesh = test::planar_grid(7, 5, 7, 5);
  for (const double x : {0.0, 7.0}) {
    const SourceSet sources = sources_of(mesh, {fmt::format("plane:1,0,0,{}", x).c_str()});
    EXPECT_NEAR(segment_length(mesh, sources), 5, 1e-9);
    for (const auto& element : sources.elements()) EXPECT_EQ(position_of(mesh, element.a).x(), x);
  }
  const SourceSet corner = sources_of(mesh, {"plane:1,1,0,12"});
  ASSERT_EQ(corner.elements().size(), 1u);
  EXPECT_EQ(position_of(mesh, corner.elements()[0].a), Vec3(7, 5, 0));
}

TEST(MakeSources, FeatureEdgesOfACubeAreItsTwelveEdges) {
  const TriangleMesh mesh = test::cube(3, 2);
  EXPECT_NEAR(segment_length(mesh, sources_of(mesh, {"edges:80"})), 12 * 2, 1e-9);
  const auto chains = feature_chains(mesh, 1.4);
  EXPECT_EQ(chains.size(), 12u);
  for (const auto& chain : chains) {
    for (std::size_t i = 1; i < chain.size(); ++i) EXPECT_EQ(mesh.to(chain[i - 1]), mesh.from(chain[i]));
  }
  expect_refused(mesh, "edges:95", {"95 degrees", "smaller"});
}

TEST(MakeSources, TheRimOfAPyramidIsOneClosedChain) {
  const TriangleMesh mesh = test::closed_pyramid(16, 5, 1);
  // The base meets the sides at 180° - atan(1/5) or so, the sides meet each other at a few degrees.
  const auto chains = feature_chains(mesh, 2);
  ASSERT_EQ(chains.size(), 1u);
  EXPECT_EQ(chains[0].size(), 16u);
  EXPECT_EQ(mesh.to(chains[0].back()), mesh.from(chains[0].front()));
}

TEST(MakeSources, AutomaticTakesTheFarEndOfAClosedPart) {
  const TriangleMesh mesh = test::moved(test::cube(2, 1), Vec3::UnitZ(), 0, Vec3(4, 5, 6));
  const SourceSet sources = sources_of(mesh, {"auto"});
  ASSERT_EQ(sources.elements().size(), 1u);
  EXPECT_EQ(position_of(mesh, sources.elements()[0].a).x(), 5);
}

class Polyline : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  void write(const std::string& text) const { write_file_atomically(path_, text); }
  const std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / ("isopath_line_" + std::to_string(::getpid()) + ".csv");
};

TEST_F(Polyline, ItsPointsAreJoinedAlongTheSurface) {
  const TriangleMesh mesh = test::cube(5, 10);
  write("x,y,z\n# from the top over an edge to a side\n2,3,12\r\n\n13;3;6\n13 7 6\n");
  const SourceSet sources = sources_of(mesh, {"polyline:" + path_.string()});
  // Over the edge the shortest way unfolds to a straight line of 8 + 4; then 4 along the side.
  EXPECT_NEAR(segment_length(mesh, sources), 8 + 4 + 4, 1e-9);
  for (const SourceElement& element : sources.elements()) EXPECT_EQ(element.a.face, element.b.face);
}

TEST_F(Polyline, BadLinesAreNamed) {
  write("x,y,z\n1,2,3\n1,2\n");
  try {
    read_polyline(path_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_input);
    EXPECT_EQ(error.where().file, path_.string());
    EXPECT_EQ(error.where().element, "line 3");
    EXPECT_EQ(error.where().value, "'1,2'");
  }
  write("x,y,z\n");
  EXPECT_THROW(read_polyline(path_), Error);
  write("1,2,3,4\n1,2,3\n");
  EXPECT_EQ(read_polyline(path_).size(), 1u) << "the first line may be a heading";
}

}  // namespace
}  // namespace isopath
