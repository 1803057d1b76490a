#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "isopath/contour/medial_axis.h"
#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/mesh/write_vtp.h"
#include "isopath/plan/make_sources.h"
#include "picture.h"
#include "shared_options.h"

namespace isopath::app {
namespace {

struct MedialAxisArguments {
  MeshInput input;
  bool voronoi = false;
  double min_angle = MedialAxisOptions().min_angle * 180 / std::numbers::pi;
  double prune = MedialAxisOptions().prune;
  std::string output;
  std::string report;
};

using Json = nlohmann::ordered_json;

VtpData graph_vtp(const TriangleMesh& mesh, const BisectorGraph& graph) {
  VtpData data;
  VtpArray clearance{"clearance", {}};
  VtpArray angle{"angle", {}};
  VtpArray left{"root_left", {}};
  VtpArray right{"root_right", {}};
  VtpArray arc_number{"arc", std::vector<double>(graph.arcs.size())};
  std::iota(arc_number.values.begin(), arc_number.values.end(), 0);
  for (const BisectorGraph::Arc& arc : graph.arcs) {
    std::vector<Index>& line = data.lines.emplace_back(arc.points.size());
    std::iota(line.begin(), line.end(), static_cast<Index>(data.points.size()));
    for (const BisectorPoint& point : arc.points) {
      data.points.push_back(position_of(mesh, point.point));
      clearance.values.push_back(point.clearance);
      angle.values.push_back(point.angle * 180 / std::numbers::pi);
      left.values.push_back(point.roots[0]);
      right.values.push_back(point.roots[1]);
    }
  }
  data.point_arrays = {std::move(clearance), std::move(angle), std::move(left), std::move(right)};
  data.cell_arrays = {std::move(arc_number)};
  return data;
}

/// One line a point; arcs and nodes by number.
std::string graph_csv(const TriangleMesh& mesh, const BisectorGraph& graph) {
  std::string text = "arc,from,to,x,y,z,clearance,angle,root_left,root_right\n";
  for (std::size_t k = 0; k < graph.arcs.size(); ++k) {
    const BisectorGraph::Arc& arc = graph.arcs[k];
    for (const BisectorPoint& point : arc.points) {
      const Vec3 p = position_of(mesh, point.point);
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},{}\n", k, arc.from, arc.to, p.x(), p.y(),
                     p.z(), point.clearance, point.angle * 180 / std::numbers::pi, point.roots[0], point.roots[1]);
    }
  }
  return text;
}

Json summary_json(const TriangleMesh& mesh, const BisectorGraph& graph) {
  double length = 0;
  double clearance = 0;
  for (const BisectorGraph::Arc& arc : graph.arcs) {
    length += length_of(mesh, arc);
    for (const BisectorPoint& point : arc.points) clearance = std::max(clearance, point.clearance);
  }
  const auto leaves =
      std::count_if(graph.nodes.begin(), graph.nodes.end(), [](const auto& node) { return node.arcs.size() == 1; });
  return {{"arcs", graph.arcs.size()},
          {"nodes", graph.nodes.size()},
          {"leaves", leaves},
          {"length", length},
          {"max_clearance", clearance}};
}

/// The axis as a report shows it.
Picture picture_of(const MedialAxisArguments& arguments, const TriangleMesh& mesh, const BisectorGraph& graph,
                   const Json& summary) {
  const auto count = [&](const char* name) { return fmt::format("{}", summary.at(name).get<std::size_t>()); };
  const auto length = [&](const char* name) { return fmt::format("{:.6g}", summary.at(name).get<double>()); };
  const char* name = arguments.voronoi ? "Voronoi diagram" : "Medial axis";
  Picture picture{.mesh_file = arguments.input.mesh,
                  .what = arguments.voronoi ? "Voronoi diagram of the sources" : "medial axis of the sources",
                  .lines_name = name,
                  .figures = {name,
                              {{"arcs", count("arcs")},
                               {"nodes", count("nodes")},
                               {"free ends", count("leaves")},
                               {"length", length("length"), "mm"},
                               {"largest clearance", length("max_clearance"), "mm",
                                "Distance of the axis from the sources, at most."}}}};
  for (const BisectorGraph::Arc& arc : graph.arcs) {
    ReportIsoline& line = picture.lines.emplace_back();
    for (const BisectorPoint& point : arc.points) line.points.push_back(position_of(mesh, point.point));
  }
  return picture;
}

