#include "isopath/plan/source_spec.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "isopath/core/error.h"

namespace isopath {
namespace {

using Kind = SourceSpec::Kind;

constexpr std::array<std::pair<std::string_view, Kind>, 7> kinds = {{{"auto", Kind::automatic},
                                                                     {"boundary", Kind::boundary},
                                                                     {"vertex", Kind::vertex},
                                                                     {"point", Kind::point},
                                                                     {"polyline", Kind::polyline},
                                                                     {"plane", Kind::plane},
                                                                     {"edges", Kind::edges}}};

[[noreturn]] void reject(std::string_view spec, std::string what, std::string value) {
  throw Error(ErrorCode::bad_usage, std::move(what),
              {.element = fmt::format("source '{}'", spec),
               .value = std::move(value),
               .advice = fmt::format("a source is one of\n{}", source_spec_forms())});
}

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t comma = text.find(',');
    parts.push_back(text.substr(0, comma));
    if (comma == std::string_view::npos) return parts;
    text.remove_prefix(comma + 1);
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

std::vector<double> numbers_of(std::string_view spec, std::string_view arguments, std::size_t wanted) {
  std::vector<double> numbers;
  for (const std::string_view part : split(arguments)) {
    const auto number = number_in<double>(part);
    if (!number || !std::isfinite(*number)) reject(spec, "not a number", fmt::format("'{}'", part));
    numbers.push_back(*number);
  }
  if (numbers.size() != wanted) {
    reject(spec, "wrong count of numbers", fmt::format("{} where {} belong", numbers.size(), wanted));
  }
  return numbers;
}

void check_ranges(std::string_view text, const SourceSpec& spec) {
  if (spec.kind == Kind::plane && spec.numbers[0] == 0 && spec.numbers[1] == 0 && spec.numbers[2] == 0) {
    reject(text, "the plane's normal is zero", "0,0,0");
  }
  if (spec.kind == Kind::edges && !(spec.numbers[0] > 0 && spec.numbers[0] < 180)) {
    reject(text, "the angle is out of range", fmt::format("{}, allowed is above 0 and below 180", spec.numbers[0]));
  }
}

}  // namespace

std::string_view source_spec_forms() {
  return "    auto                every boundary; on a closed part the vertex at its far end\n"
         "    boundary            every boundary loop\n"
         "    boundary:K          loop K, counted from 0, longest first\n"
         "    vertex:I,J,...      vertices, numbered from 0 as in the file\n"
         "    point:X,Y,Z         the nearest point of the surface (mm)\n"
         "    polyline:FILE.csv   points x,y,z (mm), one a line, brought to the surface and joined on it\n"
         "    plane:NX,NY,NZ,D    where the plane NX x + NY y + NZ z = D cuts the surface\n"
         "    edges:ANGLE         edges whose faces meet at more than ANGLE degrees";
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
      spec.numbers = numbers_of(text, arguments, 3);
      break;
    case Kind::plane:
      spec.numbers = numbers_of(text, arguments, 4);
      break;
    case Kind::edges:
      spec.numbers = numbers_of(text, arguments, 1);
      break;
    case Kind::polyline:
      spec.file = arguments;
      break;
  }
  check_ranges(text, spec);
  return spec;
}

std::string text_of(const SourceSpec& spec) {
  const auto known =
      std::find_if(kinds.begin(), kinds.end(), [&](const auto& entry) { return entry.second == spec.kind; });
  std::string text(known->first);
  if (!spec.indices.empty()) return fmt::format("{}:{}", text, fmt::join(spec.indices, ","));
  if (!spec.numbers.empty()) return fmt::format("{}:{}", text, fmt::join(spec.numbers, ","));
  if (!spec.file.empty()) return fmt::format("{}:{}", text, spec.file.string());
  return text;
}

}  // namespace isopath
