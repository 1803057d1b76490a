#include "isopath/mesh/read_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"
#include "isopath/mesh/mesh_formats.h"
#include "isopath/mesh/step_reader.h"
#include "isopath/mesh/text_scanner.h"
#include "isopath/mesh/weld.h"

namespace isopath {
namespace {

enum class Format { stl, obj, ply, off, step, unknown };

bool looks_like_obj(std::string_view content) {
  TextScanner scanner(content.substr(0, 4096), '#');
  if (!scanner.next_line()) return false;
  const std::string_view keyword = scanner.word();
  constexpr std::string_view known[] = {"v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl"};
  return std::find(std::begin(known), std::end(known), keyword) != std::end(known);
}

Format format_of_content(std::string_view content) {
  if (content.starts_with("ply\n") || content.starts_with("ply\r") || content.starts_with("ply ")) return Format::ply;
  if (is_exact_binary_stl(content) || is_ascii_stl(content)) return Format::stl;
  if (is_off(content)) return Format::off;
  if (content.starts_with("ISO-10303-21")) return Format::step;
  if (looks_like_obj(content)) return Format::obj;
  return Format::unknown;
}

Format format_of_extension(const std::string& extension) {
  if (extension == ".stl") return Format::stl;
  if (extension == ".obj") return Format::obj;
  if (extension == ".ply") return Format::ply;
  if (extension == ".off") return Format::off;
  if (extension == ".step" || extension == ".stp" || extension == ".iges" || extension == ".igs") return Format::step;
  return Format::unknown;
}

void refuse_utf16(std::string_view content) {
  if (content.starts_with("\xff\xfe") || content.starts_with("\xfe\xff")) {
    throw Error(
        ErrorCode::bad_input, "the file is UTF-16 text",
        {.element = "byte 0", .value = shown(content.substr(0, 2)), .advice = "save it as plain ASCII or UTF-8"});
  }
}

RawMesh read_raw(std::string_view content, const std::filesystem::path& name, Progress& progress) {
  if (content.empty()) {
    throw Error(ErrorCode::bad_input, "the file is empty",
                {.element = "byte 0", .advice = "export the surface again as STL, OBJ, PLY or OFF"});
  }
  Format format = is_exact_binary_stl(content) ? Format::stl : Format::unknown;
  if (format == Format::unknown) {
    refuse_utf16(content);
    if (content.starts_with("\xef\xbb\xbf")) content.remove_prefix(3);
    format = format_of_content(content);
  }
  const std::string extension = lower_extension(name);
  if (format == Format::unknown) format = format_of_extension(extension);
  switch (format) {
    case Format::stl:
      return read_stl(content, progress);
    case Format::obj:
      return read_obj(content, progress);
    case Format::ply:
      return read_ply(content, progress);
    case Format::off:
      return read_off(content, progress);
    case Format::step:
      throw Error(ErrorCode::bad_input, "STEP and IGES hold surfaces, not triangles",
                  {.element = fmt::format("format {}", extension),
                   .advice = "tessellate the part in the CAD program and export STL, OBJ, PLY or OFF"});
    case Format::unknown:
      break;
  }
  throw Error(ErrorCode::bad_input, "unknown mesh format",
              {.element = "byte 0",
               .value = shown(content.substr(0, 16)),
               .advice = "give a mesh in STL, OBJ, PLY or OFF format, or a STEP or IGES file that ends in .step, .stp, "
                         ".iges or .igs"});
}

void check_not_empty(const RawMesh& raw, std::string_view content) {
  if (!raw.soup.triangles.empty()) return;
  throw Error(ErrorCode::bad_input, "the file holds no triangles",
              {.element = fmt::format("byte {}", content.size()),
               .value = fmt::format("{} vertices, 0 faces", raw.soup.positions.size()),
               .advice = "export the surface with its faces"});
}

MeshFile weld(RawMesh&& raw, bool merge) {
  MeshFile file{std::move(raw.soup), {}, std::move(raw.notes)};
  file.vertex_of_file_vertex.resize(file.soup.positions.size());
  if (!merge) {
    std::iota(file.vertex_of_file_vertex.begin(), file.vertex_of_file_vertex.end(), 0);
    return file;
  }
  PointWelder welder(file.soup.positions.size());
  welder.add(file.soup.positions, file.vertex_of_file_vertex);
  if (const std::size_t gone = file.soup.positions.size() - welder.points().size(); gone > 0) {
    file.notes.push_back(fmt::format("{} vertices at the position of an earlier one were merged with it", gone));
    file.soup.positions = welder.take_points();
    for (Triangle& triangle : file.soup.triangles) {
      for (Index& v : triangle) v = file.vertex_of_file_vertex[v];
    }
  }
  return file;
}

}  // namespace

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

void ReadOptions::validate() const {
  step.validate();
  if (!(std::isfinite(unit_mm) && unit_mm > 0)) {
    throw Error(ErrorCode::bad_usage, "the length of the file's unit must be positive",
                {.element = "unit_mm",
                 .value = fmt::format("{}", unit_mm),
                 .advice = "give 1 for mm, 1000 for m, 25.4 for inch"});
  }
}

void RawMesh::add_polygon(std::span<const Index> corners) {
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    soup.triangles.push_back({corners[0], corners[i], corners[i + 1]});
  }
  if (corners.size() > 3) ++split_polygons;
}

void check_count(std::string_view noun, std::uint64_t count, std::uint64_t least_bytes_each, std::uint64_t bytes_left,
                 const std::string& element) {
  constexpr std::uint64_t most = std::numeric_limits<Index>::max() / 3;  // half-edges are counted by an Index
  if (count <= most && count * least_bytes_each <= bytes_left) return;
  throw Error(ErrorCode::bad_input, fmt::format("the header announces more {} than the file holds", noun),
              {.element = element,
               .value = fmt::format("{} {}, but only {} bytes follow", count, noun, bytes_left),
               .advice = "the file is cut short or its header is wrong; export it again"});
}

MeshFile read_mesh_content(std::string_view content, const std::filesystem::path& name, const ReadOptions& options,
                           Progress& progress) {
  options.validate();
  progress.stage("read mesh");
  try {
    RawMesh raw = read_raw(content, name, progress);
    check_not_empty(raw, content);
    if (raw.split_polygons > 0) {
      raw.notes.push_back(fmt::format("{} polygons were split into triangles", raw.split_polygons));
    }
    if (options.unit_mm != 1) {
      for (Vec3& p : raw.soup.positions) p *= options.unit_mm;
    }
    const bool merge = options.weld && !raw.welded;
    return weld(std::move(raw), merge);
  } catch (const Error& error) {
    throw error.in_file(name.string());
  }
}

MeshFile read_mesh(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
  if (is_step_file_name(path) && can_read_step()) {
    options.validate();
    MeshFile file;
    file.soup = read_step(path, options.step, progress);
    file.vertex_of_file_vertex.resize(file.soup.positions.size());
    std::iota(file.vertex_of_file_vertex.begin(), file.vertex_of_file_vertex.end(), 0);
    if (options.unit_mm != 1)
      file.notes.emplace_back("--unit has no effect with a STEP or IGES file, which names its own");
    return file;
  }
  return read_mesh_content(read_whole_file(path), path, options, progress);
}

}  // namespace isopath
