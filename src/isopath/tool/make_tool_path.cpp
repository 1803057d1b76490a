#include "isopath/tool/make_tool_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "isopath/core/error.h"
#include "isopath/tool/thin_path.h"
#include "isopath/tool/tool_frames.h"

namespace isopath {
namespace {

// A wall parallel to the axis has n · a = 0 up to the rounding of its normal (STL: single precision, 6e-8).
constexpr double facing_tolerance = 1e-6;

void check_points(const ImpactCurve& curve) {
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const ImpactPoint& point = curve.points[i];
    const bool finite = point.position.allFinite() && point.normal.allFinite();
    if (finite && std::abs(point.normal.norm() - 1) < 1e-6) continue;
    throw Error(ErrorCode::bad_input,
                finite ? "the impact curve's normal is not a unit vector" : "the impact curve is not finite",
                {.element = fmt::format("point {}", i),
                 .value = fmt::format("normal of length {}", point.normal.norm()),
                 .advice = "check the mesh for degenerate triangles"});
  }
}

void check_reach(const ImpactCurve& curve, const Vec3& axis) {
  std::size_t first = 0;
  std::size_t count = 0;
  for (std::size_t i = curve.points.size(); i-- > 0;) {
    const ImpactPoint& point = curve.points[i];
    if (point.kind == MoveKind::lift || point.normal.dot(axis) >= -facing_tolerance) continue;
    first = i;
    ++count;
  }
  if (count == 0) return;
  const double angle = std::acos(std::max(curve.points[first].normal.dot(axis), -1.0)) * 180 / std::numbers::pi;
  throw Error(ErrorCode::no_plan, "the surface faces away from the fixed tool axis",
              {.element = fmt::format("impact point {}", first),
               .value = fmt::format("{:.1f} degrees between normal and axis, limit 90; {} of {} points", angle, count,
                                    curve.points.size()),
               .advice = "use the surface normal as axis, turn the part, or cover only the part that faces the tool"});
}

Vec3 tip_of(const ImpactPoint& point, const Vec3& axis, const ToolOptions& options) {
  if (options.process == Process::spray) return point.position + axis * options.stand_off;
  // Written as one difference: with axis = n the tip is the contact point exactly.
  return point.position + (point.normal - axis) * (options.ball_diameter / 2);
}

ToolPath lift_points(const ImpactCurve& curve, const ToolOptions& options) {
  const bool fixed = options.axis_mode == AxisMode::fixed_direction;
  const Vec3 fixed_axis = options.fixed_axis.normalized();
  if (fixed) check_reach(curve, fixed_axis);
  ToolPath path;
  path.points.reserve(curve.points.size());
  for (const ImpactPoint& point : curve.points) {
    const Vec3 axis = fixed ? fixed_axis : point.normal;
    path.points.push_back(
        {.kind = point.kind, .piece = point.piece, .tip = tip_of(point, axis, options), .axis = axis});
  }
  return path;
}

double feed_of(const ToolPath& path, std::size_t i, const ToolOptions& options) {
  switch (path.points[i].kind) {
    case MoveKind::cover:
      return options.cover_feed_mm_per_min;
    case MoveKind::link:
      return options.link_feed_mm_per_min;
    case MoveKind::lift:
      break;
  }
  return lands(path, i) ? options.link_feed_mm_per_min : options.rapid_speed_mm_per_min;
}

void set_feeds_and_times(ToolPath& path, const ToolOptions& options) {
  double time = 0;
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    ToolPoint& point = path.points[i];
    point.feed_mm_per_min = feed_of(path, i, options);
    if (i > 0) time += (point.tip - path.points[i - 1].tip).norm() / point.feed_mm_per_min * 60;
    point.time = time;
  }
}

}  // namespace

ToolPath make_tool_path(const ImpactCurve& curve, const ToolOptions& options, const Progress& progress) {
  options.validate();
  check_points(curve);
  ToolPath path = thin_path(lift_points(curve, options), options.chord_tolerance, options.axis_tolerance, progress);
  set_feeds_and_times(path, options);
  set_tangents(path);
  return path;
}

}  // namespace isopath
