#include "picture.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "isopath/core/atomic_file.h"
#include "isopath/plan/display_surface.h"
#include "shared_options.h"

namespace isopath::app {
namespace {

/// Distances bend at the scale of the part: so many bends across it are shown.
constexpr double bends_over_size = 20;

void write(const std::string& path, const Part& part, const RefinedMesh* shown, std::vector<double> distances,
           Picture picture) {
  ReportData data;
  data.title = std::filesystem::path(picture.mesh_file).filename().string();
  data.subtitle = std::move(picture.what);
  data.mesh = &part.mesh;
  data.shown = shown;
  data.scalars = {{.name = "distance", .unit = "mm", .values = std::move(distances)}};
  data.isolines = std::move(picture.lines);
  data.isolines_name = std::move(picture.lines_name);
  data.tables = {std::move(picture.figures)};
  data.warnings = part.warnings;
  write_file_atomically(path, report_html(data));
}

}  // namespace

void add_report(CLI::App& command, std::string& path) {
  command.add_option("--report", path, "A picture in 3D, FILE.html: one page that opens without a network")
      ->check(not_empty());
}

void check_report(const std::string& path) {
  if (!path.empty() && extension_of(path) != ".html") {
    refuse_value("option --report", path, "a file name that ends in .html");
  }
}

void check_writable_outputs(const std::string& output, const std::string& report) {
  for (const std::string& path : {output, report}) {
    if (!path.empty()) check_writable(path);
  }
}

std::string written_to(const std::string& output, const std::string& report) {
  std::string text;
  if (!output.empty()) text += fmt::format("written to {}\n", output);
  if (!report.empty()) text += fmt::format("picture in {}\n", report);
  return text;
}

void write_picture(const std::string& path, const Part& part, std::span<const double> distances, Picture picture) {
  write(path, part, nullptr, {distances.begin(), distances.end()}, std::move(picture));
}

void write_picture(const std::string& path, const Part& part, const ExactField& field, Picture picture,
                   const Progress& progress) {
  const RefinedMesh shown = refine_for_display(part.mesh, part.mesh.size() / bends_over_size);
  write(path, part, &shown, values_at_vertices(field, shown, field.vertex_distances(), progress), std::move(picture));
}

}  // namespace isopath::app
