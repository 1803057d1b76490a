#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "isopath/impact/impact_curve.h"
#include "isopath/tool/make_tool_path.h"

/// Analytic paths for the tests of the writers.
namespace isopath::test {

inline void add(ImpactCurve& curve, const Vec3& position, const Vec3& normal, MoveKind kind, Index piece) {
  ImpactPoint point;
  point.position = position;
  point.normal = normal.normalized();
  point.kind = kind;
  point.piece = piece;
  curve.points.push_back(point);
}

/// Joins the curve's end to the start of the next piece by a lift of this height along the normals.
inline void add_lift(ImpactCurve& curve, const Vec3& to, const Vec3& normal, double height, Index piece) {
  const ImpactPoint from = curve.points.back();
  add(curve, from.position + height * from.normal, from.normal, MoveKind::lift, piece);
  add(curve, to + height * normal.normalized(), normal, MoveKind::lift, piece);
  add(curve, to, normal, MoveKind::lift, piece);
}

/// Two helices round a cylinder along x whose axis is tilted so that the normals cross +Z, joined by a lift: the upper
/// 160 degrees, there and back, so that the tilt changes side.
inline ImpactCurve cylinder_helix(double radius = 30) {
  ImpactCurve curve;
  const auto at = [&](double angle) { return Vec3(0, std::sin(angle), std::cos(angle)); };
  for (Index piece = 0; piece < 2; ++piece) {
    const double begin = piece == 0 ? -0.8 : 0.8;
    for (int i = 0; i <= 60; ++i) {
      const double angle = begin * (1 - i / 30.0);
      const Vec3 position = radius * at(angle) + Vec3(i * 0.1 + piece * 10, 0, 0);
      if (i == 0 && piece > 0) add_lift(curve, position, at(angle), 8, piece);
      add(curve, position, at(angle), i % 20 == 19 ? MoveKind::link : MoveKind::cover, piece);
    }
  }
  return curve;
}

/// A spiral from the top of a sphere down: the axis turns many times round +Z, starting on it.
inline ImpactCurve sphere_spiral(double radius = 25) {
  ImpactCurve curve;
  for (int i = 0; i <= 2000; ++i) {
    const double tilt = i * 0.0007;
    const double turn = i * 0.05;
    const Vec3 normal(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
    add(curve, radius * normal, normal, MoveKind::cover, 0);
  }
  return curve;
}

/// A zigzag over the height field z = 3 sin(x / 5) cos(y / 7), in pieces of three lines.
inline ImpactCurve wavy_zigzag() {
  ImpactCurve curve;
  for (int line = 0; line < 9; ++line) {
    for (int i = 0; i <= 40; ++i) {
      const double x = line % 2 == 0 ? i : 40 - i;
      const double y = line * 3;
      const Vec3 position(x, y, 3 * std::sin(x / 5) * std::cos(y / 7));
      const Vec3 normal(-0.6 * std::cos(x / 5) * std::cos(y / 7), 3.0 / 7 * std::sin(x / 5) * std::sin(y / 7), 1);
      if (i == 0 && line > 0 && line % 3 == 0) add_lift(curve, position, normal, 5, line / 3);
      add(curve, position, normal, i == 0 && line % 3 != 0 ? MoveKind::link : MoveKind::cover, line / 3);
    }
  }
  return curve;
}

/// Two moves over the top of a cylinder that lean a little along it: the axis passes near +Z, where few points say
/// little about the angles of a table.
inline ImpactCurve near_pole() {
  ImpactCurve curve;
  for (const double angle : {-0.5, -0.3, 0.3, 0.4}) {
    const Vec3 normal(0.1, std::sin(angle), std::cos(angle));
    add(curve, 30 * normal, normal, MoveKind::cover, 0);
  }
  return curve;
}

/// Every point of the curve, none left out.
inline ToolPath full_path(const ImpactCurve& curve, AxisMode mode = AxisMode::surface_normal) {
  ToolOptions options;
  options.axis_mode = mode;
  options.chord_tolerance = 0;
  return make_tool_path(curve, options);
}

}  // namespace isopath::test
