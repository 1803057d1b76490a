#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "console.h"
#include "isopath/field/source.h"
#include "isopath/plan/load_part.h"
#include "isopath/plan/source_spec.h"

namespace isopath::app {

/// What the commands that start from a mesh and sources have in common.
struct MeshInput {
  std::string mesh;
  std::string unit = "mm";
  std::vector<std::string> sources = {"auto"};
};

void add_mesh(CLI::App& command, MeshInput& input);
CLI::Option* add_unit(CLI::App& command, std::string& unit);
CLI::Option* add_sources(CLI::App& command, std::vector<std::string>& sources);

std::vector<SourceSpec> parse_sources(const std::vector<std::string>& texts);

/// A part, and where distances on it are measured from.
struct PartAndSources {
  Part part;
  SourceSet sources;
};
/// Reads and repairs the mesh that was named, says what it had to repair, and finds the sources on it.
PartAndSources load_with_sources(const MeshInput& input, const CommonFlags& flags, Progress& progress);

/// The extension of a path in lower case, with its dot.
std::string extension_of(const std::string& path);
/// Throws Error(bad_usage) that lists what an option takes.
[[noreturn]] void refuse_value(std::string_view option, std::string_view value, std::string_view allowed);

/// Checks of an option's number while the command line is read: finite, and above 0 or at least 0.
CLI::Validator number_above_0();
CLI::Validator number_from_0();
/// Refuses an empty text.
CLI::Validator not_empty();

/// An option, and what it does nothing beside.
struct IdleOption {
  const char* option;
  bool is_idle;        ///< as the other options are
  std::string beside;  ///< what makes it idle, as it would be written on the command line behind its dashes
  /// The key of the job file that sets it to something; empty where none does.
  std::string key = {};
};
/// A sentence for each that was given in vain: "--direction has no effect with --pattern spiral", or where only the job
/// file gives it, "planar_direction in the job file has no effect with pattern spiral".
std::vector<std::string> warnings_of_idle(const CLI::App& command, const std::vector<IdleOption>& options);

/// Explains SRC at the end of a command's help.
std::string source_help();

}  // namespace isopath::app
