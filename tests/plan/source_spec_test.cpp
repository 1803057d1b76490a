#include "isopath/plan/source_spec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "isopath/core/error.h"

namespace isopath {
namespace {

TEST(SourceSpec, ReadsEveryForm) {
  using Kind = SourceSpec::Kind;
  EXPECT_EQ(parse_source_spec("auto"), SourceSpec{});
  EXPECT_EQ(parse_source_spec("boundary"), (SourceSpec{.kind = Kind::boundary}));
  EXPECT_EQ(parse_source_spec("boundary:2"), (SourceSpec{.kind = Kind::boundary, .indices = {2}}));
  EXPECT_EQ(parse_source_spec("vertex:4, 0,7"), (SourceSpec{.kind = Kind::vertex, .indices = {4, 0, 7}}));
  EXPECT_EQ(parse_source_spec("point:1,-2.5,3e2"), (SourceSpec{.kind = Kind::point, .numbers = {1, -2.5, 300}}));
  EXPECT_EQ(parse_source_spec("plane:0,0,1,12"), (SourceSpec{.kind = Kind::plane, .numbers = {0, 0, 1, 12}}));
  EXPECT_EQ(parse_source_spec("edges:40"), (SourceSpec{.kind = Kind::edges, .numbers = {40}}));
  EXPECT_EQ(parse_source_spec("geodesic:1,2,3:4,5,6"),
            (SourceSpec{.kind = Kind::geodesic, .numbers = {1, 2, 3, 4, 5, 6}}));
  EXPECT_EQ(parse_source_spec("cut:1,2,3:45"), (SourceSpec{.kind = Kind::cut, .numbers = {1, 2, 3, 45}}));
  EXPECT_EQ(parse_source_spec("cut:-2:45,10"), (SourceSpec{.kind = Kind::cut, .numbers = {-2, 45, 10}}));
  EXPECT_EQ(parse_source_spec("segment:1:0.2,0.7"),
            (SourceSpec{.kind = Kind::segment, .indices = {1}, .numbers = {0.2, 0.7}}));
  EXPECT_EQ(parse_source_spec("offset:30,5"), (SourceSpec{.kind = Kind::offset, .numbers = {30, 5}}));
  EXPECT_EQ(parse_source_spec("polyline:a:b,c.csv"), (SourceSpec{.kind = Kind::polyline, .file = "a:b,c.csv"}));
}

TEST(SourceSpec, TextReadsBackToTheSameNumbers) {
  std::mt19937_64 rng(11);
  std::uniform_real_distribution<double> exponent(-30, 30);
  for (int i = 0; i < 1000; ++i) {
    SourceSpec spec{.kind = SourceSpec::Kind::point};
    for (int k = 0; k < 3; ++k) spec.numbers.push_back((k % 2 ? -1 : 1) * std::pow(10, exponent(rng)));
    EXPECT_EQ(parse_source_spec(text_of(spec)), spec) << text_of(spec);
  }
}

TEST(SourceSpec, EveryFormReadsBackToItself) {
  for (const char* text : {"auto", "boundary", "boundary:2", "vertex:3,1", "point:1,2,3", "polyline:a.csv",
                           "plane:0,0,1,2", "edges:40", "geodesic:1,2,3:4,5,6", "cut:1,2,3:45", "cut:1,2,3:45,6",
                           "cut:7:45", "cut:7:45,6", "segment:1,2,3:4,5,6", "segment:0:0.25,1.5", "offset:30,5"}) {
    EXPECT_EQ(text_of(parse_source_spec(text)), text);
  }
}

class BadSourceSpec : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(BadSourceSpec, IsRefusedWithItsTextAndItsValue) {
  const auto [text, value] = GetParam();
  try {
    parse_source_spec(text);
    FAIL() << text << " was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_usage);
    EXPECT_NE(error.where().element.find(text), std::string::npos) << error.what();
    EXPECT_NE(error.where().value.find(value), std::string::npos) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Forms, BadSourceSpec,
    testing::Values(std::pair("", "''"), std::pair("border", "'border'"), std::pair("vertex", "nothing after"),
                    std::pair("vertex:", "nothing after"), std::pair("vertex:1,x", "'x'"),
                    std::pair("vertex:-1", "'-1'"), std::pair("vertex:1.5", "'1.5'"),
                    std::pair("vertex:99999999999", "'99999999999'"), std::pair("boundary:", "nothing after"),
                    std::pair("point:1,2", "2 where 3"), std::pair("point:1,2,nan", "'nan'"),
                    std::pair("point:1,2,1e999", "'1e999'"), std::pair("plane:0,0,0,1", "0,0,0"),
                    std::pair("edges:180", "180"), std::pair("edges:0", "0"), std::pair("auto:1", "1"),
                    std::pair("geodesic:1,2,3", "1 where 2"), std::pair("geodesic:1,2,3:4,5", "2 where 3"),
                    std::pair("cut:1,2:3", "2 where a point"), std::pair("cut:1:2,3,4", "3 where 1 to 2"),
                    std::pair("segment:x:0,1", "'x'"), std::pair("segment:0:0.5,0.5", "0.5"),
                    std::pair("offset:30,0", "0"), std::pair("offset:200,1", "200"),
                    std::pair("offset:30", "1 where 2")));

}  // namespace
}  // namespace isopath