void run_medial_axis(const CLI::App& command, const MedialAxisArguments& arguments, const CommonFlags& flags) {
  const std::string extension = extension_of(arguments.output);
  check_report(arguments.report);
  if (arguments.output.empty() && arguments.report.empty()) {
    throw Error(ErrorCode::bad_usage, "nothing to do: neither -o nor --report is given");
  }
  if (!arguments.output.empty() && extension != ".vtp" && extension != ".csv") {
    refuse_value("option -o", arguments.output, "a file name that ends in .vtp or .csv");
  }
  if (arguments.min_angle > 180)
    refuse_value("option --min-angle", fmt::format("{}", arguments.min_angle), "at most 180");
  check_writable_outputs(arguments.output, arguments.report);
  std::vector<std::string> warnings = warnings_of_idle(command, {{"--min-angle", arguments.voronoi, "voronoi"}});
  print_warnings(flags, warnings);
  ConsoleProgress progress(flags.quiet);
  const auto [part, sources] = load_with_sources(arguments.input, flags, progress);
  progress.stage("distance field");
  const ExactField field = ExactField::compute(part.mesh, sources, {}, progress);
  progress.stage(arguments.voronoi ? "Voronoi diagram" : "medial axis");
  BisectorGraph graph = arguments.voronoi
                            ? voronoi_diagram(field, {}, progress)
                            : medial_axis(field, {.min_angle = arguments.min_angle * std::numbers::pi / 180}, progress);
  if (arguments.prune > 0) graph = pruned(part.mesh, graph, arguments.prune);

  progress.checkpoint();
  if (extension == ".csv") {
    write_file_atomically(arguments.output, graph_csv(part.mesh, graph));
  } else if (extension == ".vtp") {
    write_vtp(arguments.output, graph_vtp(part.mesh, graph));
  }
  Json report = summary_json(part.mesh, graph);
  if (!arguments.report.empty()) {
    write_picture(arguments.report, part, field, picture_of(arguments, part.mesh, graph, report), progress);
  }
  if (!flags.json) {
    return print(fmt::format(
        "{} arcs, {} nodes, {} of them free ends\nlength {:.6g} mm, up to {:.6g} mm from the sources\n"
        "{}",
        graph.arcs.size(), graph.nodes.size(), report["leaves"].get<std::size_t>(), report["length"].get<double>(),
        report["max_clearance"].get<double>(), written_to(arguments.output, arguments.report)));
  }
  report["output"] = arguments.output;
  if (!arguments.report.empty()) report["report"] = arguments.report;
  warnings.insert(warnings.end(), part.warnings.begin(), part.warnings.end());
  report["warnings"] = warnings;
  print_json(report);
}

}  // namespace

void add_medial_axis(CLI::App& app, CommonFlags& flags, Action& action) {
  auto* command = app.add_subcommand(
      "medial-axis",
      "Where shortest paths from two sides meet: the medial axis of the sources, or their Voronoi diagram");
  const auto arguments = std::make_shared<MedialAxisArguments>();
  add_mesh(*command, arguments->input);
  add_sources(*command, arguments->input.sources);
  command->add_flag("--voronoi", arguments->voronoi,
                    "Lines between the nearest source elements, points or segments, instead of the medial axis");
  command
      ->add_option(
          "--min-angle", arguments->min_angle,
          "Least angle between the two paths, degrees; smaller angles come from single corners of round shapes")
      ->check(number_above_0())
      ->capture_default_str();
  command
      ->add_option("--prune", arguments->prune,
                   "Take off branches that end freely and are shorter than this times the clearance where they begin")
      ->check(number_from_0())
      ->capture_default_str();
  command
      ->add_option("-o,--output", arguments->output,
                   ".vtp: polylines with clearance, angle and roots; .csv: the same, one point a line")
      ->check(not_empty());
  add_report(*command, arguments->report);
  add_common_flags(*command, flags);
  command->footer(
      "Examples:\n"
      "  isopath medial-axis part.stl --source boundary -o axis.vtp\n"
      "  isopath medial-axis part.stl --source boundary --prune 1.5 -o axis.csv --json\n"
      "  isopath medial-axis part.stl --source boundary --prune 1.5 --report axis.html\n"
      "  isopath medial-axis part.stl --source vertex:12,400,731 --voronoi -o cells.vtp\n\n" +
      source_help());
  command->callback([&flags, &action, arguments, command] {
    action = [&flags, arguments, command] { run_medial_axis(*command, *arguments, flags); };
  });
}

}  // namespace isopath::app
