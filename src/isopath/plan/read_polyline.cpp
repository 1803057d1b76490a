#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"
#include "isopath/plan/make_sources.h"

namespace isopath {
namespace {

constexpr std::string_view blank = " \t\r,;";

/// Three finite numbers separated by blanks, commas or semicolons and nothing else.
std::optional<Vec3> point_in(std::string_view line) {
  Vec3 point;
  for (int i = 0; i < 3; ++i) {
    line.remove_prefix(std::min(line.find_first_not_of(blank), line.size()));
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), point[i]);
    if (error != std::errc() || !std::isfinite(point[i])) return std::nullopt;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    if (!line.empty() && blank.find(line.front()) == std::string_view::npos) return std::nullopt;
  }
  if (line.find_first_not_of(blank) != std::string_view::npos) return std::nullopt;
  return point;
}

}  // namespace

std::vector<Vec3> read_polyline(const std::filesystem::path& path) {
  const std::string content = read_whole_file(path);
  std::vector<Vec3> points;
  std::string_view rest = content;
  bool heading_allowed = true;
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (line.find_first_not_of(blank) == std::string_view::npos || line.front() == '#') continue;
    const auto point = point_in(line);
    if (point) {
      points.push_back(*point);
    } else if (!heading_allowed) {
      throw Error(ErrorCode::bad_input, "three numbers x,y,z belong here",
                  {.file = path.string(),
                   .element = fmt::format("line {}", number),
                   .value = fmt::format("'{}'", line.substr(0, 80))});
    }
    heading_allowed = false;
  }
  if (points.empty()) {
    throw Error(ErrorCode::bad_input, "the file holds no point",
                {.file = path.string(), .advice = "write one point x,y,z (mm) a line"});
  }
  return points;
}

}  // namespace isopath
