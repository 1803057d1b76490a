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

struct BadSpec {
  const char* text;
  const char* value;
};
void PrintTo(const BadSpec& spec, std::ostream* out) { *out << '\'' << spec.text << '\''; }

class BadSourceSpec : public testing::TestWithParam<BadSpec> {};

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
    testing::Values(BadSpec{"", "''"}, BadSpec{"border", "'border'"}, BadSpec{"vertex", "nothing after"},
                    BadSpec{"vertex:", "nothing after"}, BadSpec{"vertex:1,x", "'x'"}, BadSpec{"vertex:-1", "'-1'"},
                    BadSpec{"vertex:1.5", "'1.5'"}, BadSpec{"vertex:99999999999", "'99999999999'"},
                    BadSpec{"boundary:", "nothing after"}, BadSpec{"point:1,2", "2 where 3"},
                    BadSpec{"point:1,2,nan", "'nan'"}, BadSpec{"point:1,2,1e999", "'1e999'"},
                    BadSpec{"plane:0,0,0,1", "0,0,0"}, BadSpec{"edges:180", "180"}, BadSpec{"edges:0", "0"},
                    BadSpec{"auto:1", "1"}, BadSpec{"geodesic:1,2,3", "1 where 2"},
                    BadSpec{"geodesic:1,2,3:4,5", "2 where 3"}, BadSpec{"cut:1,2:3", "2 where a point"},
                    BadSpec{"cut:1:2,3,4", "3 where 1 to 2"}, BadSpec{"segment:x:0,1", "'x'"},
                    BadSpec{"segment:0:0.5,0.5", "0.5"}, BadSpec{"offset:30,0", "0"}, BadSpec{"offset:200,1", "200"},
                    BadSpec{"offset:30", "1 where 2"}));

}  // namespace
}  // namespace isopath
