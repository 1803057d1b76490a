#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/mesh/mesh_formats.h"
#include "isopath/mesh/text_scanner.h"
#include "isopath/mesh/weld.h"

namespace isopath {
namespace {

constexpr std::size_t header_size = 84;  // 80 bytes of comment and the triangle count
constexpr std::size_t facet_size = 50;   // normal, three corners, two bytes of attributes

bool same_word(std::string_view word, std::string_view lower) {
  return word.size() == lower.size() && std::equal(word.begin(), word.end(), lower.begin(), [](char a, char b) {
           return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b;
         });
}

/// Collects corners in blocks and welds a block at a time.
class FacetCollector {
 public:
  explicit FacetCollector(std::size_t expected) : welder_(expected / 2 + 16) { triangles_.reserve(expected); }

  void add(const Vec3& corner) {
    block_[filled_++] = corner;
    if (filled_ == block_.size()) flush();
  }

  TriangleSoup take() {
    flush();
    return {welder_.take_points(), std::move(triangles_)};
  }

 private:
  void flush() {
    std::array<Index, 3 * 256> numbers;
    welder_.add(std::span(block_.data(), filled_), numbers);
    for (std::size_t i = 0; i < filled_; i += 3) triangles_.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
    filled_ = 0;
  }

  PointWelder welder_;
  std::vector<Triangle> triangles_;
  std::array<Vec3, 3 * 256> block_;
  std::size_t filled_ = 0;
};

RawMesh read_binary_stl(std::string_view content, Progress& progress) {
  if (content.size() < header_size) {
    throw Error(ErrorCode::bad_input, "binary STL is shorter than its header",
                {.element = fmt::format("byte {}", content.size()),
                 .value = fmt::format("{} bytes of {}", content.size(), header_size),
                 .advice = "the file is cut short; export it again"});
  }
  const auto count = load<std::uint32_t>(content.data() + 80);
  const std::size_t held = (content.size() - header_size) / facet_size;
  if (count > held) {
    throw Error(ErrorCode::bad_input, "binary STL ends before its last triangle",
                {.element = fmt::format("triangle {}, byte {}", held, header_size + held * facet_size),
                 .value = fmt::format("{} triangles announced, {} there", count, held),
                 .advice = "the file is cut short or its header is wrong; export it again"});
  }
  check_count("triangles", count, facet_size, content.size() - header_size, "byte 80");
  FacetCollector facets(count);
  for (std::uint32_t f = 0; f < count; ++f) {
    if (f % 65536 == 0) {
      progress.checkpoint();
      progress.at(static_cast<double>(f) / count);
    }
    const char* corner = content.data() + header_size + f * facet_size + 12;
    for (int i = 0; i < 3; ++i, corner += 12) {
      facets.add({load<float>(corner), load<float>(corner + 4), load<float>(corner + 8)});
    }
  }
  RawMesh mesh{.soup = facets.take(), .welded = true};
  if (const std::size_t left = content.size() - header_size - count * facet_size; left > 0) {
    mesh.notes.push_back(fmt::format("{} bytes after the last triangle were ignored", left));
  }
  return mesh;
}

constexpr const char* ascii_advice = "the file is cut short or damaged; export it again";

void expect(TextScanner& scanner, std::string_view wanted) {
  const std::string_view found = scanner.next_word();
  if (!same_word(found, wanted)) scanner.fail(fmt::format("'{}' is missing", wanted), found, ascii_advice);
}

/// From after "facet" to "endfacet". The normal is not used, so it may be anything.
void read_facet(TextScanner& scanner, FacetCollector& facets) {
  expect(scanner, "normal");
  for (int i = 0; i < 3; ++i) scanner.next_word();
  expect(scanner, "outer");
  expect(scanner, "loop");
  for (int i = 0; i < 3; ++i) {
    expect(scanner, "vertex");
    Vec3 corner;
    for (int k = 0; k < 3; ++k) corner[k] = scanner.to_number(scanner.next_word(), "a vertex coordinate");
    facets.add(corner);
  }
  expect(scanner, "endloop");
  expect(scanner, "endfacet");
}

RawMesh read_ascii_stl(std::string_view content, Progress& progress) {
  TextScanner scanner(content);
  FacetCollector facets(content.size() / 250);
  int solids = 0;
  bool open = false;
  std::size_t words = 0;
  for (std::string_view word = scanner.next_word(); !word.empty(); word = scanner.next_word()) {
    if (words++ % 4096 == 0) progress.checkpoint();
    if (same_word(word, "facet")) {
      read_facet(scanner, facets);
    } else if (same_word(word, "solid")) {
      ++solids;
      open = true;
      scanner.skip_line();
    } else if (same_word(word, "endsolid")) {
      open = false;
      scanner.skip_line();
    } else {
      scanner.fail("expected 'solid', 'facet' or 'endsolid'", word, ascii_advice);
    }
  }
  RawMesh mesh{.soup = facets.take(), .welded = true};
  if (solids > 1) mesh.notes.push_back(fmt::format("{} solids were joined", solids));
  if (open) mesh.notes.emplace_back("the last 'endsolid' is missing");
  return mesh;
}

}  // namespace

bool is_exact_binary_stl(std::string_view content) {
  return content.size() >= header_size &&
         content.size() - header_size == std::uint64_t{load<std::uint32_t>(content.data() + 80)} * facet_size;
}

bool is_ascii_stl(std::string_view content) {
  const std::string_view start = content.substr(0, 1024);
  if (start.find('\0') != std::string_view::npos) return false;
  TextScanner scanner(start);
  if (!same_word(scanner.next_word(), "solid")) return false;
  scanner.skip_line();
  const std::string_view next = scanner.next_word();
  return next.empty() || same_word(next, "facet") || same_word(next, "endsolid") || same_word(next, "solid");
}

RawMesh read_stl(std::string_view content, Progress& progress) {
  if (!is_exact_binary_stl(content) && is_ascii_stl(content)) return read_ascii_stl(content, progress);
  return read_binary_stl(content, progress);
}

}  // namespace isopath
