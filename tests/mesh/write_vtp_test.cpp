#include "isopath/mesh/write_vtp.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "isopath/core/error.h"

namespace isopath {
namespace {

/// The numbers of the n-th DataArray whose tag holds `tag`, inside the section.
std::vector<double> numbers(const std::string& xml, const std::string& section, const std::string& tag) {
  const std::size_t from = xml.find("<" + section);
  const std::size_t array = xml.find(tag, from);
  EXPECT_NE(array, std::string::npos) << section << " " << tag;
  EXPECT_LT(array, xml.find("</" + section)) << section << " " << tag;
  const std::size_t begin = xml.find('>', array) + 1;
  std::istringstream in(xml.substr(begin, xml.find('<', begin) - begin));
  std::vector<double> out;
  for (double value = 0; in >> value;) out.push_back(value);
  return out;
}

const VtpData sample{{{0, 0, 0}, {1, 0, 0}, {0.1, 1, 0}, {0, 0, 1.0 / 3}},
                     {{0, 1, 2, 0}, {2, 3}},
                     {{0, 1, 2}},
                     {{"distance", {0, 1, 2, 1e-17}}},
                     {{"kind", {1, 2, 3}}, {"a<b & \"c\"", {4, 5, 6}}}};

TEST(WriteVtp, HoldsPointsCellsAndArrays) {
  const std::string xml = vtp_content(sample);
  EXPECT_NE(xml.find("NumberOfPoints=\"4\""), std::string::npos);
  EXPECT_NE(xml.find("NumberOfLines=\"2\""), std::string::npos);
  EXPECT_NE(xml.find("NumberOfPolys=\"1\""), std::string::npos);
  EXPECT_EQ(numbers(xml, "Points", "DataArray"), (std::vector<double>{0, 0, 0, 1, 0, 0, 0.1, 1, 0, 0, 0, 1.0 / 3}));
  EXPECT_EQ(numbers(xml, "Lines", "\"connectivity\""), (std::vector<double>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(numbers(xml, "Lines", "\"offsets\""), (std::vector<double>{4, 6}));
  EXPECT_EQ(numbers(xml, "Polys", "\"connectivity\""), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(numbers(xml, "Polys", "\"offsets\""), (std::vector<double>{3}));
  EXPECT_EQ(numbers(xml, "PointData", "Name=\"distance\""), (std::vector<double>{0, 1, 2, 1e-17}));
  EXPECT_EQ(numbers(xml, "CellData", "Name=\"kind\""), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(numbers(xml, "CellData", "Name=\"a&lt;b &amp; &quot;c&quot;\""), (std::vector<double>{4, 5, 6}));
}

TEST(WriteVtp, RefusesDataThatDoesNotFit) {
  const auto with = [](auto change) {
    VtpData data = sample;
    change(data);
    return data;
  };
  EXPECT_THROW(vtp_content(with([](VtpData& d) { d.point_arrays[0].values.pop_back(); })), Error);
  EXPECT_THROW(vtp_content(with([](VtpData& d) { d.cell_arrays[0].values.push_back(1); })), Error);
  EXPECT_THROW(vtp_content(with([](VtpData& d) { d.lines[0][1] = 4; })), Error);
  EXPECT_THROW(vtp_content(with([](VtpData& d) { d.lines[1] = {1}; })), Error);
  EXPECT_THROW(vtp_content(with([](VtpData& d) { d.triangles[0][2] = -1; })), Error);
}

}  // namespace
}  // namespace isopath
