#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"
#include "isopath/plan/job.h"
#include "isopath/plan/yaml_fields.h"

namespace isopath {
namespace {

namespace fs = std::filesystem;

constexpr const char* surface_normal = "surface_normal";
constexpr const char* fixed_direction = "fixed_direction";

fs::path resolved(const fs::path& path, const fs::path& folder) {
  return path.is_absolute() ? path : (folder / path).lexically_normal();
}

/// The path as seen from `folder`. Symbolic links are followed first, since `..` would step out of their target.
std::string seen_from(const fs::path& path, const fs::path& folder) {
  // Absolute first: a relative folder that does not exist yet stays relative, and nothing is relative to it.
  const fs::path from = fs::weakly_canonical(fs::absolute(folder.empty() ? fs::path(".") : folder));
  return fs::relative(fs::weakly_canonical(fs::absolute(path)), from).generic_string();
}

AxisMode axis_mode_of(const std::string& name) {
  if (name == surface_normal) return AxisMode::surface_normal;
  if (name == fixed_direction) return AxisMode::fixed_direction;
  throw Error(
      ErrorCode::bad_usage, "unknown axis mode",
      {.value = fmt::format("'{}'", name), .advice = fmt::format("allowed: {}, {}", surface_normal, fixed_direction)});
}

void read_tool(YamlFields fields, ToolOptions& tool) {
  constexpr NumberRange positive = {.least = 0, .least_excluded = true};
  fields.read_text("process", [&](const std::string& text) { tool.process = process_of(text); });
  fields.read("stand_off", tool.stand_off, positive);
  fields.read("ball_diameter", tool.ball_diameter, positive);
  fields.read_text("axis", [&](const std::string& text) { tool.axis_mode = axis_mode_of(text); });
  fields.read("fixed_axis", tool.fixed_axis);
  fields.read("cover_feed_mm_per_min", tool.cover_feed_mm_per_min, positive);
  fields.read("link_feed_mm_per_min", tool.link_feed_mm_per_min, positive);
  fields.read("rapid_speed_mm_per_min", tool.rapid_speed_mm_per_min, positive);
  fields.read("chord_tolerance", tool.chord_tolerance, {.least = 0});
  fields.read("axis_tolerance", tool.axis_tolerance, {.least = 0});
  fields.finish();
}

void read_partition(YamlFields fields, PartitionOptions& partition) {
  fields.read_text("by", [&](const std::string& text) { partition.by = partition_of(text); });
  fields.read("crease_angle", partition.crease_angle, {.least = 0, .least_excluded = true});
  fields.read("unevenness", partition.unevenness, {.least = 1, .least_excluded = true});
  fields.finish();
}

std::string vector_text(const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

std::string list_text(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += (list.empty() ? "" : ", ") + yaml_quoted(text);
  return "[" + list + "]";
}

std::string tool_yaml(const ToolOptions& tool) {
  std::string text = "tool:\n";
  const auto line = [&](const char* key, const auto& value) { text += fmt::format("  {}: {}\n", key, value); };
  line("process", name_of(tool.process));
  line("stand_off", tool.stand_off);
  line("ball_diameter", tool.ball_diameter);
  line("axis", tool.axis_mode == AxisMode::surface_normal ? surface_normal : fixed_direction);
  line("fixed_axis", vector_text(tool.fixed_axis));
  line("cover_feed_mm_per_min", tool.cover_feed_mm_per_min);
  line("link_feed_mm_per_min", tool.link_feed_mm_per_min);
  line("rapid_speed_mm_per_min", tool.rapid_speed_mm_per_min);
  line("chord_tolerance", tool.chord_tolerance);
  line("axis_tolerance", tool.axis_tolerance);
  return text;
}

}  // namespace

Job read_job(const fs::path& path) {
  const std::string file = path.string();
  YamlFields fields(parse_yaml(read_whole_file(path), file), file);
  const fs::path folder = path.parent_path();

  Job job;
  fields.read_text("mesh", [&](const std::string& text) { job.mesh = resolved(text, folder); });
  if (job.mesh.empty()) fields.missing("mesh", "name the mesh file to plan on, relative to the job file");
  fields.read_text("unit", [&](const std::string& text) { job.unit = unit_of(text); });
  if (fields.has("sources")) job.sources.clear();
  fields.read_texts("sources", [&](const std::string& text) {
    job.sources.push_back(parse_source_spec(text));
    if (!job.sources.back().file.empty()) job.sources.back().file = resolved(job.sources.back().file, folder);
  });
  fields.read_text("pattern", [&](const std::string& text) { job.pattern = pattern_of(text); });
  fields.read_text("blend", [&](const std::string& text) { job.blend = blending_of(text); });
  fields.read("planar_direction", job.planar_direction);
  fields.read("spacing", job.spacing, {.least = 0});
  fields.read("scallop", job.scallop, {.least = 0});
  fields.read("smooth", job.smooth, {.least = 0});
  fields.read("clearance", job.clearance, {.least = 0});
  fields.read("circle_radius", job.circle_radius, {.least = 0});
  fields.read("circle_step", job.circle_step, {.least = 0});
  fields.read("min_radius", job.min_radius, {.least = 0});
  read_partition(fields.section("partition"), job.partition);
  read_tool(fields.section("tool"), job.tool);
  fields.read_texts("programs", [&](const std::string& text) {
    check_program_format(text);
    job.programs.push_back(text);
  });
  fields.read("report", job.report);
  fields.finish();
  try {
    job.validate();
  } catch (const Error& error) {
    throw Error(ErrorCode::bad_input, error.summary(), error.where()).in_file(file);
  }
  return job;
}

std::string job_yaml(const Job& job, const fs::path& folder) {
  std::vector<std::string> sources;
  for (SourceSpec spec : job.sources) {
    if (!spec.file.empty()) spec.file = seen_from(spec.file, folder);
    sources.push_back(text_of(spec));
  }
  std::string text = "# A job of isopath: lengths in mm, angles in radians, paths relative to this file.\n";
  const auto line = [&](const char* key, const auto& value) { text += fmt::format("{}: {}\n", key, value); };
  line("mesh", yaml_quoted(seen_from(job.mesh, folder)));
  line("unit", name_of(job.unit));
  line("sources", list_text(sources));
  line("pattern", name_of(job.pattern));
  line("blend", name_of(job.blend));
  line("planar_direction", vector_text(job.planar_direction));
  line("spacing", job.spacing);
  line("scallop", job.scallop);
  line("smooth", job.smooth);
  line("clearance", job.clearance);
  line("circle_radius", job.circle_radius);
  line("circle_step", job.circle_step);
  line("min_radius", job.min_radius);
  text += fmt::format("partition:\n  by: {}\n  crease_angle: {}\n  unevenness: {}\n", name_of(job.partition.by),
                      job.partition.crease_angle, job.partition.unevenness);
  text += tool_yaml(job.tool);
  line("programs", list_text(job.programs));
  line("report", job.report);
  return text;
}

}  // namespace isopath
