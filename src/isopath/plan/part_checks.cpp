#include "isopath/plan/part_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/post/export.h"

namespace isopath {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double smallest_part = 5;  ///< mm
constexpr double smallest_with_unit = 1;
constexpr double largest_part = 20000;  ///< mm
constexpr Index many_pieces = 50;
constexpr Index triangles_of_a_scrap = 4;
constexpr double most_gap = 1.1;  ///< spacings: beyond what meshes and roundings account for
constexpr double jump = 30 * degree;
constexpr double facing_away = degree;  ///< beyond a right angle
constexpr double share_out_of_reach = 1e-3;
/// So many passes across a part of a metre lie 0.05 mm apart, finer than any finishing. More of them are a slip of the
/// keyboard or of the unit, and would run for days.
constexpr double most_passes = 20000;

/// What of the area that the sources reach a tool does not.
struct OffArea {
  double share = 0;
  Index worst = no_index;  ///< triangle
};
/// `excess` is how far a triangle is beyond the limit, above 0 where it is.
template <class Excess>
OffArea off_area(const TriangleMesh& mesh, std::span<const double> distances, const Excess& excess) {
  OffArea off;
  double reached = 0;
  double area_off = 0;
  double most = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const Triangle& corners = mesh.triangle(f);
    if (!std::all_of(corners.begin(), corners.end(), [&](Index v) { return distances[v] < infinity; })) continue;
    const double area = mesh.face_area(f);
    reached += area;
    const double by = excess(mesh.face_normal(f));
    if (!(by > 0)) continue;
    area_off += area;
    if (!(by > most)) continue;
    most = by;
    off.worst = f;
  }
  if (area_off > 0) off.share = area_off / reached;
  return off;
}

std::string place_of(const TriangleMesh& mesh, Index face) {
  const Vec3 place = mesh.position(mesh.triangle(face)[0]);
  return fmt::format("triangle {} at ({:.4g}, {:.4g}, {:.4g})", face, place.x(), place.y(), place.z());
}

double degrees_between(const Vec3& a, const Vec3& b) { return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) / degree; }

void check_facing(const TriangleMesh& mesh, std::span<const double> distances, const ToolOptions& tool) {
  if (tool.axis_mode != AxisMode::fixed_direction) return;
  const Vec3 axis = tool.fixed_axis.normalized();
  const OffArea away = off_area(mesh, distances, [&](const Vec3& n) { return -std::sin(facing_away) - n.dot(axis); });
  if (away.share <= share_out_of_reach) return;
  throw Error(ErrorCode::no_plan, "the surface faces away from the fixed tool axis",
              {.element = place_of(mesh, away.worst),
               .value = fmt::format("{:.1f} degrees between normal and axis, limit 90; {:.3g} % of the area",
                                    degrees_between(mesh.face_normal(away.worst), axis), 100 * away.share),
               .advice = "use the surface normal as axis, turn the part, or cover only the part that faces the tool"});
}

void check_tilt(const TriangleMesh& mesh, std::span<const double> distances, const std::string& format) {
  const OffArea off = off_area(mesh, distances, [&](const Vec3& n) {
    return n.isZero(0) || holds_axis(format, n) ? 0 : degrees_between(n, Vec3::UnitZ());
  });
  if (off.share <= share_out_of_reach) return;
  const bool three_axes = format == "gcode3";
  throw Error(
      ErrorCode::no_plan, fmt::format("the tool stands along the surface's normal, which a program {} cannot", format),
      {.element = place_of(mesh, off.worst),
       .value = fmt::format("{:.1f} degrees off +Z{}; {:.3g} % of the area",
                            degrees_between(mesh.face_normal(off.worst), Vec3::UnitZ()),
                            three_axes ? "" : ", farther than the table tilts", 100 * off.share),
       .advice = three_axes ? "keep the tool's axis fixed (--axis 0,0,1), or take a format for 5 axes or poses"
                            : "turn the part, cover only what the tool can reach, or take poses (--post yaml)"});
}

}  // namespace

std::optional<std::string> warning_of_size(double size, bool has_unit) {
  if (size < smallest_part && size >= smallest_with_unit && has_unit) return std::nullopt;
  if (size >= smallest_part && size <= largest_part) return std::nullopt;
  return fmt::format("the part measures {:.4g} mm: if its file is in {}, give --unit (in a job: unit)", size,
                     size < smallest_part ? "metres or inches" : "another unit than mm");
}

