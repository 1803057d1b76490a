#pragma once

#include <span>
#include <string>
#include <string_view>

#include "isopath/core/geometry.h"
#include "isopath/post/gcode.h"
#include "isopath/tool/tool_path.h"

namespace isopath {

/// A format that a tool path can be exported to.
struct ExportFormat {
  std::string_view name;     ///< as the user writes it
  std::string_view suffix;   ///< of the file, with its dot
  std::string_view summary;  ///< one line for the user
};

/// All of them, in the order they are offered.
std::span<const ExportFormat> export_formats();

/// Whether a program in this format can stand the tool along a unit axis in the part's frame; true for a format that is
/// no G-code.
bool holds_axis(std::string_view format, const Vec3& axis);

/// The path in the named format. Of the options, gcode3 and gcode5 use all but `axes`; the others use none.
/// Throws Error(bad_usage) that lists the formats when there is none of that name, and what the writer throws.
std::string export_tool_path(const ToolPath& path, std::string_view format, const GcodeOptions& options = {});

}  // namespace isopath
