#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "isopath/core/error.h"
#include "isopath/mesh/check.h"
#include "isopath/mesh/read_mesh.h"
#include "isopath/mesh/repair.h"
#include "isopath/mesh/write_mesh.h"
#include "isopath/plan/job.h"
#include "shared_options.h"

namespace isopath::app {
namespace {

struct CheckArguments {
  std::string mesh;
  std::string unit = "mm";
  bool self_intersections = false;
  bool repair = false;
  RepairOptions repairs;
  std::string output;
};

using Json = nlohmann::ordered_json;

Json report_json(const MeshReport& report) {
  Json loops = Json::array();
  for (const BoundaryLoop& loop : report.boundary_loops) {
    loops.push_back({{"length", loop.length}, {"edges", loop.edges}, {"closed", loop.closed}});
  }
  Json defects = Json::array();
  for (const Defect& defect : report.defects) {
    defects.push_back({{"kind", name_of(defect.kind)},
                       {"severity", name_of(defect.severity)},
                       {"count", defect.count},
                       {"first", defect.first}});
  }
  return {{"triangles", report.triangles},
          {"vertices", report.vertices},
          {"edges", report.edges},
          {"area", report.area},
          {"size", report.bounds.isEmpty() ? 0 : report.bounds.diagonal().norm()},
          {"components", report.components},
          {"genus", report.genus ? Json(*report.genus) : Json()},
          {"closed", report.closed},
          {"manifold", report.manifold},
          {"orientable", report.orientable},
          {"sound", report.sound()},
          {"boundary_loops", std::move(loops)},
          {"defects", std::move(defects)}};
}

Json changes_json(const std::vector<RepairChange>& changes) {
  Json list = Json::array();
  for (const RepairChange& change : changes) list.push_back({{"what", change.what}, {"count", change.count}});
  return list;
}

std::string element_text(const std::vector<std::vector<Index>>& first) {
  std::vector<std::string> parts;
  for (const auto& element : first) parts.push_back(fmt::format("{}", fmt::join(element, "-")));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string report_text(const MeshReport& report) {
  std::string text = fmt::format("{} triangles, {} vertices, area {:.6g} mm², {} component{}\n", report.triangles,
                                 report.vertices, report.area, report.components, report.components == 1 ? "" : "s");
  text +=
      fmt::format("{}, {}, {}{}\n", report.closed ? "closed" : "open", report.manifold ? "manifold" : "not manifold",
                  report.orientable ? "orientable" : "not orientable",
                  report.genus ? fmt::format(", genus {}", *report.genus) : "");
  for (std::size_t k = 0; k < report.boundary_loops.size(); ++k) {
    const BoundaryLoop& loop = report.boundary_loops[k];
    text += fmt::format("boundary {}: {:.6g} mm, {} edges\n", k, loop.length, loop.edges);
  }
  for (const Defect& defect : report.defects) {
    text += fmt::format("{}: {} × {}, first: {}\n", name_of(defect.severity), defect.count, name_of(defect.kind),
                        element_text(defect.first));
  }
  text += report.sound() ? "ready to plan on\n" : "not ready: 'isopath plan' repairs it, or use --repair -o OUT\n";
  return text;
}

void run_check(const CheckArguments& arguments, const CommonFlags& flags) {
  if (arguments.repair == arguments.output.empty()) {
    throw Error(ErrorCode::bad_usage, "--repair and -o go together",
                {.advice = "give both to write the mended mesh, or none to look only"});
  }
  ConsoleProgress progress(flags.quiet);
  MeshFile file =
      read_mesh(arguments.mesh, {.weld = false, .unit_mm = millimetres_in(unit_of(arguments.unit))}, progress);
  print_warnings(flags, file.notes);
  progress.stage("check");
  const MeshReport report = check_mesh(file.soup, {.self_intersections = arguments.self_intersections}, progress);
  Json json = report_json(report);
  json["notes"] = file.notes;
  std::string text = report_text(report);
  if (arguments.repair) {
    progress.stage("repair");
    const RepairResult repaired = repair_mesh(std::move(file.soup), arguments.repairs, progress);
    progress.checkpoint();
    write_mesh(arguments.output, repaired.soup);
    json["changes"] = changes_json(repaired.changes);
    json["output"] = arguments.output;
    for (const RepairChange& change : repaired.changes)
      text += fmt::format("repaired: {} ({})\n", change.what, change.count);
    if (repaired.changes.empty()) text += "nothing to repair\n";
  }
  print(flags.json ? json.dump(2) + "\n" : text);
}

}  // namespace

void add_check(CLI::App& app, CommonFlags& flags, Action& action) {
  auto* command = app.add_subcommand("check", "What a mesh is and what is wrong with it; mends it on request");
  const auto arguments = std::make_shared<CheckArguments>();
  command->add_option("MESH", arguments->mesh, "STL, OBJ, PLY, OFF, STEP or IGES")->required();
  add_unit(*command, arguments->unit);
  command->add_flag("--self-intersections", arguments->self_intersections, "Look for triangles that cross, too");
  command->add_flag("--repair", arguments->repair, "Mend the mesh and write it to the file of -o");
  command->add_option("-o,--output", arguments->output, "The mended mesh: .stl, .obj, .ply or .off, in mm");
  command->add_flag("--largest-component", arguments->repairs.largest_component,
                    "With --repair: keep only the component with the largest area");
  command
      ->add_option("--fill-holes", arguments->repairs.fill_holes_length,
                   "With --repair: close boundary loops no longer than this, mm")
      ->capture_default_str();
  add_common_flags(*command, flags);
  command->footer(
      "Examples:\n"
      "  isopath check scan.stl\n"
      "  isopath check scan.stl --json > scan.json\n"
      "  isopath check scan.stl --repair --fill-holes 20 -o mended.ply");
  command->callback([&flags, &action, arguments] { action = [&flags, arguments] { run_check(*arguments, flags); }; });
}

}  // namespace isopath::app
