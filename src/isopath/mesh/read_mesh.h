#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/mesh/step_reader.h"
#include "isopath/mesh/triangle_soup.h"

namespace isopath {

struct ReadOptions {
  bool weld = true;       ///< make vertices at exactly equal positions one; STL, which has no indices, is always welded
  double unit_mm = 1;     ///< length of the file's unit in mm, finite and > 0: 1000 for a file in metres; STEP and
                          ///< IGES state their unit themselves
  StepOptions step = {};  ///< how finely STEP and IGES files are cut into triangles

  /// Throws Error(bad_usage) when a value is out of its range.
  void validate() const;
};

/// The triangles of a file, and how they came out of it.
struct MeshFile {
  TriangleSoup soup;
  /// Soup vertex of each vertex in file order; the identity over the welded vertices for STL.
  std::vector<Index> vertex_of_file_vertex;
  /// What was tolerated, one sentence each: trailing bytes, polygons split, unknown lines skipped.
  std::vector<std::string> notes;
};

/// Reads a triangle mesh in double precision: STL (binary, ASCII), OBJ, PLY (ASCII, both binaries) or OFF. The content
/// decides on the format, then the extension. Polygons are split into fans around their first corner. Coordinates may
/// be NaN, infinite or huge, triangles may be degenerate: check_mesh() tells and repair_mesh() mends. Files named
/// .step, .stp, .iges or .igs go through read_step() where this build can read them. Throws Error(bad_input) naming the
/// file, the line, element or byte, the value and what to do when the file cannot be read, is damaged or cut short,
/// holds no triangle, or has none of these formats.
MeshFile read_mesh(const std::filesystem::path& path, const ReadOptions& options = {},
                   Progress& progress = Progress::none());

/// The same for content that is already in memory; `name` stands in for the path.
MeshFile read_mesh_content(std::string_view content, const std::filesystem::path& name, const ReadOptions& options = {},
                           Progress& progress = Progress::none());

}  // namespace isopath
