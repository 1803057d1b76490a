#include "isopath/mesh/write_vtp.h"

#include <fmt/format.h>

#include <iterator>
#include <utility>

#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"
#include "isopath/core/markup.h"

namespace isopath {
namespace {

[[noreturn]] void refuse(std::string what, std::string element, std::string value) {
  throw Error(ErrorCode::bad_usage, std::move(what), {.element = std::move(element), .value = std::move(value)});
}

void check(const VtpData& data) {
  const auto check_array = [](const VtpArray& array, std::size_t wanted) {
    if (array.values.size() == wanted) return;
    refuse("a VTP array has the wrong size", fmt::format("array '{}'", array.name),
           fmt::format("{} values, {} needed", array.values.size(), wanted));
  };
  for (const VtpArray& array : data.point_arrays) check_array(array, data.points.size());
  for (const VtpArray& array : data.cell_arrays) check_array(array, data.lines.size() + data.triangles.size());
  const auto n = static_cast<Index>(data.points.size());
  const auto check_index = [&](Index v, const char* noun, std::size_t element) {
    if (v < 0 || v >= n) {
      refuse("point index out of range", fmt::format("{} {}", noun, element), fmt::format("{} of {} points", v, n));
    }
  };
  for (std::size_t i = 0; i < data.lines.size(); ++i) {
    if (data.lines[i].size() < 2) refuse("a polyline needs two points", fmt::format("polyline {}", i), {});
    for (const Index v : data.lines[i]) check_index(v, "polyline", i);
  }
  for (std::size_t i = 0; i < data.triangles.size(); ++i) {
    for (const Index v : data.triangles[i]) check_index(v, "triangle", i);
  }
}

void append_scalars(std::string& out, const char* section, const std::vector<VtpArray>& arrays) {
  if (arrays.empty()) return;
  const std::string first = markup_escaped(arrays.front().name);
  fmt::format_to(std::back_inserter(out), "      <{} Scalars=\"{}\">\n", section, first);
  for (const VtpArray& array : arrays) {
    fmt::format_to(std::back_inserter(out), "        <DataArray type=\"Float64\" Name=\"{}\" format=\"ascii\">\n",
                   markup_escaped(array.name));
    for (const double value : array.values) fmt::format_to(std::back_inserter(out), "{}\n", value);
    out += "        </DataArray>\n";
  }
  fmt::format_to(std::back_inserter(out), "      </{}>\n", section);
}

/// Cells of one kind: the points of each in turn, then where each ends in that list.
template <typename Cells>
void append_cells(std::string& out, const char* section, const Cells& cells) {
  fmt::format_to(std::back_inserter(out), "      <{}>\n", section);
  out += "        <DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\n";
  for (const auto& cell : cells) {
    for (const Index v : cell) fmt::format_to(std::back_inserter(out), "{} ", v);
    out.back() = '\n';
  }
  out += "        </DataArray>\n        <DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">\n";
  std::size_t end = 0;
  for (const auto& cell : cells) {
    end += cell.size();
    fmt::format_to(std::back_inserter(out), "{}\n", end);
  }
  fmt::format_to(std::back_inserter(out), "        </DataArray>\n      </{}>\n", section);
}

}  // namespace

std::string vtp_content(const VtpData& data) {
  check(data);
  std::string out = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <PolyData>\n    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"{}\">\n",
      data.points.size(), data.lines.size(), data.triangles.size());
  append_scalars(out, "PointData", data.point_arrays);
  append_scalars(out, "CellData", data.cell_arrays);
  out += "      <Points>\n        <DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n";
  for (const Vec3& p : data.points) fmt::format_to(std::back_inserter(out), "{} {} {}\n", p.x(), p.y(), p.z());
  out += "        </DataArray>\n      </Points>\n";
  append_cells(out, "Lines", data.lines);
  append_cells(out, "Polys", data.triangles);
  out += "    </Piece>\n  </PolyData>\n</VTKFile>\n";
  return out;
}

void write_vtp(const std::filesystem::path& path, const VtpData& data) {
  write_file_atomically(path, vtp_content(data));
}

}  // namespace isopath
