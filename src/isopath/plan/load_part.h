#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/mesh/triangle_mesh.h"
#include "isopath/plan/job.h"

namespace isopath {

/// A part as it was loaded from a file, in mm, repaired where that was needed.
struct Part {
  TriangleMesh mesh;
  /// Mesh vertex of each vertex in file order; `no_index` where the vertex is gone.
  std::vector<Index> vertex_of_file_vertex;
  /// What was tolerated in the file and what was changed to mend the mesh, one sentence each.
  std::vector<std::string> warnings;
};

/// Reads a mesh file and repairs it where it is not a consistently oriented manifold. Throws Error(bad_input) naming
/// the file, what is wrong with it and what to do.
Part load_part(const std::filesystem::path& path, LengthUnit unit = LengthUnit::millimetre,
               Progress& progress = Progress::none());

}  // namespace isopath
