#include "isopath/post/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "isopath/core/error.h"
#include "isopath/post/csv.h"
#include "isopath/post/path_vtp.h"
#include "isopath/post/poses.h"

namespace isopath {
namespace {

using WriteFunction = std::string (*)(const ToolPath&, const GcodeOptions&);

constexpr std::array formats = {
    ExportFormat{"gcode3", ".ngc", "LinuxCNC G-code, 3 axes, tool along +Z"},
    ExportFormat{"gcode5", ".ngc", "LinuxCNC G-code, 5 axes X Y Z A C, tool-centre-point control"},
    ExportFormat{"csv", ".csv", "tool.csv: tip, axis, feed and time of every point"},
    ExportFormat{"yaml", ".yaml", "poses of the tool's frame, YAML"},
    ExportFormat{"json", ".json", "poses of the tool's frame, JSON"},
    ExportFormat{"vtp", ".vtp", "polylines with kind, piece, length, time, feed and axis, for ParaView"},
};

std::string write_gcode(const ToolPath& path, GcodeOptions options, GcodeAxes axes) {
  options.axes = axes;
  return gcode(path, options);
}

// One writer a format, in the same order.
constexpr std::array<WriteFunction, formats.size()> writers = {
    [](const ToolPath& path, const GcodeOptions& options) { return write_gcode(path, options, GcodeAxes::xyz); },
    [](const ToolPath& path, const GcodeOptions& options) { return write_gcode(path, options, GcodeAxes::xyzac); },
    [](const ToolPath& path, const GcodeOptions&) { return tool_csv(path); },
    [](const ToolPath& path, const GcodeOptions&) { return poses_yaml(path); },
    [](const ToolPath& path, const GcodeOptions&) { return poses_json(path); },
    [](const ToolPath& path, const GcodeOptions&) { return path_vtp(path); },
};

}  // namespace

std::span<const ExportFormat> export_formats() { return formats; }

bool holds_axis(std::string_view format, const Vec3& axis) {
  if (format == "gcode3") return holds_axis(GcodeOptions{.axes = GcodeAxes::xyz}, axis);
  if (format == "gcode5") return holds_axis(GcodeOptions{.axes = GcodeAxes::xyzac}, axis);
  return true;
}

std::string export_tool_path(const ToolPath& path, std::string_view format, const GcodeOptions& options) {
  const auto found = std::find_if(formats.begin(), formats.end(), [&](const auto& f) { return f.name == format; });
  if (found != formats.end()) return writers[std::size_t(found - formats.begin())](path, options);
  std::string names;
  for (const ExportFormat& known : formats) names += fmt::format("{}{}", names.empty() ? "" : ", ", known.name);
  throw Error(ErrorCode::bad_usage, "unknown export format",
              {.value = fmt::format("'{}'", format), .advice = fmt::format("formats: {}", names)});
}

}  // namespace isopath
