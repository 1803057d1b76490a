#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/mesh/mesh_formats.h"
#include "isopath/mesh/text_scanner.h"

namespace isopath {
namespace {

struct OffHeader {
  std::string flags;  ///< letters before "OFF": ST texture, C colours, N normals, 4 and n other dimensions
  std::string_view rest;
};

/// Splits the first word around "OFF"; false when it is no OFF keyword. "OFF8" is "OFF" followed by 8.
bool parse_keyword(std::string_view word, OffHeader& header) {
  const std::size_t at = word.find("OFF");
  if (at == std::string_view::npos || at > 5) return false;
  header.flags = word.substr(0, at);
  header.rest = word.substr(at + 3);
  return header.flags.find_first_not_of("STCN4n") == std::string::npos &&
         header.rest.find_first_not_of("0123456789") == std::string_view::npos;
}

[[noreturn]] void fail_at(std::size_t byte, std::string what, std::string value) {
  throw Error(ErrorCode::bad_input, std::move(what),
              {.element = fmt::format("byte {}", byte),
               .value = std::move(value),
               .advice = "the file is cut short, or in another byte order; export it as ASCII OFF"});
}

/// The "OFF BINARY" of pmp-library and its kin: three 32-bit counts, float coordinates and 32-bit indices, little
/// endian, no colours.
RawMesh read_binary_off(std::string_view content, std::size_t at, Progress& progress) {
  if (content.size() - at < 12) fail_at(at, "binary OFF ends in its header", "12 bytes of counts expected");
  const auto n_vertices = load<std::uint32_t>(content.data() + at);
  const auto n_faces = load<std::uint32_t>(content.data() + at + 4);
  const std::string element = fmt::format("byte {}", at);
  at += 12;
  check_count("vertices", n_vertices, 12, content.size() - at, element);
  check_count("faces", n_faces, 16, content.size() - at - 12 * std::size_t{n_vertices}, element);
  RawMesh mesh;
  mesh.soup.positions.reserve(n_vertices);
  for (std::uint32_t v = 0; v < n_vertices; ++v, at += 12) {
    const char* p = content.data() + at;
    mesh.soup.positions.emplace_back(load<float>(p), load<float>(p + 4), load<float>(p + 8));
  }
  mesh.soup.triangles.reserve(n_faces);
  std::vector<Index> corners;
  for (std::uint32_t f = 0; f < n_faces; ++f) {
    if (f % 16384 == 0) progress.checkpoint();
    if (content.size() - at < 4) fail_at(at, "binary OFF ends before its last face", fmt::format("face {}", f));
    const auto n = load<std::uint32_t>(content.data() + at);
    if (n < 3 || n > (content.size() - at - 4) / 4) {
      fail_at(at, "face has an impossible number of corners", fmt::format("face {}: {} corners", f, n));
    }
    corners.resize(n);
    at += 4;
    for (Index& corner : corners) {
      const auto index = load<std::uint32_t>(content.data() + at);
      if (index >= n_vertices) {
        fail_at(at, "vertex index out of range", fmt::format("face {}: vertex {} of {}", f, index, n_vertices));
      }
      corner = static_cast<Index>(index);
      at += 4;
    }
    mesh.add_polygon(corners);
  }
  if (at < content.size()) {
    mesh.notes.push_back(fmt::format("{} bytes after the last face were ignored", content.size() - at));
  }
  return mesh;
}

std::uint64_t read_count(TextScanner& scanner, std::string_view word, std::string_view what) {
  const long long count = scanner.to_integer(word, what);
  if (count < 0)
    scanner.fail(fmt::format("{} is negative", what), word, "the header is damaged; export the file again");
  return static_cast<std::uint64_t>(count);
}

void next_element_line(TextScanner& scanner, std::string_view noun, std::uint64_t index, std::uint64_t count) {
  if (scanner.next_line()) return;
  scanner.fail(fmt::format("the file ends before {} {} of {}", noun, index, count), {},
               "the file is cut short; export it again");
}

void read_vertices(TextScanner& scanner, std::uint64_t count, RawMesh& mesh, Progress& progress) {
  mesh.soup.positions.reserve(count);
  for (std::uint64_t v = 0; v < count; ++v) {
    if (v % 16384 == 0) progress.checkpoint();
    next_element_line(scanner, "vertex", v, count);
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = scanner.number("a vertex coordinate");
    mesh.soup.positions.push_back(p);
  }
}

void read_faces(TextScanner& scanner, std::uint64_t count, std::uint64_t n_vertices, RawMesh& mesh,
                Progress& progress) {
  mesh.soup.triangles.reserve(count);
  std::vector<Index> corners;
  for (std::uint64_t f = 0; f < count; ++f) {
    if (f % 16384 == 0) progress.checkpoint();
    next_element_line(scanner, "face", f, count);
    const std::string_view size = scanner.word();
    const long long n = scanner.to_integer(size, "the number of corners");
    if (n < 3) scanner.fail("a face needs three corners", size, "remove the face or export the file again");
    corners.clear();
    for (long long i = 0; i < n; ++i) {
      const std::string_view word = scanner.word();
      const long long index = scanner.to_integer(word, "a vertex index");
      if (index < 0 || index >= static_cast<long long>(n_vertices)) {
        scanner.fail("vertex index out of range", fmt::format("{} of {} vertices", word, n_vertices),
                     "OFF counts vertices from 0; the file is damaged, export it again");
      }
      corners.push_back(static_cast<Index>(index));
    }
    mesh.add_polygon(corners);
  }
}

}  // namespace

bool is_off(std::string_view content) {
  TextScanner scanner(content.substr(0, 4096), '#');
  OffHeader header;
  return parse_keyword(scanner.next_word(), header);
}

RawMesh read_off(std::string_view content, Progress& progress) {
  TextScanner scanner(content, '#');
  OffHeader header;
  const std::string_view keyword = scanner.next_word();
  if (!parse_keyword(keyword, header)) {
    scanner.fail("the keyword 'OFF' is missing", keyword, "the first word of an OFF file is OFF");
  }
  if (header.flags.find_first_of("4n") != std::string::npos) {
    scanner.fail("OFF in more than three dimensions is not a surface in space", keyword, "export it as plain OFF");
  }
  const bool binary = scanner.rest_of_line().find("BINARY") != std::string_view::npos;
  if (binary) {
    if (!header.flags.empty()) {
      scanner.fail("binary OFF with normals or colours is not read", keyword, "export it as ASCII OFF");
    }
    return read_binary_off(content, scanner.next_line_offset(), progress);
  }
  const std::string_view first = header.rest.empty() ? scanner.next_word() : header.rest;
  const std::uint64_t n_vertices = read_count(scanner, first, "the number of vertices");
  const std::uint64_t n_faces = read_count(scanner, scanner.next_word(), "the number of faces");
  const std::string element = fmt::format("line {}", scanner.line());
  scanner.skip_line();  // the number of edges, which nobody needs
  check_count("vertices", n_vertices, 5, scanner.bytes_left() + 1, element);
  check_count("faces", n_faces, 7, scanner.bytes_left() + 1, element);
  RawMesh mesh;
  read_vertices(scanner, n_vertices, mesh, progress);
  read_faces(scanner, n_faces, n_vertices, mesh, progress);
  if (scanner.next_line()) {
    mesh.notes.push_back(fmt::format("text from line {} on, after the last face, was ignored", scanner.line()));
  }
  return mesh;
}

}  // namespace isopath
