#pragma once

#include <cstddef>
#include <vector>

#include "isopath/impact/impact_curve.h"

namespace isopath {

/// One pose of the tool (paper ch. 3.2): its tip, and its axis, which points from the tip towards the holder.
struct ToolPoint {
  MoveKind kind = MoveKind::cover;
  Index piece = 0;
  Vec3 tip = Vec3::Zero();       ///< mm
  Vec3 axis = Vec3::UnitZ();     ///< unit
  Vec3 tangent = Vec3::UnitX();  ///< unit, direction of travel, perpendicular to the axis
  double feed_mm_per_min = 0;    ///< speed of the move that arrives here
  double time = 0;               ///< seconds since the start
};

struct ToolPath {
  std::vector<ToolPoint> points;
};

/// True for the move to point `i` when it is the last of a lift: it comes down on to the surface.
inline bool lands(const ToolPath& path, std::size_t i) {
  const auto& points = path.points;
  if (points[i].kind != MoveKind::lift) return false;
  return i + 1 == points.size() || points[i + 1].kind != MoveKind::lift || points[i + 1].piece != points[i].piece;
}

}  // namespace isopath
