#include "isopath/plan/plan_report.h"

#include <fmt/format.h>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "isopath/post/report.h"

namespace isopath {
namespace {

/// Four digits, or all those before the point, then in groups of three.
std::string text(double value) {
  if (!(value >= 1e4 && value < 1e12)) return fmt::format("{:.4g}", value);
  std::string digits = fmt::format("{:.0f}", value);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, "\u202f");
  return digits;
}

ReportTable figures_table(const PlanResult& result) {
  const PathFigures& f = result.figures;
  const GapReport& gap = result.gap;
  const double w = result.spacing;
  return {
      "Path",
      {{"area", text(gap.area), "mm²"},
       {"spacing", text(w), "mm", "Wanted distance between neighbouring passes."},
       {"pattern", std::string(name_of(std::optional(result.pattern)))},
       {"covering length", text(f.cover_length), "mm"},
       {"length ratio", text(result.length_ratio), "",
        "Covering length × spacing / area: 1 is the least that evenly spaced passes need."},
       {"links", text(f.links_length), "mm", "Moves on the surface between passes."},
       {"pieces", fmt::format("{}", f.pieces), "", "Stretches covered without leaving the surface."},
       {"lifts", fmt::format("{}", f.lifts)},
       {"smallest radius", f.min_radius < infinity ? text(f.min_radius) : "straight",
        f.min_radius < infinity ? "mm" : "", "Along covering moves."},
       {"sharp corners", fmt::format("{}", f.sharp_corners), "", "Turns by more than 45 degrees."},
       {"tight turns", fmt::format("{}", f.tight_turns), "", "Turns by more than 45 degrees within half a spacing."},
       {"time on the path", text(result.tool.points.empty() ? 0 : result.tool.points.back().time), "s",
        "Length over feed; accelerations are left out."}}};
}

/// For a ball only.
ReportTable gouge_table(const PlanResult& result) {
  const GougeReport& gouge = *result.gouge;
  const Vec3& p = gouge.place;
  return {"Gouges",
          {{"deepest cut into the part", text(gouge.deepest), "mm",
            gouge.deepest > 0 ? fmt::format("At ({}, {}, {}).", text(p.x()), text(p.y()), text(p.z())) : ""},
           {"way that cuts too deep", text(100 * gouge.share), "%", "Of covering moves and links."}}};
}

ReportTable coverage_table(const PlanResult& result) {
  const GapReport& gap = result.gap;
  const double w = result.spacing;
  return {"Coverage",
          {{"covered", text(100 * gap.covered_fraction), "%", "Share of the area whose gap is at most 1.02 × spacing."},
           {"widest gap", text(gap.max / w), "× spacing", "Twice the geodesic distance from the surface to the path."},
           {"gap of 99 %", text(gap.p99 / w), "× spacing", "99 % of the area have at most this gap."},
           {"mean gap", text(gap.mean / w), "× spacing"},
           {"evenness", text(gap.cv), "", "Standard deviation of the gap between passes over its mean."}}};
}

ReportTable scallop_table(const PlanResult& result) {
  const ScallopReport& measured = result.scallop->measured;
  return {"Scallop",
          {{"wanted", text(result.job.scallop), "mm", "Height of the cusps between passes."},
           {"lowest", text(measured.min), "mm", "Measured from the way of the ball; links and lifts do not cut."},
           {"mean", text(measured.mean), "mm"},
           {"99 % are below", text(measured.p99), "mm"},
           {"highest", text(measured.max), "mm"},
           {"sides without neighbour", text(100 * measured.open_share), "%", "Along rims, and where passes end."},
           {"almost as hollow as the ball", text(100 * result.scallop->clamped_fraction), "% of the area"},
           {"hollower than the ball", text(100 * result.scallop->gouged_fraction), "% of the area",
            "The ball gouges there."}}};
}

ReportTable patches_table(const PlanResult& result) {
  ReportTable table{"Patches", {}};
  const double w = result.spacing;
  for (std::size_t p = 0; p < result.patches.size(); ++p) {
    const PatchFigures& patch = result.patches[p];
    table.rows.push_back(
        {fmt::format("patch {}", p + 1), text(patch.area), "mm²",
         fmt::format("{}, {} mm in {} pieces; by itself {:.2f} % are covered, the widest gap is {} × spacing.",
                     name_of(std::optional(patch.pattern)), text(patch.cover_length), patch.pieces,
                     100 * patch.covered_fraction, text(patch.gap_max / w))});
  }
  return table;
}

ReportTable smoothing_table(const PlanResult& result) {
  const SmoothingFigures& smoothing = *result.smoothing;
  ReportTable table{"Smoothing",
                    {{"width", text(result.job.smooth), "mm", "Standard deviation of the averaging."},
                     {"widest gap before repair", text(smoothing.gap_before / result.spacing), "× spacing"},
                     {"gaps closed by", smoothing.repair ? std::string(name_of(*smoothing.repair)) : "nothing to close",
                      "", "The way that costs least, of those below: tight turns count as 5 spacings, lifts as 20."}}};
  for (const GapRepairCost& way : smoothing.costs) {
    table.rows.push_back({fmt::format("with {}", name_of(way.repair)),
                          fmt::format("{}{}", way.planned ? "" : "about ", text(way.length)), "mm",
                          way.planned ? fmt::format("{} lifts, {} tight turns, {} mm between passes.", way.lifts,
                                                    way.tight_turns, text(way.spacing))
                                      : "Estimated only, as it costs too much anyway."});
  }
  return table;
}

ReportTable spiral_table(const PlanResult& result) {
  const SpiralChoice& choice = *result.spiral;
  ReportTable table{"Spiral",
                    {{"levels",
                      choice.blended      ? "blended"
                      : choice.by_two_way ? "two-way"
                                          : "by the distance alone",
                      "", text_of(choice, result.gap.area, result.spacing) + "."}}};
  const auto add = [&](const char* name, const std::optional<CurveCost>& cost) {
    if (!cost) return;
    table.rows.push_back({name, text(cost->length), "mm",
                          fmt::format("{} lifts, {} sharp corners{}.", cost->lifts, cost->sharp_corners,
                                      cost->finished ? "" : ", before its gaps are closed")});
  };
  add("by the distance alone", choice.by_distance);
  add("blended", choice.by_blend);
  add("two-way", choice.by_two_way);
  return table;
}

/// The number of its patch at every vertex that is shown, counted from 1.
std::vector<double> patches_at_vertices(const PlanResult& result) {
  const RefinedMesh& shown = result.display.refined;
  std::vector<double> number(shown.mesh.n_vertices(), infinity);
  for (Index f = 0; f < shown.mesh.n_faces(); ++f) {
    for (const Index v : shown.mesh.triangle(f)) number[v] = result.patch_of_face[shown.old_face[f]] + 1;
  }
  return number;
}

std::vector<ReportIsoline> isolines_of(const PlanResult& result) {
  std::vector<ReportIsoline> lines;
  for (const Contour& contour : result.impact.contours) {
    ReportIsoline& line = lines.emplace_back();
    line.closed = contour.closed;
    line.level = contour.level;
    for (const SurfacePoint& point : contour.points) line.points.push_back(position_of(result.part.mesh, point));
  }
  return lines;
}

}  // namespace

