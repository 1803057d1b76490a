#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "isopath/contour/contour_graph.h"
#include "isopath/contour/isolines.h"
#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/mesh/write_vtp.h"
#include "isopath/plan/make_sources.h"
#include "picture.h"
#include "shared_options.h"

namespace isopath::app {
namespace {

struct ContoursArguments {
  MeshInput input;
  double spacing = 0;
  std::string output;
  std::string report;
};

using Json = nlohmann::ordered_json;

/// All multiples of the spacing below the largest distance.
std::vector<double> levels_below(double largest, double spacing) {
  constexpr double most = 1e6;
  if (largest / spacing > most) {
    throw Error(ErrorCode::bad_usage, "the spacing is too small for this part",
                {.element = "option --spacing",
                 .value = fmt::format("{}, the largest distance is {}", spacing, largest),
                 .advice = fmt::format("allowed: {} or more", largest / most)});
  }
  std::vector<double> levels;
  for (int k = 1; k * spacing < largest; ++k) levels.push_back(k * spacing);
  return levels;
}

Json points_json(const TriangleMesh& mesh, const Contour& contour) {
  Json points = Json::array();
  for (const SurfacePoint& point : contour.points) {
    const Vec3 p = position_of(mesh, point);
    points.push_back({p.x(), p.y(), p.z()});
  }
  return points;
}

Json graph_json(const ContourGraph& graph) {
  Json runs = Json::array();
  for (const auto& run : graph.runs) {
    runs.push_back(
        {{"contours", run.contours}, {"closed", run.closed}, {"children", run.children}, {"parents", run.parents}});
  }
  return {{"children", graph.children}, {"parents", graph.parents}, {"order", graph.order}, {"runs", std::move(runs)}};
}

Json contours_json(const TriangleMesh& mesh, const std::vector<Contour>& contours, const ContourGraph& graph) {
  Json list = Json::array();
  for (const Contour& contour : contours) {
    list.push_back({{"level", contour.level},
                    {"closed", contour.closed},
                    {"length", length_of(mesh, contour)},
                    {"points", points_json(mesh, contour)}});
  }
  return {{"contours", std::move(list)}, {"graph", graph_json(graph)}};
}

VtpData contours_vtp(const TriangleMesh& mesh, const std::vector<Contour>& contours, const ContourGraph& graph) {
  VtpData data;
  VtpArray level{"level", {}};
  VtpArray run{"run", std::vector<double>(contours.size(), -1)};
  for (const Contour& contour : contours) {
    std::vector<Index>& line = data.lines.emplace_back(contour.points.size());
    std::iota(line.begin(), line.end(), static_cast<Index>(data.points.size()));
    if (contour.closed) line.push_back(line.front());
    for (const SurfacePoint& point : contour.points) data.points.push_back(position_of(mesh, point));
    level.values.push_back(contour.level);
  }
  for (std::size_t r = 0; r < graph.runs.size(); ++r) {
    for (const Index k : graph.runs[r].contours) run.values[k] = static_cast<double>(r);
  }
  data.cell_arrays = {std::move(level), std::move(run)};
  return data;
}

Json summary_json(const TriangleMesh& mesh, const std::vector<double>& levels, const std::vector<Contour>& contours,
                  const ContourGraph& graph) {
  double length = 0;
  std::size_t closed = 0;
  for (const Contour& contour : contours) {
    length += length_of(mesh, contour);
    closed += contour.closed ? 1 : 0;
  }
  return {{"levels", levels.size()}, {"contours", contours.size()},
          {"closed", closed},        {"open", contours.size() - closed},
          {"length", length},        {"runs", graph.runs.size()}};
}

ReportTable figures_of(const Json& summary) {
  const auto count = [&](const char* name) { return fmt::format("{}", summary.at(name).get<std::size_t>()); };
  return {"Contours",
          {{"levels", count("levels")},
           {"closed", count("closed")},
           {"open", count("open")},
           {"length", fmt::format("{:.6g}", summary.at("length").get<double>()), "mm"},
           {"runs", count("runs"), "", "Stacks of contours with one neighbour on either side."}}};
}

/// The contours as a report shows them.
Picture picture_of(const ContoursArguments& arguments, const TriangleMesh& mesh, const std::vector<Contour>& contours,
                   const Json& summary) {
  Picture picture{.mesh_file = arguments.input.mesh,
                  .what = fmt::format("lines of equal distance, {:g} mm apart", arguments.spacing),
                  .lines_name = "Contours",
                  .figures = figures_of(summary)};
  for (const Contour& contour : contours) {
    ReportIsoline& line = picture.lines.emplace_back();
    line.closed = contour.closed;
    line.level = contour.level;
    for (const SurfacePoint& point : contour.points) line.points.push_back(position_of(mesh, point));
  }
  return picture;
}

void run_contours(const ContoursArguments& arguments, const CommonFlags& flags) {
  const std::string extension = extension_of(arguments.output);
  check_report(arguments.report);
  if (arguments.output.empty() && arguments.report.empty()) {
    throw Error(ErrorCode::bad_usage, "nothing to do: neither -o nor --report is given");
  }
  if (!arguments.output.empty() && extension != ".vtp" && extension != ".json") {
    refuse_value("option -o", arguments.output, "a file name that ends in .vtp or .json");
  }
  check_writable_outputs(arguments.output, arguments.report);
  ConsoleProgress progress(flags.quiet);
  const auto [part, sources] = load_with_sources(arguments.input, flags, progress);
  progress.stage("distance field");
  const ExactField field = ExactField::compute(part.mesh, sources, {}, progress);
  progress.stage("contours");
  const std::vector<double> levels = levels_below(field.max_vertex_distance(), arguments.spacing);
  const auto [contours, graph] = contour_set(part.mesh, field, levels, {}, progress);

  progress.checkpoint();
  if (extension == ".json") {
    write_file_atomically(arguments.output, contours_json(part.mesh, contours, graph).dump() + "\n");
  } else if (extension == ".vtp") {
    write_vtp(arguments.output, contours_vtp(part.mesh, contours, graph));
  }
  Json report = summary_json(part.mesh, levels, contours, graph);
  if (!arguments.report.empty()) {
    write_picture(arguments.report, part, field, picture_of(arguments, part.mesh, contours, report), progress);
  }
  if (!flags.json) {
    return print(fmt::format("{} contours at {} levels, {} of them closed\nlength {:.6g} mm\n{}", contours.size(),
                             levels.size(), report["closed"].get<std::size_t>(), report["length"].get<double>(),
                             written_to(arguments.output, arguments.report)));
  }
  report["output"] = arguments.output;
  if (!arguments.report.empty()) report["report"] = arguments.report;
  report["warnings"] = part.warnings;
  print_json(report);
}

}  // namespace

void add_contours(CLI::App& app, CommonFlags& flags, Action& action) {
  auto* command =
      app.add_subcommand("contours", "Lines of equal distance from the sources, and how they lie side by side");
  const auto arguments = std::make_shared<ContoursArguments>();
  add_mesh(*command, arguments->input);
  add_sources(*command, arguments->input.sources);
  command->add_option("--spacing", arguments->spacing, "Distance from line to line, mm")
      ->check(number_above_0())
      ->required();
  command
      ->add_option("-o,--output", arguments->output, ".vtp: polylines with level and run; .json: points and the graph")
      ->check(not_empty());
  add_report(*command, arguments->report);
  add_common_flags(*command, flags);
  command->footer(
      "Examples:\n"
      "  isopath contours part.stl --source boundary --spacing 2 -o lines.vtp\n"
      "  isopath contours part.stl --source boundary --spacing 2 --report lines.html\n"
      "  isopath contours part.stl --source edges:40 --spacing 5 -o lines.json --json\n\n" +
      source_help());
  command->callback(
      [&flags, &action, arguments] { action = [&flags, arguments] { run_contours(*arguments, flags); }; });
}

}  // namespace isopath::app
