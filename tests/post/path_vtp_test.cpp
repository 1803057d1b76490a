#include "isopath/post/path_vtp.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "post/test_paths.h"

namespace isopath {
namespace {

// The numbers of the first array of this name in the part of the file between two tags.
std::vector<double> numbers(const std::string& text, const std::string& part, const std::string& name) {
  const std::size_t begin = text.find("<" + part);
  const std::size_t end = text.find("</" + part + ">");
  const std::size_t array = text.find("Name=\"" + name + "\"", begin);
  EXPECT_LT(array, end) << part << " " << name;
  if (!(array < end)) return {};
  const std::size_t first = text.find('>', array) + 1;
  std::istringstream stream(text.substr(first, text.find('<', first) - first));
  std::vector<double> values;
  for (double value = 0; stream >> value;) values.push_back(value);
  return values;
}

TEST(PathVtp, LinesOfOneKindAndPieceCoverEveryMoveOnce) {
  const ToolPath path = test::full_path(test::wavy_zigzag());
  const std::string text = path_vtp(path);
  const std::vector<double> connectivity = numbers(text, "Lines", "connectivity");
  const std::vector<double> offsets = numbers(text, "Lines", "offsets");
  const std::vector<double> kinds = numbers(text, "CellData", "kind");
  const std::vector<double> pieces = numbers(text, "CellData", "piece");
  ASSERT_EQ(offsets.size(), kinds.size());
  ASSERT_EQ(offsets.size(), pieces.size());
  std::size_t next = 1;  // the move that must come now
  std::size_t begin = 0;
  for (std::size_t line = 0; line < offsets.size(); ++line) {
    const auto end = std::size_t(offsets[line]);
    ASSERT_GE(end, begin + 2);
    for (std::size_t k = begin + 1; k < end; ++k, ++next) {
      EXPECT_EQ(connectivity[k], double(next));
      EXPECT_EQ(connectivity[k - 1], double(next - 1));
      EXPECT_EQ(kinds[line], double(path.points[next].kind));
      EXPECT_EQ(pieces[line], double(path.points[next].piece));
    }
    begin = end;
  }
  EXPECT_EQ(next, path.points.size());
}

TEST(PathVtp, ALineEndsWithItsPiece) {
  ToolPath path;
  for (const Index piece : {0, 0, 1, 1}) {
    path.points.emplace_back();
    path.points.back().piece = piece;
  }
  EXPECT_EQ(numbers(path_vtp(path), "CellData", "piece"), std::vector<double>({0, 1}));
}

TEST(PathVtp, ArraysCarryThePath) {
  const ToolPath path = test::full_path(test::cylinder_helix());
  const std::string text = path_vtp(path);
  const std::vector<double> s = numbers(text, "PointData", "s");
  const std::vector<double> t = numbers(text, "PointData", "t");
  const std::vector<double> feed = numbers(text, "PointData", "feed");
  const std::vector<double> k = numbers(text, "PointData", "k");
  ASSERT_EQ(s.size(), path.points.size());
  for (std::size_t i = 0; i < s.size(); ++i) {
    EXPECT_EQ(t[i], path.points[i].time);
    EXPECT_EQ(feed[i], path.points[i].feed_mm_per_min);
    EXPECT_EQ(k[i], path.points[i].axis.z());
    if (i > 0) {
      EXPECT_NEAR(s[i] - s[i - 1], (path.points[i].tip - path.points[i - 1].tip).norm(), 1e-9);
    }
  }
}

TEST(PathVtp, PathsOfNoMoveAreFilesToo) {
  EXPECT_NE(path_vtp({}).find("</VTKFile>"), std::string::npos);
  ToolPath one;
  one.points.emplace_back();
  EXPECT_NE(path_vtp(one).find("</VTKFile>"), std::string::npos);
}

}  // namespace
}  // namespace isopath
