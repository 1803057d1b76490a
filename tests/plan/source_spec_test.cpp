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

INSTANTIATE_TEST_SUITE_P(Forms, BadSourceSpec,
                         testing::Values(std::pair("", "''"), std::pair("border", "'border'"),
                                         std::pair("vertex", "nothing after"), std::pair("vertex:", "nothing after"),
                                         std::pair("vertex:1,x", "'x'"), std::pair("vertex:-1", "'-1'"),
                                         std::pair("vertex:1.5", "'1.5'"),
                                         std::pair("vertex:99999999999", "'99999999999'"),
                                         std::pair("boundary:", "nothing after"), std::pair("point:1,2", "2 where 3"),
                                         std::pair("point:1,2,nan", "'nan'"), std::pair("point:1,2,1e999", "'1e999'"),
                                         std::pair("plane:0,0,0,1", "0,0,0"), std::pair("edges:180", "180"),
                                         std::pair("edges:0", "0"), std::pair("auto:1", "1")));

}  // namespace
}  // namespace isopath
