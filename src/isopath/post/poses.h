#pragma once

#include <string>

#include "isopath/tool/tool_path.h"

namespace isopath {

/// The path as poses of the tool's frame, one list a piece, in YAML or JSON of the same layout:
///
///     format: isopath-poses
///     version: 1
///     units: {length: mm, time: s, feed: mm/min}
///     frame: z is the tool axis ... (the convention below, in words)
///     pieces:
///       - piece: 0
///         poses:
///           - {kind: cover, position: [x, y, z], orientation: [x, y, z, w], feed: 1000, time: 0}
///
/// Position is the tool's tip. Orientation is the unit quaternion that turns x, y, z into tangent, axis × tangent and
/// axis; of its two signs the one nearer to the pose before is written, and w >= 0 at first. Numbers read back to the
/// same double.
std::string poses_yaml(const ToolPath& path);
std::string poses_json(const ToolPath& path);

}  // namespace isopath
