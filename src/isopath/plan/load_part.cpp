#include "isopath/plan/load_part.h"

#include <utility>

#include "isopath/core/error.h"
#include "isopath/mesh/read_mesh.h"

namespace isopath {

Part load_part(const std::filesystem::path& path, LengthUnit unit, Progress& progress) {
  MeshFile file = read_mesh(path, {.unit_mm = millimetres_in(unit)}, progress);
  try {
    return {TriangleMesh(std::move(file.soup)), std::move(file.vertex_of_file_vertex), std::move(file.notes)};
  } catch (const Error& error) {
    throw error.in_file(path.string());
  }
}

}  // namespace isopath
