#include "isopath/plan/path_figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "isopath/core/error.h"

namespace isopath {
namespace {

ImpactPoint at(const Vec3& position, MoveKind kind = MoveKind::cover, Index piece = 0) {
  ImpactPoint point;
  point.kind = kind;
  point.position = position;
  point.piece = piece;
  return point;
}

ImpactCurve arc(double radius, double angle, int chords) {
  ImpactCurve curve;
  for (int i = 0; i <= chords; ++i) {
    const double phi = angle * i / chords;
    curve.points.push_back(at(radius * Vec3(std::cos(phi), std::sin(phi), 0)));
  }
  return curve;
}

TEST(PathFigures, RadiusOfACircleHowFinelyEverItIsCut) {
  for (const int chords : {600, 6000, 60000}) {
    const PathFigures figures = path_figures(arc(7, 5, chords), 1);
    EXPECT_NEAR(figures.min_radius, 7, 0.03) << chords;
    EXPECT_EQ(figures.sharp_corners, 0) << chords;
    EXPECT_NEAR(figures.cover_length, 35, 0.1) << chords;
  }
}

TEST(PathFigures, AStraightLineHasNoRadius) {
  ImpactCurve curve;
  for (int i = 0; i <= 10; ++i) curve.points.push_back(at(Vec3(0.1 * i, 0.7 * i, -i)));
  EXPECT_EQ(path_figures(curve, 1).min_radius, infinity);
}

TEST(PathFigures, CountsTurnsOverFortyFiveDegrees) {
  for (const double degrees : {10.0, 40.0, 50.0, 90.0, 179.0}) {
    ImpactCurve curve;
    Vec3 position = Vec3::Zero();
    double heading = 0;
    for (int leg = 0; leg < 5; ++leg) {
      curve.points.push_back(at(position));
      position += 10 * Vec3(std::cos(heading), std::sin(heading), 0);
      heading += degrees * std::numbers::pi / 180;
    }
    curve.points.push_back(at(position));
    EXPECT_EQ(path_figures(curve, 1).sharp_corners, degrees > 45 ? 4 : 0) << degrees;
  }
}

TEST(PathFigures, AStraightWayOverASharpEdgeIsNoCorner) {
  // over the edge between the plane z = 0 and the wall x = 0 below it, at an angle to the edge
  for (const double along : {0.0, 0.5, 2.0}) {
    ImpactCurve curve;
    curve.points = {at(Vec3(-10, -10 * along, 0)), at(Vec3::Zero()), at(Vec3(0, 10 * along, -10))};
    curve.points[2].normal = Vec3::UnitX();
    EXPECT_EQ(path_figures(curve, 1).sharp_corners, 0) << along;
    // back along the edge instead
    curve.points[2].position = Vec3(0, -10, -1);
    EXPECT_EQ(path_figures(curve, 1).sharp_corners, 1) << along;
  }
}

TEST(PathFigures, ACornerCutIntoTinyChordsIsOneCorner) {
  ImpactCurve curve;
  curve.points.push_back(at(Vec3(-10, 0, 0)));
  for (int i = 0; i <= 20; ++i) {
    const double phi = std::numbers::pi / 2 * i / 20;
    curve.points.push_back(at(1e-4 * Vec3(std::sin(phi), 1 - std::cos(phi), 0)));
  }
  curve.points.push_back(at(Vec3(1e-4, 10, 0)));
  EXPECT_EQ(path_figures(curve, 1).sharp_corners, 1);
}

TEST(PathFigures, ATurnIsTightWhereItIsTooShortForItsSpacing) {
  // a quarter of a spacing on either side sees a turn by 0.25 / radius
  const double turn = std::numbers::pi / 4;
  EXPECT_EQ(path_figures(arc(1.05 * 0.25 / turn, 30, 3000), 1).tight_turns, 0);
  EXPECT_GT(path_figures(arc(0.9 * 0.25 / turn, 30, 3000), 1).tight_turns, 0);
  // a right angle that is rounded so that no corner is left still is one turn
  ImpactCurve curve;
  const double radius = 0.09;
  curve.points.push_back(at(Vec3(-10, 0, 0)));
  for (int i = 0; i <= 60; ++i) {
    const double phi = std::numbers::pi / 2 * i / 60;
    curve.points.push_back(at(radius * Vec3(std::sin(phi), 1 - std::cos(phi), 0)));
  }
  curve.points.push_back(at(Vec3(radius, 10, 0)));
  EXPECT_EQ(path_figures(curve, 1).sharp_corners, 0);
  EXPECT_EQ(path_figures(curve, 1).tight_turns, 1);
}

TEST(PathFigures, ZigzagNoiseOfTinyChordsIsNoCorner) {
  ImpactCurve curve;
  for (int i = 0; i <= 100000; ++i) curve.points.push_back(at(Vec3(1e-4 * i, i % 2 ? 1e-4 : 0, 0)));
  EXPECT_EQ(path_figures(curve, 1).sharp_corners, 0);
}

TEST(PathFigures, LiftsSeparatePiecesAndAreNotMeasured) {
  ImpactCurve curve;
  curve.points = {at({0, 0, 0}),
                  at({10, 0, 0}),
                  at({10, 0, 5}, MoveKind::lift),
                  at({0, 3, 5}, MoveKind::lift),
                  at({0, 3, 0}, MoveKind::lift),
                  at({10, 3, 0}, MoveKind::cover, 1),
                  at({10, 4, 0}, MoveKind::link, 1)};
  const PathFigures figures = path_figures(curve, 1);
  EXPECT_EQ(figures.pieces, 2);
  EXPECT_EQ(figures.lifts, 1);
  EXPECT_DOUBLE_EQ(figures.cover_length, 20);
  EXPECT_DOUBLE_EQ(figures.links_length, 1);
  EXPECT_EQ(figures.min_radius, infinity);
  EXPECT_EQ(figures.sharp_corners, 1);
}

TEST(PathFigures, NeedsASpacing) { EXPECT_THROW(path_figures({}, 0), Error); }

}  // namespace
}  // namespace isopath
