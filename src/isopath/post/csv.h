#pragma once

#include <string>
#include <string_view>

#include "isopath/impact/impact_curve.h"
#include "isopath/tool/tool_path.h"

namespace isopath {

/// `impact.csv`: columns index,piece,kind,x,y,z,nx,ny,nz,s. Lengths in mm, s along the whole curve. Every number is the
/// shortest that reads back to the same double.
std::string impact_csv(const ImpactCurve& curve);

/// `tool.csv`: columns index,piece,kind,x,y,z,i,j,k,feed,t: tip in mm, axis from the tip towards the holder, mm/min,
/// seconds. Every number is the shortest that reads back to the same double.
std::string tool_csv(const ToolPath& path);

/// Reads what tool_csv() writes; the tangents are computed anew (set_tangents). Line ends may be LF or CRLF, blank
/// lines are skipped. Throws Error(bad_input) naming the line when the header, the number of fields, a kind or a number
/// is wrong, an axis is not a unit vector to 1e-6, the feed is not positive after the first point, pieces count
/// backwards or time runs backwards.
ToolPath read_tool_csv(std::string_view text);

}  // namespace isopath