std::string plan_report(const PlanResult& result) {
  const double w = result.spacing;
  ReportData data;
  data.title = result.job.mesh.filename().string();
  data.subtitle = fmt::format("{} path, {} mm between passes", name_of(std::optional(result.pattern)), text(w));
  data.mesh = &result.part.mesh;
  data.shown = &result.display.refined;
  data.scalars = {
      {.name = result.pattern == Pattern::planar ? "height"
               : result.smoothing                ? "smoothed distance"
                                                 : "distance",
       .unit = "mm",
       .values = result.display.distances},
      {.name = "gap", .unit = "mm", .values = result.display.gap, .least = 0, .greatest = 2 * w, .limit = 1.02 * w}};
  if (result.scallop) {
    const double wanted = result.job.scallop;
    data.scalars.push_back(
        {.name = "scallop",
         .unit = "mm",
         .values = interpolated(result.part.mesh, result.scallop->measured.vertex_height, result.display.refined),
         .least = 0,
         .greatest = 2 * wanted,
         .limit = 1.02 * wanted});
  }
  if (!result.patches.empty()) {
    data.scalars.push_back({.name = "patch", .unit = "", .values = patches_at_vertices(result)});
    data.subtitle += fmt::format(", {} patches", result.patches.size());
  }
  data.isolines = isolines_of(result);
  data.impact = &result.impact.curve;
  data.tool = &result.tool;
  data.tables = {figures_table(result), coverage_table(result)};
  if (result.gouge) data.tables.push_back(gouge_table(result));
  if (result.scallop) data.tables.push_back(scallop_table(result));
  if (!result.patches.empty()) data.tables.push_back(patches_table(result));
  if (result.spiral) data.tables.push_back(spiral_table(result));
  if (result.smoothing) data.tables.push_back(smoothing_table(result));
  data.histograms = {{.title = "Gap over the surface",
                      .unit = "mm",
                      .bin_width = w / 20,
                      .shares = result.gap.histogram,
                      .marks = {{w, "spacing"}},
                      .limit = 1.02 * w}};
  data.warnings = result.warnings;
  return report_html(data);
}

}  // namespace isopath
