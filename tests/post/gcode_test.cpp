#include "isopath/post/gcode.h"

#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/post/follow_axis.h"
#include "post/occurrences.h"
#include "post/test_paths.h"

namespace isopath {
namespace {

// One line of a program: its words without comments, letter to number (the last of each letter).
struct Block {
  std::string text;
  std::map<char, double> words;
};

std::vector<Block> blocks_of(const std::string& program) {
  std::vector<Block> blocks;
  std::istringstream stream(program);
  for (std::string line; std::getline(stream, line);) {
    Block block{line, {}};
    std::istringstream words(line.substr(0, line.find('(')));
    for (std::string word; words >> word;) block.words[word[0]] = std::stod(word.substr(1));
    blocks.push_back(block);
  }
  return blocks;
}

// The moves between "path begins" and "path ends".
std::vector<Block> moves_of(const std::string& program) {
  std::vector<Block> moves;
  bool within = false;
  for (const Block& block : blocks_of(program)) {
    if (block.text == "(path begins)") within = true;
    if (block.text == "(path ends)") within = false;
    if (within && block.words.contains('X')) moves.push_back(block);
  }
  return moves;
}

// A path that a 5-axis program needs no more points for.
ToolPath five_axis_path() {
  return follow_axis(test::full_path(test::wavy_zigzag()), {}, GcodeOptions().axis_tolerance);
}

TEST(Gcode, FiveAxisMovesTakeTheTimeOfThePath) {
  const ToolPath path = five_axis_path();
  const std::vector<Block> moves = moves_of(gcode(path, {.rotary_deg_per_min = 1e9}));
  ASSERT_EQ(moves.size(), path.points.size());
  for (std::size_t i = 1; i < moves.size(); ++i) {
    if (moves[i].words.at('G') == 0) continue;
    const double seconds = std::max(1e-3, path.points[i].time - path.points[i - 1].time);
    EXPECT_NEAR(60 / moves[i].words.at('F'), seconds, 1e-5 * seconds) << i;
  }
}

TEST(Gcode, TheTableIsNotAskedToTurnFasterThanItsLimit) {
  const ToolPath path = test::full_path(test::sphere_spiral());
  const std::vector<Block> moves = moves_of(gcode(path, {.rotary_deg_per_min = 1200}));
  for (std::size_t i = 1; i < moves.size(); ++i) {
    const double turn = std::abs(moves[i].words.at('C') - moves[i - 1].words.at('C'));
    EXPECT_LE(turn * moves[i].words.at('F'), 1200 * (1 + 1e-6)) << i;
  }
}

TEST(Gcode, ThreeAxisMovesHaveTheFeedOfThePath) {
  const ToolPath path = test::full_path(test::wavy_zigzag(), AxisMode::fixed_direction);
  const std::vector<Block> moves = moves_of(gcode(path, {.axes = GcodeAxes::xyz}));
  ASSERT_EQ(moves.size(), path.points.size());
  double feed = 0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const Vec3 tip(moves[i].words.at('X'), moves[i].words.at('Y'), moves[i].words.at('Z'));
    EXPECT_LT((tip - path.points[i].tip).norm(), 1e-6) << i;
    EXPECT_FALSE(moves[i].words.contains('A'));
    if (moves[i].words.contains('F')) feed = moves[i].words.at('F');
    if (moves[i].words.at('G') == 1) {
      EXPECT_EQ(feed, path.points[i].feed_mm_per_min) << i;
    }
  }
}

TEST(Gcode, LiftsAreRapidUntilTheyComeDown) {
  const ToolPath path = five_axis_path();
  const std::vector<Block> moves = moves_of(gcode(path));
  for (std::size_t i = 0; i + 1 < moves.size(); ++i) {
    const bool lift = path.points[i].kind == MoveKind::lift;
    const bool lands = lift && path.points[i + 1].kind != MoveKind::lift;
    EXPECT_EQ(moves[i].words.at('G'), lift && !lands ? 0 : 1) << i;
  }
}

TEST(Gcode, ALiftAtTheEndOrBeforeAnotherOneComesDownAtItsFeed) {
  ToolPath path;
  const auto add = [&](MoveKind kind, double x, double z, Index piece) {
    path.points.push_back({.kind = kind, .piece = piece, .tip = Vec3(x, 0, z), .feed_mm_per_min = 100});
  };
  add(MoveKind::cover, 0, 0, 0);
  for (const Index piece : {1, 2}) {
    add(MoveKind::lift, 10 * piece, 20, piece);
    add(MoveKind::lift, 10 * piece, 0, piece);
  }
  for (const GcodeAxes axes : {GcodeAxes::xyz, GcodeAxes::xyzac}) {
    const std::vector<Block> moves = moves_of(gcode(path, {.axes = axes}));
    for (std::size_t i = 1; i < path.points.size(); ++i) {
      EXPECT_EQ(moves[i].words.at('G'), path.points[i].tip.z() == 0 ? 1 : 0) << i;
    }
  }
}

TEST(Gcode, SprayIsOnOnTheSurfaceOnly) {
  const ToolPath path = five_axis_path();
  const std::string program = gcode(path, {.process = Process::spray});
  EXPECT_EQ(test::occurrences(program, "M3"), 0U);
  EXPECT_EQ(test::occurrences(program, "\nM7"), 3U);
  EXPECT_EQ(test::occurrences(program, "\nM9"), 3U);
  bool on = false;
  std::size_t i = 0;
  for (const Block& block : blocks_of(program)) {
    if (block.words.contains('M') && block.words.at('M') == 7) on = true;
    if (block.words.contains('M') && block.words.at('M') == 9) on = false;
    if (!block.words.contains('X')) continue;
    // The first and last move of the program approach and retreat; the move after the approach lands.
    const bool outside = i < 2 || i == path.points.size() + 1;
    EXPECT_EQ(on, !outside && path.points[i - 1].kind != MoveKind::lift) << block.text;
    ++i;
  }
  EXPECT_EQ(i, path.points.size() + 2);
}

TEST(Gcode, MillingTurnsTheSpindleFromBeforeTheApproachToAfterTheRetreat) {
  const std::string program = gcode(test::full_path(test::wavy_zigzag()), {.spindle_rpm = 8000});
  EXPECT_LT(program.find("S8000 M3\n"), program.find("(approach)"));
  EXPECT_GT(program.find("\nM5\n"), program.find("(path ends)"));
  EXPECT_EQ(test::occurrences(program, "(piece "), 3U);
  EXPECT_NE(program.find("G21 G90 G17 G40 G49 G94\n"), std::string::npos);
  EXPECT_LT(program.find("M428"), program.find("(path begins)"));
  EXPECT_GT(program.find("M429"), program.find("(path ends)"));
  EXPECT_TRUE(program.ends_with("M2\n"));
}

TEST(Gcode, RefusesATiltedAxisOnThreeAxes) {
  try {
    gcode(test::full_path(test::wavy_zigzag()), {.axes = GcodeAxes::xyz});
    FAIL() << "accepted a tilted axis";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::no_plan);
    EXPECT_EQ(error.where().element, "tool path point 0");
  }
  EXPECT_THROW(gcode({}), Error);
}

TEST(Gcode, RefusesBrokenOptions) {
  const ToolPath path = test::full_path(test::wavy_zigzag());
  for (const GcodeOptions& options :
       {GcodeOptions{.spindle_rpm = 0}, GcodeOptions{.path_tolerance = -1}, GcodeOptions{.axis_tolerance = 0},
        GcodeOptions{.retract = 0}, GcodeOptions{.rotary_deg_per_min = 0},
        GcodeOptions{.limits = {.a_min = 10, .a_max = 0}}}) {
    EXPECT_THROW(gcode(path, options), Error);
  }
}

}  // namespace
}  // namespace isopath
