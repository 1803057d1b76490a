#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "isopath/core/atomic_file.h"
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
  bool strict = false;
  bool repair = false;
  RepairOptions repairs;
  std::string output;
};

using Json = nlohmann::ordered_json;

/// What the file holds, and what is left of it to plan on.
struct Findings {
  std::vector<std::string> notes;
  MeshReport file;
  std::optional<RepairResult> repaired;  ///< none: nothing usable is in the file
  MeshReport after;                      ///< of `repaired`
  std::string why_unusable;
};

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
          {"largest_component_area", report.largest_area},
          {"genus", report.genus ? Json(*report.genus) : Json()},
          {"closed", report.closed},
          {"manifold", report.manifold},
          {"orientable", report.orientable},
          {"sound", report.sound()},
          {"boundary_loops", std::move(loops)},
          {"defects", std::move(defects)}};
}

/// The figures of the file as it is; those after repair stand under `repaired`.
Json findings_json(const Findings& findings, const CheckArguments& arguments) {
  Json json = report_json(findings.file);
  json["notes"] = findings.notes;
  json["usable"] = findings.repaired.has_value();
  Json changes = Json::array();
  if (findings.repaired) {
    for (const RepairChange& change : findings.repaired->changes) {
      changes.push_back({{"what", change.what}, {"count", change.count}});
    }
  }
  json["changes"] = std::move(changes);
  json["repaired"] = findings.repaired ? report_json(findings.after) : Json();
  if (arguments.repair) json["output"] = findings.repaired ? Json(arguments.output) : Json();
  return json;
}

std::string yes_or_no(bool value) { return value ? "yes" : "no"; }

std::string total_length(const MeshReport& report) {
  double length = 0;
  for (const BoundaryLoop& loop : report.boundary_loops) length += loop.length;
  return fmt::format("{:.6g} mm", length);
}

/// One line a figure: as the file has it and, where a repair changes the mesh, what it is then.
std::string figures_text(const MeshReport& file, const MeshReport* after) {
  std::string text = after ? fmt::format("{:<18}{:>16}{:>16}\n", "", "in the file", "after repair") : "";
  const auto row = [&](const char* name, const auto& figure) {
    text += fmt::format("{:<18}{:>16}", name, figure(file));
    text += after ? fmt::format("{:>16}\n", figure(*after)) : "\n";
  };
  row("triangles", [](const MeshReport& r) { return fmt::format("{}", r.triangles); });
  row("vertices", [](const MeshReport& r) { return fmt::format("{}", r.vertices); });
  row("edges", [](const MeshReport& r) { return fmt::format("{}", r.edges); });
  row("area", [](const MeshReport& r) { return fmt::format("{:.6g} mm²", r.area); });
  row("size", [](const MeshReport& r) {
    return fmt::format("{:.6g} mm", r.bounds.isEmpty() ? 0 : r.bounds.diagonal().norm());
  });
  row("components", [](const MeshReport& r) { return fmt::format("{}", r.components); });
  row("boundary loops", [](const MeshReport& r) { return fmt::format("{}", r.boundary_loops.size()); });
  row("boundary length", total_length);
  row("genus", [](const MeshReport& r) { return r.genus ? fmt::format("{}", *r.genus) : std::string("-"); });
  row("closed", [](const MeshReport& r) { return yes_or_no(r.closed); });
  row("manifold", [](const MeshReport& r) { return yes_or_no(r.manifold); });
  row("orientable", [](const MeshReport& r) { return yes_or_no(r.orientable); });
  return text;
}

std::string loops_text(const std::vector<BoundaryLoop>& loops) {
  constexpr std::size_t listed = 20;
  std::string text;
  for (std::size_t k = 0; k < std::min(listed, loops.size()); ++k) {
    const std::string name = fmt::format("boundary:{}", k);
    text += fmt::format("{:<18}{:>13.6g} mm{:>10} edges{}\n", name, loops[k].length, loops[k].edges,
                        loops[k].closed ? "" : ", ends at a non-manifold edge");
  }
  if (loops.size() > listed) text += fmt::format("... and {} more, see --json\n", loops.size() - listed);
  return text;
}

/// What it means that a mesh is in pieces.
std::string pieces_text(const MeshReport& report) {
  if (report.components < 2) return "";
  return fmt::format(
      "note: {} separate pieces, the largest with {:.3g} % of the area: 'isopath plan' covers each by itself, with "
      "lifts\n"
      "  from one to the next; --repair --largest-component keeps only the largest\n",
      report.components, 100 * report.largest_area / report.area);
}

