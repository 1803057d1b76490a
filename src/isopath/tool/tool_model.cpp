#include "isopath/tool/tool_model.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "isopath/core/error.h"

namespace isopath {
namespace {

[[noreturn]] void refuse(std::string_view field, double value, std::string_view limit) {
  throw Error(ErrorCode::bad_usage, fmt::format("{} is out of range", field),
              {.element = fmt::format("tool option {}", field), .value = fmt::format("{}; must be {}", value, limit)});
}

void require_positive(std::string_view field, double value) {
  if (!(value > 0) || !std::isfinite(value)) refuse(field, value, "finite and > 0");
}

void require_not_negative(std::string_view field, double value) {
  if (!(value >= 0) || !std::isfinite(value)) refuse(field, value, "finite and >= 0");
}

}  // namespace

std::string_view name_of(Process process) {
  switch (process) {
    case Process::spray:
      return "spray";
    case Process::mill:
      return "mill";
    case Process::grind:
      return "grind";
  }
  return "";
}

void ToolOptions::validate() const {
  require_positive("stand_off", stand_off);
  require_positive("ball_diameter", ball_diameter);
  require_positive("fixed_axis (its length)", fixed_axis.norm());
  require_positive("cover_feed_mm_per_min", cover_feed_mm_per_min);
  require_positive("link_feed_mm_per_min", link_feed_mm_per_min);
  require_positive("rapid_speed_mm_per_min", rapid_speed_mm_per_min);
  require_not_negative("chord_tolerance", chord_tolerance);
  require_not_negative("axis_tolerance", axis_tolerance);
}

}  // namespace isopath
