#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "isopath/contour/isolines.h"
#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"
#include "isopath/field/checked_distances.h"
#include "isopath/field/exact_distances.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/fast_marching.h"
#include "isopath/field/graph_field.h"
#include "isopath/field/vertex_field.h"
#include "isopath/field/virtual_source.h"
#include "isopath/mesh/write_mesh.h"
#include "isopath/mesh/write_vtp.h"
#include "isopath/plan/make_sources.h"
#include "picture.h"
#include "shared_options.h"

namespace isopath::app {
namespace {

struct FieldArguments {
  MeshInput input;
  std::string method = "exact";
  std::optional<double> max_error;
  std::string output;
  std::string path_to;
  std::string report;
};

/// One value a line in the vertex order of the file; `inf` where no source reaches.
std::string csv_of(const Part& part, std::span<const double> distances) {
  std::string text;
  for (const Index v : part.vertex_of_file_vertex) {
    fmt::format_to(std::back_inserter(text), "{:.17g}\n", v == no_index ? infinity : distances[v]);
  }
  return text;
}

/// A traced path: its points, and the distance at each.
struct Way {
  std::vector<Vec3> points;
  std::vector<double> distances;
};

VtpData vtp_of(const Part& part, std::span<const double> distances, const Way& way) {
  const TriangleSoup& soup = part.mesh.soup();
  VtpData data{
      .points = soup.positions, .lines = {}, .triangles = soup.triangles, .point_arrays = {}, .cell_arrays = {}};
  std::vector<double> values(distances.begin(), distances.end());
  if (way.points.size() > 1) {
    std::vector<Index>& line = data.lines.emplace_back(way.points.size());
    std::iota(line.begin(), line.end(), part.mesh.n_vertices());
    data.points.insert(data.points.end(), way.points.begin(), way.points.end());
    values.insert(values.end(), way.distances.begin(), way.distances.end());
  }
  data.point_arrays.push_back({"distance", std::move(values)});
  return data;
}

void write_field(const std::string& path, const Part& part, std::span<const double> distances, const Way& way) {
  const std::string extension = extension_of(path);
  if (extension == ".csv") return write_file_atomically(path, csv_of(part, distances));
  if (extension == ".ply") return write_mesh(path, part.mesh.soup(), {.distance = distances});
  write_vtp(path, vtp_of(part, distances, way));
}

Way trace(const Part& part, const ExactField& field, const std::string& target) {
  const SurfacePoint start = make_point(part.mesh, parse_source_spec(target), part.vertex_of_file_vertex);
  Way way;
  for (const SurfacePoint& point : field.shortest_path(start)) {
    way.points.push_back(position_of(part.mesh, point));
    way.distances.push_back(field.value(point));
  }
  if (way.points.empty()) {
    throw Error(
        ErrorCode::no_plan, "no path leads there from the sources",
        {.element = "option --path-to", .value = target, .advice = "add a source on that component of the part"});
  }
  return way;
}

std::string way_text(const Way& way) {
  std::string text;
  for (const Vec3& p : way.points) fmt::format_to(std::back_inserter(text), "{},{},{}\n", p.x(), p.y(), p.z());
  return text;
}

nlohmann::ordered_json way_json(const Way& way) {
  auto points = nlohmann::ordered_json::array();
  for (const Vec3& p : way.points) points.push_back({p.x(), p.y(), p.z()});
  return {{"length", way.distances.front()}, {"points", std::move(points)}};
}

/// Lines between the colours: so many levels.
constexpr int levels_shown = 20;

Picture picture_of(const FieldArguments& arguments, const Part& part, std::span<const double> distances, double largest,
                   const Way& way) {
  Picture picture{
      .mesh_file = arguments.input.mesh,
      .what = "distance on the surface from the sources",
      .lines_name = way.points.empty() ? "Isolines" : "Shortest path",
      .figures = {"Field", {{"method", arguments.method}, {"largest distance", fmt::format("{:.6g}", largest), "mm"}}}};
  if (!way.points.empty()) {
    picture.figures.rows.push_back({"shortest path", fmt::format("{:.6g}", way.distances.front()), "mm"});
    picture.lines.push_back({.points = way.points});
    return picture;
  }
  const bool everywhere = std::all_of(distances.begin(), distances.end(), [](double d) { return d < infinity; });
  if (!everywhere || !(largest > 0)) return picture;
  std::vector<double> levels;
  for (int k = 1; k < levels_shown; ++k) levels.push_back(largest * k / levels_shown);
  const VertexField field(part.mesh, {distances.begin(), distances.end()});
  for (const Contour& contour : isolines(part.mesh, field, levels)) {
    ReportIsoline& line = picture.lines.emplace_back();
    line.closed = contour.closed;
    line.level = contour.level;
    for (const SurfacePoint& point : contour.points) line.points.push_back(position_of(part.mesh, point));
  }
  return picture;
}

void check(const FieldArguments& arguments) {
  constexpr std::array methods{"exact", "virtual-source", "fast-marching", "graph"};
  if (std::find(methods.begin(), methods.end(), arguments.method) == methods.end()) {
    refuse_value("option --method", arguments.method, "exact, virtual-source, fast-marching, graph");
  }
  if (arguments.max_error && arguments.method != "virtual-source") {
    refuse_value("option --method", arguments.method, "virtual-source, since --max-error checks its distances");
  }
  if (arguments.max_error) CheckedDistancesOptions{.max_error = *arguments.max_error}.validate();
  if (arguments.method != "exact" && !arguments.path_to.empty()) {
    refuse_value("option --method", arguments.method, "exact, since --path-to traces shortest paths through windows");
  }
  const std::string extension = extension_of(arguments.output);
  if (!arguments.output.empty() && extension != ".csv" && extension != ".ply" && extension != ".vtp") {
    refuse_value("option -o", arguments.output, "a file name that ends in .csv, .ply or .vtp");
  }
  check_report(arguments.report);
  if (arguments.output.empty() && arguments.path_to.empty() && arguments.report.empty()) {
    throw Error(ErrorCode::bad_usage, "nothing to do: none of -o, --path-to and --report is given");
  }
  check_writable_outputs(arguments.output, arguments.report);
}

struct Distances {
  std::vector<double> at_vertices;
  Way way;                                 ///< empty unless it was asked for
  nlohmann::ordered_json check = nullptr;  ///< of the error asked for
};

Distances distances_of(const FieldArguments& arguments, const Part& part, const SourceSet& sources,
                       Progress& progress) {
  if (arguments.method == "fast-marching") return {fast_marching_distances(part.mesh, sources, progress), {}, nullptr};
  if (arguments.method == "graph") {
    return {graph_distances(part.mesh, sources, {.virtual_vertices = 0, .across_pairs = true}, progress), {}, nullptr};
  }
  if (arguments.method == "virtual-source" && arguments.max_error) {
    CheckedDistances checked = checked_distances(part.mesh, sources, {.max_error = *arguments.max_error}, progress);
    return {
        std::move(checked.at_vertices),
        {},
        {{"max_error", *arguments.max_error}, {"estimated_error", checked.estimated_error}, {"exact", checked.exact}}};
  }
  if (arguments.method == "virtual-source")
    return {virtual_source_distances(part.mesh, sources, progress), {}, nullptr};
  if (arguments.path_to.empty()) return {exact_distances(part.mesh, sources, infinity, progress), {}, nullptr};
  const ExactField field = ExactField::compute(part.mesh, sources, {}, progress);
  Distances found{{field.vertex_distances().begin(), field.vertex_distances().end()}, {}, nullptr};
  found.way = trace(part, field, arguments.path_to);
  return found;
}

void run_field(const FieldArguments& arguments, const CommonFlags& flags) {
  check(arguments);
  ConsoleProgress progress(flags.quiet);
  const auto [part, sources] = load_with_sources(arguments.input, flags, progress);
  progress.stage("distance field");
  const Distances found = distances_of(arguments, part, sources, progress);
  const std::vector<double>& distances = found.at_vertices;
  const Way& way = found.way;
  progress.checkpoint();
  if (!arguments.output.empty()) write_field(arguments.output, part, distances, way);
  double largest = 0;
  for (const double d : distances) largest = d < infinity ? std::max(largest, d) : largest;
  if (!arguments.report.empty()) {
    write_picture(arguments.report, part, distances, picture_of(arguments, part, distances, largest, way));
  }
  if (!flags.json && !way.points.empty()) return print(way_text(way));  // the points alone, for other programs

  const auto unreached = std::count(distances.begin(), distances.end(), infinity);
  if (!flags.json) {
    return print(fmt::format("distances at {} vertices, up to {:.6g} mm; {} not reached\n{}", distances.size(), largest,
                             unreached, written_to(arguments.output, arguments.report)));
  }
  nlohmann::ordered_json report = {{"vertices", part.vertex_of_file_vertex.size()},
                                   {"triangles", part.mesh.n_faces()},
                                   {"method", arguments.method},
                                   {"max_distance", largest},
                                   {"unreached_vertices", unreached},
                                   {"output", arguments.output},
                                   {"warnings", part.warnings}};
  if (!arguments.report.empty()) report["report"] = arguments.report;
  if (!found.check.is_null()) report["check"] = found.check;
  if (!way.points.empty()) report["path"] = way_json(way);
  print_json(report);
}

}  // namespace

void add_field(CLI::App& app, CommonFlags& flags, Action& action) {
  auto* command =
      app.add_subcommand("field", "The geodesic distance from the sources at every vertex, and shortest paths");
  const auto arguments = std::make_shared<FieldArguments>();
  add_mesh(*command, arguments->input);
  add_sources(*command, arguments->input.sources);
  command
      ->add_option(
          "--method", arguments->method,
          "exact: true distances on the polyhedral surface;\n"
          "virtual-source: the fastest; mean relative error of 0.02 to 0.4 % as measured, single vertices up to\n"
          "some percent, to either side and without a bound unless --max-error is given;\n"
          "fast-marching: error about h (1 + ln(d/h)) / 8 at distance d for edges of length h (an estimate\n"
          "for well-shaped triangles), to either side;\n"
          "graph: along edges and across pairs of faces, never too short, and too long by no more than h\n"
          "for every edge that the shortest path crosses")
      ->capture_default_str();
  command->add_option("--max-error", arguments->max_error,
                      "With --method virtual-source: compare the quarter of the vertices nearest to the sources with\n"
                      "exact distances; if one is off by more than this share, compute all from the exact field");
  command->add_option("-o,--output", arguments->output,
                      ".csv: one value a line in the vertex order of the file; .ply, .vtp: the mesh with 'distance'");
  command->add_option(
      "--path-to", arguments->path_to,
      "Trace the shortest path from point:X,Y,Z or vertex:I back to the sources; printed as x,y,z lines");
  add_report(*command, arguments->report);
  add_common_flags(*command, flags);
  command->footer(
      "Examples:\n"
      "  isopath field part.stl --source boundary -o distance.vtp\n"
      "  isopath field part.stl --source boundary --report distance.html\n"
      "  isopath field part.off --source vertex:12 --source point:3,4,5 -o distance.csv\n"
      "  isopath field part.ply --source plane:0,0,1,20 --path-to vertex:900 > path.csv\n\n" +
      source_help());
  command->callback([&flags, &action, arguments] { action = [&flags, arguments] { run_field(*arguments, flags); }; });
}

}  // namespace isopath::app
