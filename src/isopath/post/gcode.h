#pragma once

#include <string>

#include "isopath/post/rotary_axes.h"
#include "isopath/tool/tool_model.h"
#include "isopath/tool/tool_path.h"

namespace isopath {

enum class GcodeAxes {
  xyz,    ///< 3 axes: the tool stands along +Z
  xyzac,  ///< 5 axes: a tilting rotary table under tool-centre-point control (LinuxCNC's xyzac-trt-kins)
};

struct GcodeOptions {
  GcodeAxes axes = GcodeAxes::xyzac;
  Process process = Process::mill;   ///< spray switches M7/M9 a piece; mill and grind turn the spindle throughout
  double spindle_rpm = 10000;        ///< mill and grind, > 0
  double path_tolerance = 0.01;      ///< G64 P, mm, > 0: how far the control may round corners
  double axis_tolerance = 0.01;      ///< how far the tool axis may swing out between two points, rad, > 0
  double retract = 10;               ///< distance of the approach before and the retreat after the path, mm, > 0
  double rotary_deg_per_min = 3600;  ///< the fastest the table should turn in a feed move, > 0
  RotaryLimits limits = {};          ///< reach of A; the default is that of LinuxCNC's sample machine

  /// Throws Error(bad_usage) naming the field, its value and its limit.
  void validate() const;
};

/// Whether a program for these axes can stand the tool along a unit axis in the part's frame: +Z to 1e-6 with 3 axes,
/// what the table can tilt to with 5.
bool holds_axis(const GcodeOptions& options, const Vec3& axis);

/// The path as a program for LinuxCNC: millimetres, absolute, one block a point; with 5 axes
/// more where the axis would otherwise swing out (follow_axis). Lifts are G0, but a lift's last move,
/// down on to the surface, and all others are G1. With 3 axes feed is in mm/min (G94); with 5 axes X Y Z are the tip in
/// the part's frame between M428 and M429, and feed is inverse time (G93). The program takes the tool's length as set
/// up: it moves the tip. It approaches along the axis from `retract` away (3 axes: from above the whole path), and
/// marks the path proper by the comments "path begins" and "path ends". Coordinates have 6 decimals, angles 8.
/// Throws Error(no_plan) when the path is empty, when an axis is not +Z (3 axes, to 1e-6) or out of the table's reach.
std::string gcode(const ToolPath& path, const GcodeOptions& options = {});

}  // namespace isopath
