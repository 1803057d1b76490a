#include "isopath/post/csv.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "post/test_paths.h"

namespace isopath {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Csv, ToolPathComesBackBitForBit) {
  for (const ImpactCurve& curve : {test::cylinder_helix(), test::sphere_spiral(), test::wavy_zigzag()}) {
    const ToolPath path = test::full_path(curve);
    const ToolPath back = read_tool_csv(tool_csv(path));
    ASSERT_EQ(back.points.size(), path.points.size());
    for (std::size_t i = 0; i < path.points.size(); ++i) {
      const ToolPoint& a = path.points[i];
      const ToolPoint& b = back.points[i];
      EXPECT_EQ(a.tip, b.tip);
      EXPECT_EQ(a.axis, b.axis);
      EXPECT_EQ(a.tangent, b.tangent);
      EXPECT_EQ(a.feed_mm_per_min, b.feed_mm_per_min);
      EXPECT_EQ(a.time, b.time);
      EXPECT_EQ(a.kind, b.kind);
      EXPECT_EQ(a.piece, b.piece);
    }
  }
}

TEST(Csv, ImpactArcLengthGrowsToTheLengthOfAllMoves) {
  const ImpactCurve curve = test::cylinder_helix();
  const std::vector<std::string> lines = lines_of(impact_csv(curve));
  ASSERT_EQ(lines.size(), curve.points.size() + 1);
  EXPECT_EQ(lines[0], "index,piece,kind,x,y,z,nx,ny,nz,s");
  const double last = std::stod(lines.back().substr(lines.back().rfind(',') + 1));
  EXPECT_NEAR(last,
              length_of(curve, MoveKind::cover) + length_of(curve, MoveKind::link) + length_of(curve, MoveKind::lift),
              1e-9);
  EXPECT_EQ(lines[1].substr(lines[1].rfind(',') + 1), "0");
}

TEST(Csv, WindowsLineEndsAndBlankLinesAreRead) {
  const ToolPath path = read_tool_csv(
      "index,piece,kind,x,y,z,i,j,k,feed,t\r\n\r\n0,0,cover, 1,2,3,0,0,1,0,0\r\n1,0,link,2,2,3,0,1,0,60,1");
  ASSERT_EQ(path.points.size(), 2U);
  EXPECT_EQ(path.points[1].tip, Vec3(2, 2, 3));
  EXPECT_EQ(path.points[1].kind, MoveKind::link);
}

TEST(Csv, EveryFaultNamesItsLine) {
  const std::string head = "index,piece,kind,x,y,z,i,j,k,feed,t\n0,1,cover,1,2,3,0,0,1,60,5\n";
  const std::pair<std::string, std::string> faults[] = {
      {"1,1,cover,1,2,3,0,0,1,60", "number of fields"},
      {"1,1,cover,1,2,3,0,0,1,60,6,7", "number of fields"},
      {"1,1,cover,1,2,x,0,0,1,60,6", "not a number"},
      {"1,1,cover,1,2,nan,0,0,1,60,6", "not a number"},
      {"1,1,cover,1,2,3mm,0,0,1,60,6", "not a number"},
      {"1,1,cover,1,2,,0,0,1,60,6", "not a number"},
      {"1,1,cover,1,2,3,0,0,2,60,6", "not a unit vector"},
      {"1,1,drill,1,2,3,0,0,1,60,6", "kind"},
      {"1,1,cover,1,2,3,0,0,1,0,6", "feed"},
      {"1,1,cover,1,2,3,0,0,1,60,4", "time"},
      {"1,0,cover,1,2,3,0,0,1,60,6", "pieces"},
      {"1,1,cover,1,2,1e999,0,0,1,60,6", "not a number"},
      {"1,99999999999,cover,1,2,3,0,0,1,60,6", "a number"},
  };
  for (const auto& [line, what] : faults) {
    SCOPED_TRACE(line);
    try {
      read_tool_csv(head + line + "\n");
      ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_input);
      EXPECT_EQ(error.where().element, "line 3");
      EXPECT_NE(error.summary().find(what), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(read_tool_csv(""), Error);
  EXPECT_THROW(read_tool_csv("index,piece,kind\n"), Error);
}

}  // namespace
}  // namespace isopath
