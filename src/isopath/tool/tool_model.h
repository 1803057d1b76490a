#pragma once

#include <string_view>

#include "isopath/core/geometry.h"

namespace isopath {

/// What the tool does to the surface.
enum class Process {
  spray,  ///< a nozzle that keeps its distance
  mill,   ///< a ball cutter that touches
  grind,  ///< a ball-nosed grinding or polishing tool that touches
};
std::string_view name_of(Process process);

/// Where the tool's axis points.
enum class AxisMode {
  surface_normal,   ///< along the surface normal: 5 axes
  fixed_direction,  ///< the same everywhere: 3 axes
};

/// How an impact curve is lifted to a tool path.
struct ToolOptions {
  Process process = Process::mill;
  double stand_off = 150;     ///< spray: from the nozzle to the surface, mm, > 0; the usual reach of a spray gun
  double ball_diameter = 10;  ///< mill and grind: mm, > 0
  AxisMode axis_mode = AxisMode::surface_normal;
  Vec3 fixed_axis = Vec3::UnitZ();        ///< fixed_direction: from the tip towards the holder; any length > 0
  double cover_feed_mm_per_min = 1000;    ///< along covering moves and at the start, > 0
  double link_feed_mm_per_min = 1000;     ///< along links, and down on to the surface at the end of a lift, > 0
  double rapid_speed_mm_per_min = 10000;  ///< along lifts, > 0
  double chord_tolerance = 0.01;  ///< points are left out while the tip stays this near its path, mm; 0 keeps all
  double axis_tolerance = 2e-3;   ///< and while the axis stays within this angle, rad (2e-3 is 0.11 degrees)

  /// Throws Error(bad_usage) naming the field, its value and its limit.
  void validate() const;
};

}  // namespace isopath
