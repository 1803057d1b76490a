#include "isopath/plan/plan_outputs.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "isopath/core/side_by_side.h"
#include "isopath/plan/make_programs.h"
#include "isopath/plan/plan_report.h"
#include "isopath/post/csv.h"
#include "isopath/post/export.h"
#include "isopath/post/path_vtp.h"

namespace isopath {
namespace {

nlohmann::ordered_json tight_json(const PlanResult& result) {
  nlohmann::ordered_json places = nlohmann::ordered_json::array();
  for (const TightPlace& place : result.tight) {
    const Vec3& p = place.position;
    places.push_back({{"at", {p.x(), p.y(), p.z()}}, {"radius", place.radius}});
  }
  return places;
}

nlohmann::ordered_json gouge_json(const GougeReport& gouge) {
  const Vec3& p = gouge.place;
  nlohmann::ordered_json json = {{"deepest", gouge.deepest}, {"share", gouge.share}};
  if (gouge.deepest > 0) json["at"] = {p.x(), p.y(), p.z()};
  return json;
}

nlohmann::ordered_json scallop_json(const PlanResult& result) {
  const ScallopReport& measured = result.scallop->measured;
  return {{"wanted", result.job.scallop},
          {"min", measured.min},
          {"mean", measured.mean},
          {"p99", measured.p99},
          {"max", measured.max},
          {"open_share", measured.open_share},
          {"clamped_fraction", result.scallop->clamped_fraction},
          {"gouged_fraction", result.scallop->gouged_fraction}};
}

nlohmann::ordered_json patches_json(const PlanResult& result) {
  nlohmann::ordered_json patches = nlohmann::ordered_json::array();
  for (const PatchFigures& patch : result.patches) {
    patches.push_back(
        {{"pattern", name_of(std::optional(patch.pattern))},
         {"area", patch.area},
         {"cover_length", patch.cover_length},
         {"pieces", patch.pieces},
         {"gap",
          {{"max", patch.gap_max / result.spacing}, {"p99", patch.gap_p99 / result.spacing}, {"cv", patch.evenness}}},
         {"covered_fraction", patch.covered_fraction}});
  }
  return patches;
}

nlohmann::ordered_json smoothing_json(const PlanResult& result) {
  const SmoothingFigures& smoothing = *result.smoothing;
  nlohmann::ordered_json json = {{"width", result.job.smooth},
                                 {"gap_before_repair", smoothing.gap_before / result.spacing},
                                 {"repair", smoothing.repair ? name_of(*smoothing.repair) : "none"},
                                 {"ways", nlohmann::ordered_json::array()}};
  for (const GapRepairCost& way : smoothing.costs) {
    json["ways"].push_back({{"repair", name_of(way.repair)},
                            {"length", way.length},
                            {"lifts", way.lifts},
                            {"tight_turns", way.tight_turns},
                            {"spacing", way.spacing},
                            {"planned", way.planned}});
  }
  return json;
}

nlohmann::ordered_json spiral_json(const PlanResult& result) {
  const SpiralChoice& choice = *result.spiral;
  nlohmann::ordered_json json = {{"blended", choice.blended},
                                 {"why", text_of(choice, result.gap.area, result.spacing)}};
  const auto add = [&](const char* name, const std::optional<CurveCost>& cost) {
    if (!cost) return;
    json[name] = {{"length", cost->length},
                  {"lifts", cost->lifts},
                  {"sharp_corners", cost->sharp_corners},
                  {"finished", cost->finished}};
  };
  add("by_distance", choice.by_distance);
  add("by_blend", choice.by_blend);
  add("by_two_way", choice.by_two_way);
  return json;
}

}  // namespace

std::string summary_json(const PlanResult& result) {
  using Json = nlohmann::ordered_json;
  const PathFigures& figures = result.figures;
  const GapReport& gap = result.gap;
  const auto over_spacing = [&](double length) { return length / result.spacing; };
  Json times = Json::object();
  double total = 0;
  for (const StageTime& time : result.times) {
    times[time.stage] = time.seconds;
    total += time.seconds;
  }
  times["total"] = total;
  Json summary = {{"area", gap.area},
                  {"spacing", result.spacing},
                  {"pattern", name_of(std::optional(result.pattern))},
                  {"cover_length", figures.cover_length},
                  {"length_ratio", result.length_ratio},
                  {"pieces", figures.pieces},
                  {"lifts", figures.lifts},
                  {"links_length", figures.links_length},
                  {"gap",
                   {{"max", over_spacing(gap.max)},
                    {"p99", over_spacing(gap.p99)},
                    {"mean", over_spacing(gap.mean)},
                    {"cv", gap.cv}}},
                  {"covered_fraction", gap.covered_fraction},
                  {"min_radius", figures.min_radius},
                  {"sharp_corners", figures.sharp_corners},
                  {"tight_turns", figures.tight_turns},
                  {"path_time_s", result.tool.points.empty() ? 0 : result.tool.points.back().time},
                  {"time_s", std::move(times)},
                  {"peak_memory_mb", result.peak_memory_mb},
                  {"warnings", result.warnings}};
  if (result.gouge) summary["gouge"] = gouge_json(*result.gouge);
  if (result.job.min_radius > 0) summary["tight_places"] = tight_json(result);
  if (!result.patches.empty()) summary["patches"] = patches_json(result);
  if (result.scallop) summary["scallop"] = scallop_json(result);
  if (result.spiral) summary["spiral"] = spiral_json(result);
  if (result.smoothing) summary["smoothing"] = smoothing_json(result);
  // a file may have any name, JSON only holds UTF-8
  return summary.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::vector<OutputFile> plan_outputs(const PlanResult& result, const std::filesystem::path& folder) {
  std::vector<OutputFile> files;
  OutputFile report{"report.html", {}};
  side_by_side(
      [&] {
        files = {{"summary.json", summary_json(result)},
                 {"impact.csv", impact_csv(result.impact.curve)},
                 {"tool.csv", tool_csv(result.tool)},
                 {"path.vtp", path_vtp(result.tool)},
                 {"job.yaml", job_yaml(result.job, folder)}};
      },
      [&] {
        if (result.job.report) report.content = plan_report(result);
      });
  files.insert(files.end(), result.programs.begin(), result.programs.end());
  if (result.job.report) files.push_back(std::move(report));
  return files;
}

std::vector<std::string> earlier_programs(const std::filesystem::path& folder,
                                          const std::vector<OutputFile>& programs) {
  std::vector<std::string> names;
  for (const ExportFormat& format : export_formats()) {
    const std::string name = program_name(format.name);
    const bool is_new =
        std::any_of(programs.begin(), programs.end(), [&](const OutputFile& program) { return program.name == name; });
    std::error_code ignored;  // what cannot be seen misleads nobody
    if (!is_new && std::filesystem::exists(folder / name, ignored)) names.push_back(name);
  }
  return names;
}

void write_outputs(const PlanResult& result, const std::filesystem::path& folder, Progress& progress) {
  progress.stage("write");
  const std::vector<OutputFile> files = plan_outputs(result, folder);
  progress.checkpoint();
  write_output_folder(folder, files, progress);
}

}  // namespace isopath
