#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands.h"
#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"
#include "isopath/plan/job.h"
#include "isopath/post/csv.h"
#include "isopath/post/export.h"
#include "shared_options.h"

namespace isopath::app {
namespace {

struct ExportArguments {
  std::string path;
  std::string format;
  std::string output;
  std::string process;  ///< empty: of the job beside the path
  double spindle_rpm = GcodeOptions{}.spindle_rpm;
  double retract = GcodeOptions{}.retract;
};

ToolPath read_path(const std::filesystem::path& file) {
  try {
    return read_tool_csv(read_whole_file(file));
  } catch (const Error& error) {
    throw error.in_file(file.string());
  }
}

Process process_for(const ExportArguments& arguments, const std::filesystem::path& folder) {
  if (!arguments.process.empty()) return process_of(arguments.process);
  const std::filesystem::path job = folder / "job.yaml";
  return std::filesystem::exists(job) ? read_job(job).tool.process : ToolOptions{}.process;
}

void run_export(const CLI::App& command, const ExportArguments& arguments, const CommonFlags& flags) {
  check_program_format(arguments.format);
  std::filesystem::path file = arguments.path;
  if (std::filesystem::is_directory(file)) file /= "tool.csv";
  GcodeOptions options;
  options.process = process_for(arguments, file.parent_path());
  options.spindle_rpm = arguments.spindle_rpm;
  options.retract = arguments.retract;
  const bool is_gcode = arguments.format.starts_with("gcode");
  const std::string to = fmt::format("to {}", arguments.format);
  const bool is_spray = options.process == Process::spray;
  const std::vector<std::string> idle =
      warnings_of_idle(command, {{"--process", !is_gcode, to},
                                 {"--spindle-rpm", !is_gcode || is_spray, is_gcode ? "process spray" : to},
                                 {"--retract", !is_gcode, to}});
  print_warnings(flags, idle);
  ConsoleProgress progress(flags.quiet);
  progress.stage("export");
  const ToolPath path = read_path(file);
  const std::string content = export_tool_path(path, arguments.format, options);
  progress.checkpoint();
  write_file_atomically(arguments.output, content);
  if (!flags.json) return;
  const nlohmann::ordered_json report = {{"points", path.points.size()},
                                         {"format", arguments.format},
                                         {"bytes", content.size()},
                                         {"output", arguments.output},
                                         {"warnings", idle}};
  print_json(report);
}

std::string format_help() {
  std::string text = "FORMAT is one of\n";
  for (const ExportFormat& format : export_formats())
    text += fmt::format("    {:<8} {}\n", format.name, format.summary);
  return text;
}

}  // namespace

void add_export(CLI::App& app, CommonFlags& flags, Action& action) {
  auto* command = app.add_subcommand("export", "Write a planned path in another format");
  const auto arguments = std::make_shared<ExportArguments>();
  command->add_option("PATH", arguments->path, "The folder that 'plan' wrote, or a tool.csv")->required();
  command->add_option("--to", arguments->format, "Format, see below")->type_name("FORMAT")->required();
  command->add_option("-o,--output", arguments->output, "File to write")->required();
  command->add_option("--process", arguments->process,
                      "spray, mill or grind; without it, what the job beside the path says");
  command->add_option("--spindle-rpm", arguments->spindle_rpm, "G-code for mill and grind")->capture_default_str();
  command->add_option("--retract", arguments->retract, "G-code: way of approach and retreat, mm")
      ->capture_default_str();
  add_common_flags(*command, flags);
  command->footer(
      "Examples:\n"
      "  isopath export out --to gcode5 -o part.ngc\n"
      "  isopath export out/tool.csv --to yaml -o poses.yaml\n\n" +
      format_help());
  command->callback([&flags, &action, arguments, command] {
    action = [&flags, arguments, command] { run_export(*command, *arguments, flags); };
  });
}

}  // namespace isopath::app
