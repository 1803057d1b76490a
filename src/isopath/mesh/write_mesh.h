#pragma once

#include <filesystem>
#include <span>

#include "isopath/mesh/triangle_soup.h"

namespace isopath {

struct WriteOptions {
  /// One value a vertex, written as the vertex property "distance"; only PLY carries it. Empty: none.
  std::span<const double> distance = {};
};

/// Writes triangles in the format that the extension names: .stl (binary, single precision, vertices not shared),
/// .obj, .off (both with the shortest digits that read back to the same double) or .ply (binary, little endian, double
/// precision). The file is written whole or not at all.
/// Throws Error(bad_usage) for another extension, or a distance of the wrong size or for a format that cannot carry
/// it, and Error(bad_input) when the file cannot be written or a finite coordinate is too large for STL.
void write_mesh(const std::filesystem::path& path, const TriangleSoup& soup, const WriteOptions& options = {});

}  // namespace isopath
