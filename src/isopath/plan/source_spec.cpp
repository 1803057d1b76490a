#include "isopath/plan/source_spec.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "isopath/core/error.h"

namespace isopath {
namespace {

using Kind = SourceSpec::Kind;

constexpr std::array<std::pair<std::string_view, Kind>, 11> kinds = {{{"auto", Kind::automatic},
                                                                      {"boundary", Kind::boundary},
                                                                      {"vertex", Kind::vertex},
                                                                      {"point", Kind::point},
                                                                      {"polyline", Kind::polyline},
                                                                      {"plane", Kind::plane},
                                                                      {"edges", Kind::edges},
                                                                      {"geodesic", Kind::geodesic},
                                                                      {"cut", Kind::cut},
                                                                      {"segment", Kind::segment},
                                                                      {"offset", Kind::offset}}};

[[noreturn]] void reject(std::string_view spec, std::string what, std::string value) {
  throw Error(ErrorCode::bad_usage, std::move(what),
              {.element = fmt::format("source '{}'", spec),
               .value = std::move(value),
               .advice = fmt::format("a source is one of\n{}", source_spec_forms())});
}

std::vector<std::string_view> split(std::string_view text, char separator = ',') {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

template <class Number>
std::optional<Number> number_in(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return std::nullopt;
  text = text.substr(first, text.find_last_not_of(' ') - first + 1);
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::vector<Index> indices_of(std::string_view spec, std::string_view arguments) {
  std::vector<Index> indices;
  for (const std::string_view part : split(arguments)) {
    const auto index = number_in<Index>(part);
    if (!index || *index < 0) reject(spec, "not an index", fmt::format("'{}', a whole number from 0", part));
    indices.push_back(*index);
  }
  return indices;
}

std::vector<double> numbers_of(std::string_view spec, std::string_view arguments) {
  std::vector<double> numbers;
  for (const std::string_view part : split(arguments)) {
    const auto number = number_in<double>(part);
    if (!number || !std::isfinite(*number)) reject(spec, "not a number", fmt::format("'{}'", part));
    numbers.push_back(*number);
  }
  return numbers;
}

/// The numbers of a list, of which there must be `least` to `most`.
std::vector<double> numbers_of(std::string_view spec, std::string_view arguments, std::size_t least, std::size_t most) {
  std::vector<double> numbers = numbers_of(spec, arguments);
  if (numbers.size() < least || numbers.size() > most) {
    const std::string wanted = least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most);
    reject(spec, "wrong count of numbers", fmt::format("{} where {} belong", numbers.size(), wanted));
  }
  return numbers;
}

/// The two lists of a source that is written NAME:LIST:LIST.
std::pair<std::string_view, std::string_view> two_lists(std::string_view spec, std::string_view arguments) {
  const std::vector<std::string_view> lists = split(arguments, ':');
  if (lists.size() != 2) reject(spec, "wrong count of values", fmt::format("{} where 2 belong", lists.size()));
  return {lists[0], lists[1]};
}

void append(std::vector<double>& numbers, const std::vector<double>& more) {
  numbers.insert(numbers.end(), more.begin(), more.end());
}

void read_cut(std::string_view text, std::string_view arguments, SourceSpec& spec) {
  const auto [place, angles] = two_lists(text, arguments);
  spec.numbers = numbers_of(text, place);
  if (spec.numbers.size() != 3 && spec.numbers.size() != 1) {
    reject(text, "wrong count of numbers",
           fmt::format("{} where a point of 3 or an offset of 1 belong", spec.numbers.size()));
  }
  append(spec.numbers, numbers_of(text, angles, 1, 2));
}

void read_segment(std::string_view text, std::string_view arguments, SourceSpec& spec) {
  const auto [first, second] = two_lists(text, arguments);
  if (split(first).size() == 1) {
    spec.indices = indices_of(text, first);
    spec.numbers = numbers_of(text, second, 2, 2);
    return;
  }
  spec.numbers = numbers_of(text, first, 3, 3);
  append(spec.numbers, numbers_of(text, second, 3, 3));
}

void check_ranges(std::string_view text, const SourceSpec& spec) {
  if (spec.kind == Kind::plane && spec.numbers[0] == 0 && spec.numbers[1] == 0 && spec.numbers[2] == 0) {
    reject(text, "the plane's normal is zero", "0,0,0");
  }
  const bool has_edges = spec.kind == Kind::edges || spec.kind == Kind::offset;
  if (has_edges && !(spec.numbers[0] > 0 && spec.numbers[0] < 180)) {
    reject(text, "the angle is out of range", fmt::format("{}, allowed is above 0 and below 180", spec.numbers[0]));
  }
  if (spec.kind == Kind::offset && !(spec.numbers[1] > 0)) {
    reject(text, "the distance is out of range", fmt::format("{}, allowed is above 0", spec.numbers[1]));
  }
  if (spec.kind == Kind::segment && !spec.indices.empty() && spec.numbers[0] == spec.numbers[1]) {
    reject(text, "the segment has no length", fmt::format("from {} to {}", spec.numbers[0], spec.numbers[1]));
  }
}

/// How many of the numbers stand before the second colon.
std::size_t length_of_first_list(const SourceSpec& spec) {
  const std::size_t n = spec.numbers.size();
  if (spec.kind == Kind::cut) return n > 3 ? 3 : 1;
  return n == 6 ? 3 : n;
}

}  // namespace

std::string_view source_spec_forms() {
  return "    auto                every boundary, for two-way the longest of each part; on a closed part the vertex at "
         "its far end\n"
         "    boundary            every boundary loop\n"
         "    boundary:K          loop K, counted from 0, longest first\n"
         "    vertex:I,J,...      vertices, numbered from 0 as in the file\n"
         "    point:X,Y,Z         the nearest point of the surface (mm)\n"
         "    polyline:FILE.csv   points x,y,z (mm), one a line, brought to the surface and joined on it\n"
         "    plane:NX,NY,NZ,D    where the plane NX x + NY y + NZ z = D cuts the surface\n"
         "    edges:ANGLE         edges whose faces meet at more than ANGLE degrees\n"
         "    geodesic:X,Y,Z:X,Y,Z\n"
         "                        the shortest line through two points, straight on to the boundary either way\n"
         "    cut:X,Y,Z:ANGLE[,TILT], cut:OFFSET:ANGLE[,TILT]\n"
         "                        where a plane cuts the surface: through a point, or OFFSET mm from the part's "
         "middle;\n"
         "                        seen from above it runs at ANGLE degrees from x, and leans to the left by TILT\n"
         "    segment:X,Y,Z:X,Y,Z, segment:K:FROM,TO\n"
         "                        the boundary between two points, or between two shares (0 to 1) of loop K's length,\n"
         "                        walked with the surface on the left\n"
         "    offset:ANGLE,D      all places D mm from the edges whose faces meet at more than ANGLE degrees";
}

SourceSpec parse_source_spec(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view name = text.substr(0, colon);
  const auto known = std::find_if(kinds.begin(), kinds.end(), [&](const auto& entry) { return entry.first == name; });
  if (known == kinds.end()) reject(text, "unknown kind of source", fmt::format("'{}'", name));

  SourceSpec spec{.kind = known->second};
  const bool bare = colon == std::string_view::npos;
  if (spec.kind == Kind::automatic && !bare) reject(text, "'auto' takes no value", std::string(text.substr(colon + 1)));
  if (spec.kind == Kind::automatic || (spec.kind == Kind::boundary && bare)) return spec;

  const std::string_view arguments = bare ? std::string_view() : text.substr(colon + 1);
  if (arguments.empty()) reject(text, "a value is missing", fmt::format("nothing after '{}:'", name));
  switch (spec.kind) {
    case Kind::automatic:
      break;
    case Kind::boundary:
    case Kind::vertex:
      spec.indices = indices_of(text, arguments);
      break;
    case Kind::point:
      spec.numbers = numbers_of(text, arguments, 3, 3);
      break;
    case Kind::plane:
      spec.numbers = numbers_of(text, arguments, 4, 4);
      break;
    case Kind::edges:
      spec.numbers = numbers_of(text, arguments, 1, 1);
      break;
    case Kind::polyline:
      spec.file = arguments;
      break;
    case Kind::geodesic: {
      const auto [first, second] = two_lists(text, arguments);
      spec.numbers = numbers_of(text, first, 3, 3);
      append(spec.numbers, numbers_of(text, second, 3, 3));
      break;
    }
    case Kind::cut:
      read_cut(text, arguments, spec);
      break;
    case Kind::segment:
      read_segment(text, arguments, spec);
      break;
    case Kind::offset:
      spec.numbers = numbers_of(text, arguments, 2, 2);
      break;
  }
  check_ranges(text, spec);
  return spec;
}

std::string text_of(const SourceSpec& spec) {
  const auto known =
      std::find_if(kinds.begin(), kinds.end(), [&](const auto& entry) { return entry.second == spec.kind; });
  std::string text(known->first);
  if (!spec.indices.empty()) text += fmt::format(":{}", fmt::join(spec.indices, ","));
  const std::span<const double> numbers = spec.numbers;
  const std::size_t first = length_of_first_list(spec);
  if (first > 0) text += fmt::format(":{}", fmt::join(numbers.first(first), ","));
  if (first < numbers.size()) text += fmt::format(":{}", fmt::join(numbers.subspan(first), ","));
  if (!spec.file.empty()) text += fmt::format(":{}", spec.file.string());
  return text;
}

}  // namespace isopath
