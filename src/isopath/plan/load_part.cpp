#include "isopath/plan/load_part.h"

#include <fmt/format.h>

#include <utility>

#include "isopath/core/error.h"
#include "isopath/mesh/read_mesh.h"
#include "isopath/mesh/repair.h"

namespace isopath {

Part load_part(const std::filesystem::path& path, LengthUnit unit, Progress& progress) {
  MeshFile file = read_mesh(path, {.unit_mm = millimetres_in(unit)}, progress);
  Part part;
  part.warnings = std::move(file.notes);
  try {
    RepairResult repaired = repair_mesh(std::move(file.soup), {}, progress);
    for (const RepairChange& change : repaired.changes) {
      part.warnings.push_back(fmt::format("repaired: {} ({})", change.what, change.count));
    }
    part.vertex_of_file_vertex = std::move(file.vertex_of_file_vertex);
    for (Index& vertex : part.vertex_of_file_vertex) {
      if (vertex != no_index) vertex = repaired.vertex_of_input[vertex];
    }
    part.mesh = TriangleMesh(std::move(repaired.soup));
  } catch (const Error& error) {
    throw error.in_file(path.string());
  }
  return part;
}

}  // namespace isopath
