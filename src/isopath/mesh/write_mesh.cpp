#include "isopath/mesh/write_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"

namespace isopath {
namespace {

template <typename T>
void append(std::string& out, T value) {
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
  out.append(bytes.data(), bytes.size());
}

float to_single(double value, std::size_t triangle) {
  if (std::isfinite(value) && std::abs(value) > std::numeric_limits<float>::max()) {
    throw Error(ErrorCode::bad_input, "coordinate is too large for STL, which is single precision",
                {.element = fmt::format("triangle {}", triangle),
                 .value = fmt::format("{}", value),
                 .advice = "write OBJ, PLY or OFF instead"});
  }
  return static_cast<float>(value);
}

std::string stl_content(const TriangleSoup& soup) {
  std::string out(80, ' ');
  // Not "solid": that would announce ASCII.
  const std::string_view title = "binary STL written by isopath, unit mm";
  std::copy(title.begin(), title.end(), out.begin());
  out.reserve(84 + 50 * soup.triangles.size());
  append(out, static_cast<std::uint32_t>(soup.triangles.size()));
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const auto& [a, b, c] = soup.triangles[t];
    const Vec3 normal =
        (soup.positions[b] - soup.positions[a]).cross(soup.positions[c] - soup.positions[a]).stableNormalized();
    for (int k = 0; k < 3; ++k) append(out, std::isfinite(normal[k]) ? static_cast<float>(normal[k]) : 0.0F);
    for (const Index v : soup.triangles[t]) {
      for (int k = 0; k < 3; ++k) append(out, to_single(soup.positions[v][k], t));
    }
    append(out, std::uint16_t{0});
  }
  return out;
}

std::string obj_content(const TriangleSoup& soup) {
  std::string out = "# written by isopath, unit mm\n";
  for (const Vec3& p : soup.positions) fmt::format_to(std::back_inserter(out), "v {} {} {}\n", p.x(), p.y(), p.z());
  for (const auto& [a, b, c] : soup.triangles) {
    fmt::format_to(std::back_inserter(out), "f {} {} {}\n", a + 1, b + 1, c + 1);
  }
  return out;
}

std::string off_content(const TriangleSoup& soup) {
  std::string out = fmt::format("OFF\n{} {} 0\n", soup.positions.size(), soup.triangles.size());
  for (const Vec3& p : soup.positions) fmt::format_to(std::back_inserter(out), "{} {} {}\n", p.x(), p.y(), p.z());
  for (const auto& [a, b, c] : soup.triangles) fmt::format_to(std::back_inserter(out), "3 {} {} {}\n", a, b, c);
  return out;
}

std::string ply_content(const TriangleSoup& soup, std::span<const double> distance) {
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment written by isopath, unit mm\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\n{}"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      soup.positions.size(), distance.empty() ? "" : "property double distance\n", soup.triangles.size());
  out.reserve(out.size() + 32 * soup.positions.size() + 13 * soup.triangles.size());
  for (std::size_t v = 0; v < soup.positions.size(); ++v) {
    for (int k = 0; k < 3; ++k) append(out, soup.positions[v][k]);
    if (!distance.empty()) append(out, distance[v]);
  }
  for (const Triangle& triangle : soup.triangles) {
    append(out, std::uint8_t{3});
    for (const Index v : triangle) append(out, v);
  }
  return out;
}

[[noreturn]] void refuse(const std::filesystem::path& path, std::string what, std::string value, std::string advice) {
  throw Error(ErrorCode::bad_usage, std::move(what),
              {.file = path.string(), .value = std::move(value), .advice = std::move(advice)});
}

}  // namespace

void write_mesh(const std::filesystem::path& path, const TriangleSoup& soup, const WriteOptions& options) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  const std::span<const double> distance = options.distance;
  if (!distance.empty() && distance.size() != soup.positions.size()) {
    refuse(path, "the distance needs one value a vertex",
           fmt::format("{} values, {} vertices", distance.size(), soup.positions.size()), "pass the vertices' field");
  }
  if (!distance.empty() && extension != ".ply") {
    refuse(path, "this format cannot carry a distance", extension, "write .ply or .vtp");
  }
  try {
    if (extension == ".stl") return write_file_atomically(path, stl_content(soup));
    if (extension == ".obj") return write_file_atomically(path, obj_content(soup));
    if (extension == ".off") return write_file_atomically(path, off_content(soup));
    if (extension == ".ply") return write_file_atomically(path, ply_content(soup, distance));
  } catch (const Error& error) {
    throw error.in_file(path.string());
  }
  refuse(path, "unknown mesh format to write", extension, "give a name that ends in .stl, .obj, .ply or .off");
}

}  // namespace isopath
