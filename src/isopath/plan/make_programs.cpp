#include "isopath/plan/make_programs.h"

#include <fmt/format.h>

#include <string_view>

#include "isopath/core/error.h"
#include "isopath/post/export.h"

namespace isopath {
namespace {

std::string_view suffix_of(std::string_view format) {
  for (const ExportFormat& known : export_formats()) {
    if (known.name == format) return known.suffix;
  }
  return "";
}

OutputFile program(const ToolPath& path, const Job& job, const std::string& format) {
  GcodeOptions options;
  options.process = job.tool.process;
  return {program_name(format), export_tool_path(path, format, options)};
}

}  // namespace

std::string program_name(std::string_view format) { return fmt::format("program_{}{}", format, suffix_of(format)); }

std::vector<OutputFile> make_programs(const ToolPath& path, const Job& job, std::vector<std::string>& warnings) {
  std::vector<OutputFile> files;
  for (const std::string& format : job.programs) files.push_back(program(path, job, format));
  if (!files.empty()) return files;
  try {
    files.push_back(program(path, job, "gcode5"));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::no_plan) throw;
    files.push_back(program(path, job, "yaml"));
    warnings.push_back(fmt::format("no 5-axis G-code was written, but poses (program_yaml.yaml): {} ({}: {})",
                                   error.summary(), error.where().element, error.where().value));
  }
  return files;
}

}  // namespace isopath
