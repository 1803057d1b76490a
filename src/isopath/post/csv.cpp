#include "isopath/post/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <system_error>

#include "isopath/core/error.h"
#include "isopath/tool/tool_frames.h"

namespace isopath {
namespace {

constexpr std::string_view tool_header = "index,piece,kind,x,y,z,i,j,k,feed,t";
constexpr std::size_t tool_columns = 11;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t\r";
  const std::size_t first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

/// One line of a tool.csv, and how to complain about it.
class Line {
 public:
  Line(std::string_view text, std::size_t number) : number_(number) {
    std::size_t count = 0;
    for (std::size_t begin = 0; begin <= text.size(); ++count) {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      if (count < tool_columns) fields_[count] = trimmed(text.substr(begin, end - begin));
      begin = end + 1;
    }
    if (count != tool_columns) refuse("wrong number of fields", fmt::format("{}; expected {}", count, tool_columns));
  }

  [[noreturn]] void refuse(std::string_view what, const std::string& value) const {
    throw Error(ErrorCode::bad_input, std::string(what),
                {.element = fmt::format("line {}", number_),
                 .value = value,
                 .advice = fmt::format("columns: {}", tool_header)});
  }

  template <class Number>
  Number number(std::size_t column, std::string_view name) const {
    const std::string_view text = fields_[column];
    Number value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(double(value))) {
      refuse(fmt::format("{} is not a number", name), fmt::format("'{}'", text));
    }
    return value;
  }

  Vec3 vector(std::size_t column, std::string_view name) const {
    return {number<double>(column, name), number<double>(column + 1, name), number<double>(column + 2, name)};
  }

  MoveKind kind(std::size_t column) const {
    for (const MoveKind kind : {MoveKind::cover, MoveKind::link, MoveKind::lift}) {
      if (fields_[column] == name_of(kind)) return kind;
    }
    refuse("kind is not cover, link or lift", fmt::format("'{}'", fields_[column]));
  }

 private:
  std::size_t number_;
  std::array<std::string_view, tool_columns> fields_;
};

ToolPoint read_point(const Line& line, const ToolPoint* before) {
  ToolPoint point;
  line.number<std::int64_t>(0, "index");
  point.piece = line.number<Index>(1, "piece");
  point.kind = line.kind(2);
  point.tip = line.vector(3, "x, y or z");
  point.axis = line.vector(6, "i, j or k");
  point.feed_mm_per_min = line.number<double>(9, "feed");
  point.time = line.number<double>(10, "t");
  const double length = point.axis.norm();
  if (!(std::abs(length - 1) < 1e-6))
    line.refuse("the tool axis is not a unit vector", fmt::format("length {}", length));
  if (before == nullptr) return point;
  if (!(point.feed_mm_per_min > 0)) line.refuse("feed must be > 0", fmt::format("{}", point.feed_mm_per_min));
  if (point.piece < before->piece) line.refuse("pieces count backwards", fmt::format("{}", point.piece));
  if (point.time < before->time) line.refuse("time runs backwards", fmt::format("{}", point.time));
  return point;
}

}  // namespace

std::string impact_csv(const ImpactCurve& curve) {
  std::string text = "index,piece,kind,x,y,z,nx,ny,nz,s\n";
  double s = 0;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const ImpactPoint& point = curve.points[i];
    if (i > 0) s += (point.position - curve.points[i - 1].position).norm();
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},{}\n", i, point.piece, name_of(point.kind),
                   point.position.x(), point.position.y(), point.position.z(), point.normal.x(), point.normal.y(),
                   point.normal.z(), s);
  }
  return text;
}

std::string tool_csv(const ToolPath& path) {
  std::string text = fmt::format("{}\n", tool_header);
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const ToolPoint& point = path.points[i];
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},{},{}\n", i, point.piece, name_of(point.kind),
                   point.tip.x(), point.tip.y(), point.tip.z(), point.axis.x(), point.axis.y(), point.axis.z(),
                   point.feed_mm_per_min, point.time);
  }
  return text;
}

ToolPath read_tool_csv(std::string_view text) {
  ToolPath path;
  bool header_seen = false;
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (line.empty()) continue;
    if (!header_seen && line != tool_header) {
      throw Error(ErrorCode::bad_input, "not a tool path: the header is missing",
                  {.element = fmt::format("line {}", number),
                   .value = fmt::format("'{}'", line.substr(0, 60)),
                   .advice = fmt::format("the first line must be {}", tool_header)});
    }
    if (header_seen) {
      path.points.push_back(read_point({line, number}, path.points.empty() ? nullptr : &path.points.back()));
    }
    header_seen = true;
  }
  if (!header_seen) throw Error(ErrorCode::bad_input, "not a tool path: the text is empty");
  set_tangents(path);
  return path;
}

}  // namespace isopath