std::optional<std::string> warning_of_pieces(const TriangleMesh& mesh) {
  const Index pieces = mesh.n_components();
  if (pieces < many_pieces) return std::nullopt;
  return fmt::format(
      "the part is in {} separate pieces{}: each is covered by itself, with lifts from one to the next", pieces,
      mesh.n_faces() < triangles_of_a_scrap * pieces
          ? fmt::format(", of {:.2g} triangles on average: its file may hold no surface but loose triangles",
                        static_cast<double>(mesh.n_faces()) / static_cast<double>(pieces))
          : "");
}

std::optional<std::string> warning_of_tool(const ToolOptions& tool, double size) {
  const bool is_spray = tool.process == Process::spray;
  const double length = is_spray ? tool.stand_off : tool.ball_diameter;
  // a spray gun is often farther away than its part is large
  if (length <= (is_spray ? 10 * size : size)) return std::nullopt;
  return fmt::format(
      "the {} of {:.4g} mm is larger than the part, {:.4g} mm: check both, and the unit of the mesh file",
      is_spray ? "stand-off" : "ball", length, size);
}

std::optional<std::string> warning_of_gap(const TriangleMesh& mesh, const GapReport& gap, double spacing) {
  if (!(gap.max > most_gap * spacing) || !(gap.max < infinity)) return std::nullopt;
  std::string place;  // samples within large triangles may see what no vertex does
  const auto worst = std::max_element(gap.vertex_gap.begin(), gap.vertex_gap.end(), [](double a, double b) {
    return (a < infinity ? a : 0) < (b < infinity ? b : 0);  // no pass reaches components without a source
  });
  if (worst != gap.vertex_gap.end() && *worst > most_gap * spacing) {
    const Vec3 p = mesh.position(static_cast<Index>(worst - gap.vertex_gap.begin()));
    place = fmt::format(", near ({:.4g}, {:.4g}, {:.4g})", p.x(), p.y(), p.z());
  }
  return fmt::format(
      "passes leave a gap of {:.3f} × spacing at most{}: a smaller spacing, a smaller radius of turns, less smoothing "
      "or "
      "another pattern narrows it",
      gap.max / spacing, place);
}

void check_pass_count(std::span<const double> values, double spacing) {
  double low = infinity;
  double high = -infinity;
  for (const double value : values) {
    if (!(value < infinity)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(high - low > most_passes * spacing)) return;
  throw Error(
      ErrorCode::bad_usage, "the spacing is too small for the part",
      {.element = "spacing",
       .value = fmt::format("{:.6g} mm makes {:.3g} passes, limit {}", spacing, (high - low) / spacing, most_passes),
       .advice = fmt::format("give {:.3g} mm or more, or the unit of the mesh file when that is not mm",
                             1.001 * (high - low) / most_passes)});
}

void warn_of_unreached(const TriangleMesh& mesh, std::span<const double> distances,
                       std::vector<std::string>& warnings) {
  std::vector<char> reached(mesh.n_components(), 0);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    for (const Index v : mesh.triangle(f)) {
      if (distances[v] < infinity) reached[mesh.component_of(f)] = 1;
    }
  }
  const auto unreached = std::count(reached.begin(), reached.end(), 0);
  if (unreached == 0) return;
  warnings.push_back(
      fmt::format("{} of the part's {} components hold no source and are not covered", unreached, mesh.n_components()));
}

void check_reach(const TriangleMesh& mesh, std::span<const double> distances, const Job& job) {
  check_facing(mesh, distances, job.tool);
  if (job.tool.axis_mode == AxisMode::fixed_direction) return;  // the job was checked for that
  for (const std::string& format : job.programs) check_tilt(mesh, distances, format);
}

AxisJumps axis_jumps(const ImpactCurve& curve, double reach, const Progress& progress) {
  AxisJumps jumps;
  std::vector<double> arc(curve.points.size(), 0.0);
  std::size_t first = 0;  // of the stretch without lifts, within reach
  double last_jump = -infinity;
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    if (i % 256 == 0) progress.checkpoint();
    const ImpactPoint& point = curve.points[i];
    arc[i] = arc[i - 1] + (point.position - curve.points[i - 1].position).norm();
    if (point.kind == MoveKind::lift) {
      first = i;
      continue;
    }
    while (arc[i] - arc[first] > reach && first + 1 < i) ++first;
    double cosine = 1;
    for (std::size_t j = first; j < i; ++j) cosine = std::min(cosine, curve.points[j].normal.dot(point.normal));
    const double most = std::acos(std::max(cosine, -1.0));
    if (most <= jump) continue;
    if (arc[i] - last_jump > reach) ++jumps.count;
    last_jump = arc[i];
    if (most <= jumps.worst) continue;
    jumps.worst = most;
    jumps.at = point.position;
  }
  return jumps;
}

}  // namespace isopath
