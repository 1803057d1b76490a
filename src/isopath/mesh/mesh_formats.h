#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/mesh/triangle_soup.h"

namespace isopath {

/// What one reader found in a file: vertices in the order of the file, polygons already split into triangles.
/// The readers below throw Error(bad_input) without the file's name; read_mesh() fills that in.
struct RawMesh {
  TriangleSoup soup;
  std::vector<std::string> notes = {};
  std::int64_t split_polygons = 0;
  bool welded = false;  ///< no two vertices are at the same position

  /// Adds a polygon as a fan around its first corner; it must have three corners or more.
  void add_polygon(std::span<const Index> corners);
};

/// The ending of a file's name with its dot, ASCII letters in lower case.
std::string lower_extension(const std::filesystem::path& path);

bool is_ascii_stl(std::string_view content);
/// A binary STL whose size agrees with its triangle count.
bool is_exact_binary_stl(std::string_view content);
bool is_off(std::string_view content);

/// STL; the vertices come welded, in order of first use.
RawMesh read_stl(std::string_view content, Progress& progress);
RawMesh read_obj(std::string_view content, Progress& progress);
RawMesh read_ply(std::string_view content, Progress& progress);
RawMesh read_off(std::string_view content, Progress& progress);

/// Throws when a header promises more elements than the bytes that follow it can hold, or more than an Index can count.
/// `element` says where the count stands.
void check_count(std::string_view noun, std::uint64_t count, std::uint64_t least_bytes_each, std::uint64_t bytes_left,
                 const std::string& element);

/// The value stored at `data`, in little or big endian.
template <typename T>
T load(const char* data, bool big_endian = false) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), data, sizeof(T));
  if (big_endian != (std::endian::native == std::endian::big)) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

}  // namespace isopath
