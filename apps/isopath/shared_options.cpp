#include "shared_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/plan/make_sources.h"

namespace isopath::app {
namespace {

/// What to write instead of a length with a unit; empty for any other text.
std::string advice_on_unit(double value, std::string_view rest) {
  constexpr std::pair<std::string_view, double> units[] = {
      {"mm", 1}, {"cm", 10}, {"m", 1000}, {"in", 25.4}, {"inch", 25.4}};
  for (const auto& [name, mm] : units) {
    if (rest == name || rest == fmt::format(" {}", name))
      return fmt::format(": lengths are in mm and are written without the unit, here {:.10g}", value * mm);
  }
  return rest.empty() || value == 0 ? "" : ": only the number is written, in the unit that the help names";
}

CLI::Validator number_that(bool (*allows)(double), const char* allowed) {
  const auto complaint = [allows, allowed](std::string& text) {
    double value = 0;
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
    const bool whole = error == std::errc() && end == text.data() + text.size();
    if (whole && std::isfinite(value) && allows(value)) return std::string();
    const std::string_view rest(end, text.data() + text.size());
    const std::string advice = error == std::errc() ? advice_on_unit(value, rest) : "";
    return fmt::format("'{}' is not {}{}", text, allowed, advice);
  };
  return {complaint, ""};
}

}  // namespace

void add_mesh(CLI::App& command, MeshInput& input) {
  command.add_option("MESH", input.mesh, "The part: STL, OBJ, PLY, OFF, STEP or IGES")->required();
  add_unit(command, input.unit);
}

CLI::Option* add_unit(CLI::App& command, std::string& unit) {
  return command.add_option("--unit", unit, "Unit of the mesh file: mm, cm, m or inch")->capture_default_str();
}

CLI::Option* add_sources(CLI::App& command, std::vector<std::string>& sources) {
  return command
      .add_option("--source", sources, "Where distances are measured from, see below; may be repeated, sources join")
      ->type_name("SRC")
      ->allow_extra_args(false)
      ->default_str("auto");
}

std::vector<SourceSpec> parse_sources(const std::vector<std::string>& texts) {
  std::vector<SourceSpec> specs;
  for (const std::string& text : texts) specs.push_back(parse_source_spec(text));
  return specs;
}

PartAndSources load_with_sources(const MeshInput& input, const CommonFlags& flags, Progress& progress) {
  const std::vector<SourceSpec> specs = parse_sources(input.sources);
  PartAndSources loaded{load_part(input.mesh, unit_of(input.unit), progress), {}};
  print_warnings(flags, loaded.part.warnings);
  loaded.sources = make_sources(loaded.part.mesh, specs, loaded.part.vertex_of_file_vertex, progress);
  return loaded;
}

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

void refuse_value(std::string_view option, std::string_view value, std::string_view allowed) {
  throw Error(ErrorCode::bad_usage, "the option does not take this",
              {.element = std::string(option),
               .value = fmt::format("'{}'", value),
               .advice = fmt::format("allowed: {}", allowed)});
}

CLI::Validator number_above_0() {
  return number_that([](double value) { return value > 0; }, "a number above 0");
}

CLI::Validator number_from_0() {
  return number_that([](double value) { return value >= 0; }, "a number from 0");
}

CLI::Validator not_empty() {
  return {[](std::string& text) { return std::string(text.empty() ? "empty, where a name belongs" : ""); }, ""};
}

std::vector<std::string> warnings_of_idle(const CLI::App& command, const std::vector<IdleOption>& options) {
  std::vector<std::string> warnings;
  for (const IdleOption& given : options) {
    if (!given.is_idle) continue;
    if (command.count(given.option) > 0) {
      warnings.push_back(fmt::format("{} has no effect with --{}", given.option, given.beside));
    } else if (!given.key.empty()) {
      warnings.push_back(fmt::format("{} in the job file has no effect with {}", given.key, given.beside));
    }
  }
  return warnings;
}

std::string source_help() { return fmt::format("SRC is one of\n{}\n", source_spec_forms()); }

}  // namespace isopath::app
