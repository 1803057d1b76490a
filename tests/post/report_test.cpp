#include "isopath/post/report.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/post/base64.h"
#include "post/occurrences.h"

namespace isopath {
namespace {

TriangleMesh triangle() {
  TriangleSoup soup;
  soup.positions = {{1e6, 0, 0}, {1e6 + 1, 0, 0}, {1e6, 1, 0}};
  soup.triangles = {{0, 1, 2}};
  return TriangleMesh(soup);
}

/// Content of the script element with this id.
std::string block(const std::string& html, const std::string& id) {
  const std::size_t open = html.find("id=\"" + id + "\">");
  if (open == std::string::npos) return "absent";
  const std::size_t begin = html.find('>', open) + 1;
  return html.substr(begin, html.find("</script>", begin) - begin);
}

TEST(Base64, WordsAreLittleEndian) {
  // Base64 of the bytes 04 03 02 01, and of 00 00 80 3f (1.0f), by RFC 4648.
  const std::vector<std::uint32_t> words = {0x01020304u};
  EXPECT_EQ(base64_of(std::span<const std::uint32_t>(words)), "BAMCAQ==");
  const std::vector<float> floats = {1.0f};
  EXPECT_EQ(base64_of(std::span<const float>(floats)), "AACAPw==");
}

TEST(Base64, PaddingFollowsTheLength) {
  for (std::size_t n = 0; n < 7; ++n) {
    const std::vector<std::uint32_t> words(n, 0xffffffffu);
    const std::string text = base64_of(std::span<const std::uint32_t>(words));
    EXPECT_EQ(text.size(), (4 * n + 2) / 3 * 4);
    EXPECT_EQ(test::occurrences(text, "="), (3 - 4 * n % 3) % 3);
  }
}

TEST(Report, NeedsAMesh) { EXPECT_THROW(report_html({.title = "none"}), Error); }

TEST(Report, RefusesAScalarOfAnotherLength) {
  const TriangleMesh mesh = triangle();
  ReportData data{.title = "part", .mesh = &mesh};
  data.scalars.push_back({.name = "gap", .unit = "mm", .values = {1, 2}});
  try {
    report_html(data);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_usage);
    EXPECT_EQ(error.where().element, "scalar gap");
  }
}

TEST(Report, TextOfOthersStaysText) {
  const TriangleMesh mesh = triangle();
  ReportData data{.title = "</title><script>alert(1)</script>", .mesh = &mesh};
  data.scalars.push_back({.name = "</script><b>", .unit = "\"", .values = {1, 2, infinity}});
  data.tables.push_back({"<i>", {{"<i>", "<i>", "<i>", "<i>"}}});
  data.warnings.push_back("<i>");
  const std::string html = report_html(data);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_EQ(html.find("<b>"), std::string::npos);
  EXPECT_EQ(html.find("<i>"), std::string::npos);
  // Title and heading, five places of the table and the warning.
  EXPECT_EQ(test::occurrences(html, "&lt;i&gt;"), 6u);
  EXPECT_NE(block(html, "meta").find("\\u003c/script>"), std::string::npos);
}

TEST(Report, EveryPlaceOfThePageIsFilled) {
  const TriangleMesh mesh = triangle();
  const std::string html = report_html({.title = "part", .mesh = &mesh});
  const std::size_t script = html.rfind("<script>");
  EXPECT_EQ(test::occurrences(html.substr(0, html.find("<style>")), "{{"), 0u);
  EXPECT_EQ(test::occurrences(html.substr(html.find("</style>"), script - html.find("</style>")), "{{"), 0u);
  EXPECT_EQ(test::occurrences(html.substr(script), "</script>"), 1u) << "the viewer's own script must not end early";
}

TEST(Report, RefersToNothingOutside) {
  const TriangleMesh mesh = triangle();
  const std::string html = report_html({.title = "part", .mesh = &mesh});
  const std::string page = html.substr(0, html.rfind("<script>"));
  EXPECT_EQ(page.find("http://"), std::string::npos);
  EXPECT_EQ(page.find("https://"), std::string::npos);
  EXPECT_EQ(page.find(" src="), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
}

TEST(Report, CoordinatesAreRelativeToTheMiddle) {
  const TriangleMesh mesh = triangle();
  const std::string html = report_html({.title = "part", .mesh = &mesh});
  const std::vector<float> expected = {-0.5f, -0.5f, 0, 0.5f, -0.5f, 0, -0.5f, 0.5f, 0};
  EXPECT_EQ(block(html, "mesh-positions"), base64_of(std::span<const float>(expected)));
  EXPECT_NE(block(html, "meta").find("\"origin\":[1000000.5,0.5,0.0]"), std::string::npos);
}

TEST(Report, AFinerMeshIsShownWithTheTrianglesItIsAPartOf) {
  const TriangleMesh mesh = triangle();
  const RefinedMesh fine = split_uniformly(mesh);
  ReportData data{.title = "part", .mesh = &mesh, .shown = &fine};
  data.scalars.push_back({.name = "gap", .unit = "mm", .values = {1, 2, 3, 4, 5, 6}});
  const std::string html = report_html(data);
  const std::vector<std::uint32_t> part = {0, 1, 2};
  const std::vector<std::uint32_t> parents = {0, 0, 0, 0};
  EXPECT_EQ(block(html, "part-triangles"), base64_of(std::span<const std::uint32_t>(part)));
  EXPECT_EQ(block(html, "mesh-parents"), base64_of(std::span<const std::uint32_t>(parents)));
  EXPECT_NE(block(html, "meta").find("\"refined\":true"), std::string::npos);

  const std::string plain = report_html({.title = "part", .mesh = &mesh});
  EXPECT_EQ(block(plain, "mesh-parents"), "absent");
  EXPECT_NE(block(plain, "meta").find("\"refined\":false"), std::string::npos);
  const RefinedMesh coarser{.mesh = mesh, .on_old = {}, .old_face = {}};
  EXPECT_THROW(report_html({.title = "part", .mesh = &fine.mesh, .shown = &coarser}), Error);
}

TEST(Report, WhatIsAbsentHasNoBlock) {
  const TriangleMesh mesh = triangle();
  const ToolPath empty;
  const std::string html = report_html({.title = "part", .mesh = &mesh, .tool = &empty});
  for (const char* id : {"impact-points", "tool-tips", "isoline-points", "scalar-0"})
    EXPECT_EQ(block(html, id), "absent") << id;
}

TEST(Report, AMoveCarriesItsKindAndPiece) {
  const TriangleMesh mesh = triangle();
  ToolPath tool;
  tool.points.push_back({.kind = MoveKind::lift, .piece = 3});
  tool.points.push_back({.kind = MoveKind::link, .piece = 4, .time = 2});
  const std::string html = report_html({.title = "part", .mesh = &mesh, .tool = &tool});
  const std::vector<std::uint32_t> expected = {2, 3, 1, 4};
  EXPECT_EQ(block(html, "tool-moves"), base64_of(std::span<const std::uint32_t>(expected)));
}

}  // namespace
}  // namespace isopath
