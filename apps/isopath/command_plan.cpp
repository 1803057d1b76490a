#include <fmt/format.h>

#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commands.h"
#include "isopath/core/error.h"
#include "isopath/plan/job.h"
#include "isopath/plan/output_folder.h"
#include "isopath/plan/plan_outputs.h"
#include "isopath/plan/run_plan.h"
#include "isopath/post/export.h"
#include "shared_options.h"

namespace isopath::app {
namespace {

/// What was given on the command line; what was not leaves the job as it is.
struct PlanArguments {
  std::string input;
  std::string output;
  std::optional<std::string> unit;
  std::vector<std::string> sources;
  std::optional<std::string> pattern;
  bool blend = false;
  std::optional<std::string> blend_form;
  std::vector<double> direction;
  std::optional<double> spacing;
  std::optional<double> scallop;
  std::optional<double> smooth;
  std::optional<double> clearance;
  std::optional<double> circle_radius;
  std::optional<double> circle_step;
  std::optional<double> min_radius;
  std::optional<std::string> partition;
  std::optional<double> crease_angle;
  std::optional<double> unevenness;
  std::optional<std::string> process;
  std::optional<std::string> tool;
  std::optional<double> stand_off;
  std::vector<double> axis;
  std::optional<double> feed;
  std::optional<double> link_feed;
  std::optional<double> rapid;
  std::vector<std::string> formats;
  bool no_report = false;
};

template <class Value>
void replace(Value& value, const std::optional<Value>& given) {
  if (given) value = *given;
}

/// `ball:D`.
double ball_diameter_of(const std::string& text) {
  constexpr std::string_view prefix = "ball:";
  double diameter = 0;
  if (!text.starts_with(prefix) || !number_above_0()(text.substr(prefix.size())).empty() ||
      !CLI::detail::lexical_cast(text.substr(prefix.size()), diameter)) {
    refuse_value("option --tool", text, "ball:DIAMETER with a diameter above 0, for example ball:10");
  }
  return diameter;
}

void apply_tool(const PlanArguments& given, ToolOptions& tool) {
  if (given.process) tool.process = process_of(*given.process);
  if (given.tool) tool.ball_diameter = ball_diameter_of(*given.tool);
  replace(tool.stand_off, given.stand_off);
  if (!given.axis.empty()) {
    tool.axis_mode = AxisMode::fixed_direction;
    tool.fixed_axis = Vec3(given.axis[0], given.axis[1], given.axis[2]);
  }
  replace(tool.cover_feed_mm_per_min, given.feed);
  replace(tool.link_feed_mm_per_min, given.link_feed ? given.link_feed : given.feed);
  replace(tool.rapid_speed_mm_per_min, given.rapid);
}

Job job_of(const PlanArguments& given) {
  const std::string extension = extension_of(given.input);
  Job job;
  if (extension == ".yaml" || extension == ".yml") {
    job = read_job(given.input);
  } else {
    job.mesh = given.input;
  }
  if (given.unit) job.unit = unit_of(*given.unit);
  if (!given.sources.empty()) job.sources = parse_sources(given.sources);
  if (given.pattern) job.pattern = pattern_of(*given.pattern);
  if (given.blend) job.blend = Blending::least;
  if (given.blend_form) job.blend = blending_of(*given.blend_form);
  if (!given.direction.empty()) job.planar_direction = Vec3(given.direction[0], given.direction[1], given.direction[2]);
  // each gives the distance between passes: what is given last, here, replaces what the file gives
  if (given.spacing || given.scallop) job.spacing = job.scallop = 0;
  replace(job.spacing, given.spacing);
  replace(job.scallop, given.scallop);
  replace(job.smooth, given.smooth);
  replace(job.clearance, given.clearance);
  replace(job.circle_radius, given.circle_radius);
  replace(job.circle_step, given.circle_step);
  replace(job.min_radius, given.min_radius);
  if (given.partition) job.partition.by = partition_of(*given.partition);
  if (given.crease_angle) job.partition.crease_angle = *given.crease_angle * std::numbers::pi / 180;
  replace(job.partition.unevenness, given.unevenness);
  apply_tool(given, job.tool);
  if (!given.formats.empty()) job.programs = given.formats;
  if (given.no_report) job.report = false;
  job.validate();
  return job;
}

/// What smoothing opened, how it was closed, and what the other ways would have cost.
std::string smoothing_text(const PlanResult& result) {
  const SmoothingFigures& smoothing = *result.smoothing;
  std::string text =
      fmt::format("  smoothing        gaps up to {:.3f} × spacing", smoothing.gap_before / result.spacing);
  if (!smoothing.repair) return text + "\n";
  text += fmt::format(", closed by {}:\n", name_of(*smoothing.repair));
  for (const GapRepairCost& way : smoothing.costs) {
    text +=
        fmt::format("    {:<14} {}{:.5g} mm, lifts {}, tight turns {}, {:.4g} mm between passes\n", name_of(way.repair),
                    way.planned ? "" : "about ", way.length, way.lifts, way.tight_turns, way.spacing);
  }
  return text;
}

/// Five digits, and all those before the point: nobody reads an area with a power of ten.
std::string rounded(double value) {
  return value >= 1e5 && value < 1e12 ? fmt::format("{:.0f}", value) : fmt::format("{:.5g}", value);
}

std::string text_summary(const PlanResult& result, const std::string& folder) {
  const PathFigures& f = result.figures;
  const GapReport& gap = result.gap;
  const double w = result.spacing;
  std::string text = fmt::format("{} path, {:.4g} mm between passes\n", name_of(std::optional(result.pattern)), w);
  text += fmt::format("  covering length  {} mm ({:.3f} of area / spacing)\n", rounded(f.cover_length),
                      result.length_ratio);
  text += fmt::format("  covered          {:.2f} % of {} mm²\n", 100 * gap.covered_fraction, rounded(gap.area));
  text += fmt::format("  gap              {:.3f} × spacing at most, {:.3f} for 99 % of the area\n", gap.max / w,
                      gap.p99 / w);
  if (result.scallop) {
    const ScallopReport& cusps = result.scallop->measured;
    text += fmt::format("  scallop          {:.4g} mm wanted; mean {:.4g}, 99 % below {:.4g}, highest {:.4g}\n",
                        result.job.scallop, cusps.mean, cusps.p99, cusps.max);
  }
  if (!result.patches.empty()) text += fmt::format("  patches          {}\n", result.patches.size());
  if (result.spiral) {
    text += fmt::format("  spiral           {}\n", text_of(*result.spiral, gap.area, w));
  }
  if (result.smoothing) text += smoothing_text(result);
  text += fmt::format("  pieces           {}, lifts {}, links {:.4g} mm\n", f.pieces, f.lifts, f.links_length);
  text += fmt::format("results in {}{}\n", folder, result.job.report ? "; look at its report.html" : "");
  return text;
}

/// What was given in vain, beside the other options and what the job file says. A file that a run wrote has all keys:
/// one counts as given where its value is not the default.
std::vector<std::string> idle_options(const CLI::App& command, const PlanArguments& given, const Job& job) {
  const Job plain;
  const std::string pattern = fmt::format("pattern {}", name_of(job.pattern));
  const std::string process = fmt::format("process {}", name_of(job.tool.process));
  const PartitionBy by = job.partition.by;
  const std::string partition = fmt::format("partition {}", name_of(by));
  const bool is_planar = job.pattern == Pattern::planar;
  const bool is_trochoidal = job.pattern == Pattern::trochoidal;
  const bool is_spray = job.tool.process == Process::spray;
  const bool by_normal = job.tool.axis_mode == AxisMode::surface_normal;
  const auto key = [](const char* name, const auto& value, const auto& standard) {
    return value == standard ? "" : name;
  };
  return warnings_of_idle(
      command,
      {{"--source", is_planar, pattern, key("sources", job.sources, plain.sources)},
       {"--direction", !is_planar, pattern, key("planar_direction", job.planar_direction, plain.planar_direction)},
       {"--blend", given.blend_form && !form_of(job.blend), fmt::format("blend-form {}", name_of(job.blend))},
       {"--circle-radius", !is_trochoidal, pattern, key("circle_radius", job.circle_radius, plain.circle_radius)},
       {"--circle-step", !is_trochoidal, pattern, key("circle_step", job.circle_step, plain.circle_step)},
       {"--crease-angle", by == PartitionBy::none || by == PartitionBy::medial, partition,
        key("partition.crease_angle", job.partition.crease_angle, plain.partition.crease_angle)},
       {"--unevenness", by == PartitionBy::none || by == PartitionBy::creases, partition,
        key("partition.unevenness", job.partition.unevenness, plain.partition.unevenness)},
       {"--tool", is_spray, process, key("tool.ball_diameter", job.tool.ball_diameter, plain.tool.ball_diameter)},
       {"--stand-off", !is_spray, process, key("tool.stand_off", job.tool.stand_off, plain.tool.stand_off)},
       {"--axis", by_normal, "axis surface_normal",
        key("tool.fixed_axis", job.tool.fixed_axis, plain.tool.fixed_axis)}});
}

void run_command(const CLI::App& command, const PlanArguments& arguments, const CommonFlags& flags) {
  const Job job = job_of(arguments);
  const std::vector<std::string> idle = idle_options(command, arguments, job);
  print_warnings(flags, idle);
  check_output_folder(arguments.output);  // before the work, not after it
  PlanResult result;
  {
    ConsoleProgress progress(flags.quiet);
    result = run_plan(job, progress);
    write_outputs(result, arguments.output, progress);
  }
  for (const std::string& name : earlier_programs(arguments.output, result.programs)) {
    result.warnings.push_back(fmt::format("{} in {} is of an earlier run", name, arguments.output));
  }
  print_warnings(flags, result.warnings);
  result.warn_of(idle);  // of the command, and not of the job that the folder holds
  print(flags.json ? summary_json(result) : text_summary(result, arguments.output));
}

void add_path_options(CLI::App& command, PlanArguments& given) {
  add_sources(command, given.sources);
  command
      .add_option(
          "--pattern", given.pattern,
          "auto: spiral where the isolines are closed, else meander; two-way where that is better;\n"
          "contour: a pass for every isoline; spiral; double-spiral: goes in and comes out again; meander;\n"
          "two-way: one closed curve without a lift; trochoidal: circles whose centre moves along the isolines;\n"
          "planar: cuts with parallel planes")
      ->default_str("auto");
  command.add_flag("--blend", given.blend,
                   "Blend the distances with the medial axis, so that the part gets one spiral");
  command
      .add_option("--blend-form", given.blend_form,
                  "Blend in this form: least, paper; none; or auto: least where that makes a better spiral")
      ->default_str("auto; least with --blend");
  command.add_option("--direction", given.direction, "planar: the direction the planes follow each other in, X,Y,Z")
      ->delimiter(',')
      ->expected(3)
      ->default_str("along the part's middle axis, so that passes are long");
  command.add_option("--spacing", given.spacing, "Distance between neighbouring passes, mm")
      ->check(number_above_0())
      ->default_str("1/60 of the part's size");
  command
      .add_option("--scallop", given.scallop,
                  "Height of the cusps that the ball leaves everywhere, mm, instead of a spacing: passes come closer\n"
                  "over ridges and lie farther apart in hollows")
      ->check(number_above_0());
  command
      .add_option("--smooth", given.smooth,
                  "Round the corners of passes: distances are smoothed over this width, mm, of which a spacing or two\n"
                  "is usual; gaps that open are closed in the way of least cost, where\n"
                  "a sharp corner counts as five spacings of path and a lift as 20")
      ->check(number_from_0())
      ->default_str("0: not at all");
  command.add_option("--clearance", given.clearance, "Height of lifts above the surface, mm")
      ->check(number_above_0())
      ->default_str("the spacing");
  command
      .add_option("--min-radius", given.min_radius,
                  "Smallest radius that the curve may turn with on the surface, mm; the summary lists places where it\n"
                  "cannot be kept")
      ->check(number_above_0())
      ->default_str("0.08 of the spacing for two-way curves");
}

void add_circle_options(CLI::App& command, PlanArguments& given) {
  command.add_option("--circle-radius", given.circle_radius, "trochoidal: greatest radius of the circles, mm")
      ->check(number_above_0())
      ->default_str("3 spacings");
  command.add_option("--circle-step", given.circle_step, "trochoidal: way of the circle's centre in one turn, mm")
      ->check(number_above_0())
      ->default_str("the spacing");
}

void add_partition_options(CLI::App& command, PlanArguments& given) {
  const PartitionOptions defaults;
  command
      .add_option("--partition", given.partition,
                  "Divide the part into patches, each planned from its own border: none; creases: at sharp edges;\n"
                  "medial: where wide and narrow places meet; both")
      ->default_str("none");
  command
      .add_option("--crease-angle", given.crease_angle,
                  "--partition creases: the angle between faces above which an edge is a border, degrees")
      ->check(number_above_0())
      ->default_str(fmt::format("{:.0f}", defaults.crease_angle * 180 / std::numbers::pi));
  command
      .add_option("--unevenness", given.unevenness,
                  "--partition medial: greatest over least distance of a patch's medial axis from its border")
      ->check(number_above_0())
      ->default_str(fmt::format("{}", defaults.unevenness));
}

void add_tool_options(CLI::App& command, PlanArguments& given) {
  const ToolOptions defaults;
  const auto text = [](double value) { return fmt::format("{}", value); };
  command.add_option("--process", given.process, "spray, mill or grind")->default_str("mill");
  command.add_option("--tool", given.tool, "mill, grind: ball:DIAMETER, mm")
      ->default_str("ball:" + text(defaults.ball_diameter));
  command.add_option("--stand-off", given.stand_off, "spray: distance of the nozzle, mm")
      ->check(number_above_0())
      ->default_str(text(defaults.stand_off));
  command.add_option("--axis", given.axis, "Keep the tool's axis fixed to X,Y,Z (3 axes) instead of along the normal")
      ->delimiter(',')
      ->expected(3);
  command.add_option("--feed", given.feed, "Speed of the tool's tip (spray: the nozzle) along covering moves, mm/min")
      ->check(number_above_0())
      ->default_str(text(defaults.cover_feed_mm_per_min));
  command.add_option("--link-feed", given.link_feed, "The same along links, mm/min")
      ->check(number_above_0())
      ->default_str("that of --feed");
  command.add_option("--rapid", given.rapid, "The same along lifts, mm/min")
      ->check(number_above_0())
      ->default_str(text(defaults.rapid_speed_mm_per_min));
}

std::string format_names() {
  std::string names;
  for (const ExportFormat& format : export_formats()) names += (names.empty() ? "" : ", ") + std::string(format.name);
  return names;
}

}  // namespace

void add_plan(CLI::App& app, CommonFlags& flags, Action& action) {
  auto* command = app.add_subcommand("plan", "The main job: everything from mesh to program and report");
  const auto arguments = std::make_shared<PlanArguments>();
  command->add_option("INPUT", arguments->input, "A mesh (STL, OBJ, PLY, OFF, STEP, IGES), or a job file (.yaml)")
      ->type_name("MESH|JOB.yaml")
      ->check(not_empty())
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "Folder for summary.json, impact.csv, tool.csv, path.vtp, the program, job.yaml and report.html;\n"
                   "other files in it stay")
      ->type_name("DIR")
      ->check(not_empty())
      ->required();
  command->add_option("--unit", arguments->unit, "Unit of the mesh file: mm, cm, m or inch")->default_str("mm");
  add_path_options(*command, *arguments);
  add_circle_options(*command, *arguments);
  add_partition_options(*command, *arguments);
  add_tool_options(*command, *arguments);
  command->add_option("--post", arguments->formats, "Format of the program: " + format_names() + "; may be repeated")
      ->type_name("FORMAT")
      ->allow_extra_args(false)
      ->default_str("gcode5, or yaml where the table cannot reach");
  command->add_flag("--no-report", arguments->no_report, "Do not write report.html");
  add_common_flags(*command, flags);
  command->footer(
      "Examples:\n"
      "  isopath plan blade.off --source boundary:0 --spacing 0.5 -o out\n"
      "  isopath plan door.stl --unit m --spacing 40 --process spray --stand-off 200 -o door\n"
      "  isopath plan die.stl --scallop 0.01 --tool ball:8 -o fine\n"
      "  isopath plan die.stl --pattern planar --direction 0,1,0 --axis 0,0,1 --post gcode3 -o die\n"
      "  isopath plan out/job.yaml --spacing 1 -o coarser\n\n"
      "The flags are shorthands for the job file and override it. The job of a run is written to\n"
      "DIR/job.yaml; running that again gives the same files, but for the times in summary.json.\n\n" +
      source_help());
  command->callback([&flags, &action, arguments, command] {
    action = [&flags, arguments, command] { run_command(*command, *arguments, flags); };
  });
}

}  // namespace isopath::app
