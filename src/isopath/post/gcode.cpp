#include "isopath/post/gcode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/post/follow_axis.h"

namespace isopath {
namespace {

// A program has 6 decimals of a millimetre: over a metre, an axis that is off by less than this does not show.
constexpr double straight_tolerance = 1e-6;

void require_positive(std::string_view field, double value) {
  if (value > 0 && std::isfinite(value)) return;
  throw Error(
      ErrorCode::bad_usage, fmt::format("{} is out of range", field),
      {.element = fmt::format("G-code option {}", field), .value = fmt::format("{}; must be finite and > 0", value)});
}

bool is_straight(const Vec3& axis) { return (axis - Vec3::UnitZ()).norm() <= straight_tolerance; }

void check_straight(const ToolPath& path) {
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    if (is_straight(path.points[i].axis)) continue;
    throw Error(ErrorCode::no_plan, "the tool axis is not +Z, which a 3-axis program needs",
                {.element = fmt::format("tool path point {}", i),
                 .value = fmt::format("axis {:.6f} {:.6f} {:.6f}", path.points[i].axis.x(), path.points[i].axis.y(),
                                      path.points[i].axis.z()),
                 .advice = "plan with a fixed axis, or export a 5-axis program"});
  }
}

bool is_lift(const ToolPath& path, std::size_t i) { return path.points[i].kind == MoveKind::lift; }

// Through the air at rapid speed; the end of a lift comes down at its feed.
bool is_rapid(const ToolPath& path, std::size_t i) { return is_lift(path, i) && !lands(path, i); }

/// Writes one program; knows what the control already knows.
class Writer {
 public:
  Writer(const ToolPath& path, const GcodeOptions& options) : path_(path), options_(options) {
    if (five_axes()) angles_ = rotary_angles(path, options.limits);
  }

  std::string program() {
    preamble();
    approach();
    line("(path begins)");
    for (std::size_t i = 0; i < path_.points.size(); ++i) {
      explain(i);
      switch_spray(i);
      move(i);
    }
    line("(path ends)");
    retreat();
    return std::move(text_);
  }

 private:
  bool five_axes() const { return options_.axes == GcodeAxes::xyzac; }
  bool spray() const { return options_.process == Process::spray; }

  void line(std::string_view words) { fmt::format_to(std::back_inserter(text_), "{}\n", words); }

  // "-0.000000" is right but looks wrong.
  static double tidy(double value, double unit) { return std::abs(value) < unit / 2 ? 0 : value; }

  std::string place(const Vec3& tip, std::size_t i) const {
    std::string words =
        fmt::format("X{:.6f} Y{:.6f} Z{:.6f}", tidy(tip.x(), 1e-6), tidy(tip.y(), 1e-6), tidy(tip.z(), 1e-6));
    if (five_axes()) words += fmt::format(" A{:.8f} C{:.8f}", tidy(angles_[i].a, 1e-8), tidy(angles_[i].c, 1e-8));
    return words;
  }

  void preamble() {
    line(fmt::format("(isopath tool path: {}, {} points, {:.1f} s)", name_of(options_.process), path_.points.size(),
                     path_.points.back().time));
    line("(LinuxCNC; mm; start with the tool clear of the part and its tip as the controlled point)");
    line("G21 G90 G17 G40 G49 G94");
    line(fmt::format("G64 P{:.6f}", options_.path_tolerance));
    if (!spray()) line(fmt::format("S{:.0f} M3", options_.spindle_rpm));
  }

  double top() const {
    double z = -infinity;
    for (const ToolPoint& point : path_.points) z = std::max(z, point.tip.z());
    return z + options_.retract;
  }

  Vec3 clear_of(const ToolPoint& point) const { return point.tip + options_.retract * point.axis; }

  void approach() {
    const ToolPoint& first = path_.points.front();
    line("(approach)");
    if (five_axes()) {
      line("M428 (tool-centre-point control: X Y Z are the tip, A and C turn the part under it)");
      line("G93 (feed: moves a minute)");
      line(fmt::format("G0 {}", place(clear_of(first), 0)));
    } else {
      line(fmt::format("G0 Z{:.6f}", top()));
      line(fmt::format("G0 X{:.6f} Y{:.6f}", tidy(first.tip.x(), 1e-6), tidy(first.tip.y(), 1e-6)));
    }
  }

