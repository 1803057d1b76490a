#pragma once

#include <string>

#include "isopath/tool/tool_path.h"

namespace isopath {

/// The path for viewers such as ParaView, as a VTP file: one polyline for every run of moves of one kind and piece,
/// over common points at the tool's tip. Arrays on the points: `kind` (0 cover, 1 link, 2 lift: of the move that
/// arrives) and `piece`, `s` (mm along the tip's way), `t` (seconds), `feed` (mm/min), `i`, `j` and `k` (the tool axis,
/// which is the surface normal unless it is fixed); on the lines: `kind` and `piece`.
std::string path_vtp(const ToolPath& path);

}  // namespace isopath