std::string element_text(const std::vector<std::vector<Index>>& first) {
  std::vector<std::string> parts;
  for (const auto& element : first) parts.push_back(fmt::format("{}", fmt::join(element, "-")));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string findings_text(const Findings& findings, const CheckArguments& arguments) {
  const bool changed = findings.repaired && !findings.repaired->changes.empty();
  std::string text = figures_text(findings.file, changed ? &findings.after : nullptr);
  text += loops_text((changed ? findings.after : findings.file).boundary_loops);
  if (findings.repaired) text += pieces_text(findings.after);
  for (const Defect& defect : findings.file.defects) {
    text += fmt::format("{}: {} × {}, first: {}\n", name_of(defect.severity), defect.count, name_of(defect.kind),
                        element_text(defect.first));
  }
  if (changed) {
    for (const RepairChange& change : findings.repaired->changes) {
      text += fmt::format("repair: {} ({})\n", change.what, change.count);
    }
  }
  if (!findings.repaired) return text + "not usable\n";
  if (arguments.repair) return text + (changed ? "repaired" : "nothing to repair") + ": " + arguments.output + "\n";
  if (arguments.repairs.largest_component || arguments.repairs.fill_holes_length > 0) {
    return text +
           "'isopath plan' neither fills holes nor drops components: --repair -o OUT writes the mesh after repair\n";
  }
  return text + (changed ? "ready to plan on: 'isopath plan' makes these repairs by itself\n" : "ready to plan on\n");
}

Findings examine(const CheckArguments& arguments, ConsoleProgress& progress) {
  MeshFile file =
      read_mesh(arguments.mesh, {.weld = false, .unit_mm = millimetres_in(unit_of(arguments.unit))}, progress);
  Findings findings;
  findings.notes = std::move(file.notes);
  progress.stage("check");
  findings.file = check_mesh(file.soup, {.self_intersections = arguments.self_intersections}, progress);
  progress.stage("repair");
  try {
    findings.repaired = repair_mesh(std::move(file.soup), arguments.repairs, progress);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::bad_input) throw;
    findings.why_unusable = error.what();
    return findings;
  }
  findings.after = check_mesh(findings.repaired->soup, {}, progress);
  return findings;
}

void require_writable_format(const std::string& output) {
  const std::string extension = extension_of(output);
  for (const char* known : {".stl", ".obj", ".ply", ".off"}) {
    if (extension == known) return;
  }
  refuse_value("option -o", output, "a file name that ends in .stl, .obj, .ply or .off");
}

void run_check(const CheckArguments& arguments, const CommonFlags& flags) {
  if (arguments.repair == arguments.output.empty()) {
    throw Error(ErrorCode::bad_usage, "--repair and -o go together",
                {.advice = "give both to write the mended mesh, or none to look only"});
  }
  if (arguments.repair) {
    require_writable_format(arguments.output);
    check_writable(arguments.output);
  }
  Findings findings;
  {
    ConsoleProgress progress(flags.quiet);
    findings = examine(arguments, progress);
    progress.checkpoint();
  }
  if (arguments.repair && findings.repaired) write_mesh(arguments.output, findings.repaired->soup);
  print_warnings(flags, findings.notes);
  if (flags.json) {
    print_json(findings_json(findings, arguments));
  } else {
    print(findings_text(findings, arguments));
  }
  if (!findings.repaired) throw Error(ErrorCode::bad_input, findings.why_unusable, {.file = arguments.mesh});
  if (arguments.strict && !findings.file.sound()) {
    throw Error(ErrorCode::bad_input, "the mesh needs repair",
                {.file = arguments.mesh, .advice = "mend it with --repair -o OUT, or leave out --strict"});
  }
}

}  // namespace

void add_check(CLI::App& app, CommonFlags& flags, Action& action) {
  auto* command = app.add_subcommand("check", "What a mesh is and what is wrong with it; mends it on request");
  const auto arguments = std::make_shared<CheckArguments>();
  command->add_option("MESH", arguments->mesh, "STL, OBJ, PLY, OFF, STEP or IGES")->required();
  add_unit(*command, arguments->unit);
  command->add_flag("--self-intersections", arguments->self_intersections, "Look for triangles that cross, too");
  command->add_flag("--strict", arguments->strict, "Exit status 3 when the mesh needs repair, too");
  command->add_flag("--repair", arguments->repair, "Mend the mesh and write it to the file of -o");
  command->add_option("-o,--output", arguments->output, "The mended mesh: .stl, .obj, .ply or .off, in mm");
  command->add_flag("--largest-component", arguments->repairs.largest_component,
                    "Keep only the component with the largest area");
  command
      ->add_option("--fill-holes", arguments->repairs.fill_holes_length, "Close boundary loops no longer than this, mm")
      ->check(number_from_0())
      ->capture_default_str();
  add_common_flags(*command, flags);
  command->footer(
      "Examples:\n"
      "  isopath check scan.stl\n"
      "  isopath check scan.stl --json > scan.json\n"
      "  isopath check scan.stl --strict --quiet > /dev/null || echo 'needs repair'\n"
      "  isopath check scan.stl --repair --fill-holes 20 -o mended.ply\n\n"
      "Exit status: 0 when 'isopath plan' can use the mesh as it is or after the repairs it makes by itself,\n"
      "3 when the file cannot be read or holds no usable triangle. With --strict only a mesh without errors\n"
      "gives 0. Loops are numbered as in --source boundary:K, elements from 0 as in the file.");
  command->callback([&flags, &action, arguments] { action = [&flags, arguments] { run_check(*arguments, flags); }; });
}

}  // namespace isopath::app
