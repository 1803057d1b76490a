#pragma once

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

}  // namespace isopath
