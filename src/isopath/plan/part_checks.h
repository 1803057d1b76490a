#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/impact/gap.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/mesh/triangle_mesh.h"
#include "isopath/plan/job.h"
#include "isopath/tool/tool_model.h"

namespace isopath {

/// Says that the part is smaller than 5 mm (1 mm where its file is not in mm, as then somebody thought of the unit) or
/// larger than 20 m: more likely its file is in another unit.
std::optional<std::string> warning_of_size(double size, bool has_unit);

/// Says that the part is in so many pieces that it may be no surface at all, but triangles that do not meet.
std::optional<std::string> warning_of_pieces(const TriangleMesh& mesh);

/// Says that the ball is larger than the part, or the stand-off of a nozzle than ten of it.
std::optional<std::string> warning_of_tool(const ToolOptions& tool, double size);

/// Says that the largest gap is above 1.1 spacings, and where if a vertex shows it. Not for gaps without end: those are
/// of components without a source.
std::optional<std::string> warning_of_gap(const TriangleMesh& mesh, const GapReport& gap, double spacing);

/// Throws Error(bad_usage) when the levels between these values, a spacing apart, are more passes than anybody wants.
void check_pass_count(std::span<const double> values, double spacing);

/// Says how many components have no vertex with a finite distance.
void warn_of_unreached(const TriangleMesh& mesh, std::span<const double> distances, std::vector<std::string>& warnings);

/// Throws Error(no_plan) when more than a thousandth of the area that the sources reach (finite `distances`) faces away
/// from a fixed tool axis by more than a degree, or, with a tool along the normals, tilts farther than a program that
/// the job names can hold. The tool path or the program would refuse such a part, but only once it is planned.
void check_reach(const TriangleMesh& mesh, std::span<const double> distances, const Job& job);

/// Places where the normal, and with it the axis of a tool that stands along it, turns by more than 30 degrees within a
/// short way along the surface.
struct AxisJumps {
  Index count = 0;
  double worst = 0;        ///< rad
  Vec3 at = Vec3::Zero();  ///< where the worst one is
};
/// `reach` is the short way, mm. Turns nearer than it to each other count once. Throws Error(cancelled) on request.
AxisJumps axis_jumps(const ImpactCurve& curve, double reach, const Progress& progress = Progress::none());

}  // namespace isopath