  void retreat() {
    if (spraying_) line("M9 (spray off)");
    if (five_axes()) {
      line(fmt::format("G0 {}", place(clear_of(path_.points.back()), path_.points.size() - 1)));
      line("G94");
      line("M429 (joint control)");
    } else {
      line(fmt::format("G0 Z{:.6f}", top()));
    }
    if (!spray()) line("M5");
    line("M2");
  }

  // A comment where a piece or another kind of move begins.
  void explain(std::size_t i) {
    const ToolPoint& point = path_.points[i];
    const ToolPoint* before = i > 0 ? &path_.points[i - 1] : nullptr;
    if (before == nullptr || before->piece != point.piece) {
      std::size_t end = i;
      double length = 0;
      while (end < path_.points.size() && path_.points[end].piece == point.piece) {
        if (end > i) length += (path_.points[end].tip - path_.points[end - 1].tip).norm();
        ++end;
      }
      line(fmt::format("(piece {}: {} points, {:.3f} mm)", point.piece, end - i, length));
    }
    if (before == nullptr || before->kind != point.kind) line(fmt::format("({})", name_of(point.kind)));
  }

  // On while the tool is on the surface. The first point of all is reached from outside: on only after it.
  void switch_spray(std::size_t i) {
    const bool wanted = spray() && !is_lift(path_, i) && i > 0;
    if (wanted == spraying_) return;
    line(wanted ? "M7 (spray on)" : "M9 (spray off)");
    spraying_ = wanted;
  }

  void move(std::size_t i) {
    const ToolPoint& point = path_.points[i];
    if (is_rapid(path_, i)) {
      line(fmt::format("G0 {}", place(point.tip, i)));
    } else if (five_axes()) {
      line(fmt::format("G1 {} F{:.6f}", place(point.tip, i), 60 / duration(i)));
    } else if (point.feed_mm_per_min != feed_) {
      feed_ = point.feed_mm_per_min;
      line(fmt::format("G1 {} F{:.6f}", place(point.tip, i), feed_));
    } else {
      line(fmt::format("G1 {}", place(point.tip, i)));
    }
  }

  // Seconds that the move to point i takes: its length over its feed, longer where the table could not follow. Every
  // block of inverse time needs a duration, a move of no length too: 1 ms is the servo period of such a control.
  double duration(std::size_t i) const {
    const ToolPoint& point = path_.points[i];
    const double length = i > 0 ? (point.tip - path_.points[i - 1].tip).norm() : options_.retract;
    double seconds = std::max(1e-3, length / point.feed_mm_per_min * 60);
    if (i > 0) {
      const double turn =
          std::max(std::abs(angles_[i].a - angles_[i - 1].a), std::abs(angles_[i].c - angles_[i - 1].c));
      seconds = std::max(seconds, turn / options_.rotary_deg_per_min * 60);
    }
    return seconds;
  }

  const ToolPath& path_;
  const GcodeOptions& options_;
  std::vector<RotaryAngles> angles_;
  std::string text_;
  bool spraying_ = false;
  double feed_ = 0;
};

}  // namespace

void GcodeOptions::validate() const {
  require_positive("spindle_rpm", spindle_rpm);
  require_positive("path_tolerance", path_tolerance);
  require_positive("axis_tolerance", axis_tolerance);
  require_positive("retract", retract);
  require_positive("rotary_deg_per_min", rotary_deg_per_min);
  if (!(limits.a_min < limits.a_max)) {
    throw Error(ErrorCode::bad_usage, "the table's limits are empty",
                {.element = "G-code option limits",
                 .value = fmt::format("a_min {}, a_max {}; a_min must be < a_max", limits.a_min, limits.a_max)});
  }
}

bool holds_axis(const GcodeOptions& options, const Vec3& axis) {
  return options.axes == GcodeAxes::xyz ? is_straight(axis) : can_tilt_to(axis, options.limits);
}

std::string gcode(const ToolPath& path, const GcodeOptions& options) {
  options.validate();
  if (path.points.empty()) throw Error(ErrorCode::no_plan, "the tool path is empty: there is nothing to program");
  if (options.axes == GcodeAxes::xyzac) {
    const ToolPath followed = follow_axis(path, options.limits, options.axis_tolerance);
    return Writer(followed, options).program();
  }
  check_straight(path);
  return Writer(path, options).program();
}

}  // namespace isopath
