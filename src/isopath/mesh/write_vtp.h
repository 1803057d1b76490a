#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "isopath/mesh/triangle_soup.h"

namespace isopath {

/// A scalar array of a VTP file, shown under its name by viewers such as ParaView.
struct VtpArray {
  std::string name;
  std::vector<double> values;
};

/// What a VTP file holds: triangles and polylines over common points, with scalars on the points and on the cells.
struct VtpData {
  std::vector<Vec3> points;
  std::vector<std::vector<Index>> lines;  ///< polylines of two points or more; a closed one repeats its first point
  std::vector<Triangle> triangles;
  std::vector<VtpArray> point_arrays;  ///< one value a point
  std::vector<VtpArray> cell_arrays;   ///< one value a cell: the lines first, then the triangles
};

/// The content of the file: XML PolyData in ASCII, with the shortest digits that read back to the same double.
/// Throws Error(bad_usage) when an array has the wrong size, or an index is out of range.
std::string vtp_content(const VtpData& data);

/// Writes it whole or not at all. Throws as vtp_content(), and Error(bad_input) when the file cannot be written.
void write_vtp(const std::filesystem::path& path, const VtpData& data);

}  // namespace isopath
