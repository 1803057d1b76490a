#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <vector>

#include "isopath/field/exact_field.h"
#include "isopath/plan/load_part.h"
#include "isopath/post/report.h"

namespace isopath::app {

/// The option --report FILE.html of the commands that compute something to look at.
void add_report(CLI::App& command, std::string& path);
/// Throws Error(bad_usage) unless the path is empty or ends in .html.
void check_report(const std::string& path);

/// Before the work: throws Error(bad_input) naming the file that cannot be written. Either may be empty.
void check_writable_outputs(const std::string& output, const std::string& report);

/// "written to …", a line for each of the two files that was asked for.
std::string written_to(const std::string& output, const std::string& report);

/// What such a command shows: distances on the part, lines over them, and its figures.
struct Picture {
  std::string mesh_file;
  std::string what;        ///< the subtitle
  std::string lines_name;  ///< what the lines are
  std::vector<ReportIsoline> lines = {};
  ReportTable figures = {};
};

/// Writes it with the distances at the vertices, linear between them.
void write_picture(const std::string& path, const Part& part, std::span<const double> distances, Picture picture);
/// Writes it with the distances on a mesh that is fine enough to look smooth.
void write_picture(const std::string& path, const Part& part, const ExactField& field, Picture picture,
                   const Progress& progress);

}  // namespace isopath::app
