#include "isopath/plan/job.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/post/export.h"

namespace isopath {
namespace {

constexpr std::array<std::pair<std::string_view, std::optional<Pattern>>, 8> patterns = {
    {{"auto", std::nullopt},
     {"contour", Pattern::contour},
     {"spiral", Pattern::spiral},
     {"double-spiral", Pattern::double_spiral},
     {"meander", Pattern::meander},
     {"two-way", Pattern::two_way},
     {"trochoidal", Pattern::trochoidal},
     {"planar", Pattern::planar}}};

[[noreturn]] void refuse_name(const char* what, std::string_view name, const std::vector<std::string_view>& allowed) {
  throw Error(ErrorCode::bad_usage, fmt::format("unknown {}", what),
              {.value = fmt::format("'{}'", name), .advice = fmt::format("allowed: {}", fmt::join(allowed, ", "))});
}

template <class Value, std::size_t n>
Value value_named(const char* what, std::string_view name, const std::array<Value, n>& values) {
  std::vector<std::string_view> names;
  for (const Value& value : values) {
    if (name_of(value) == name) return value;
    names.push_back(name_of(value));
  }
  refuse_name(what, name, names);
}

[[noreturn]] void refuse(const char* field, std::string value, std::string advice = {}) {
  throw Error(ErrorCode::bad_usage, "the job cannot be run like this",
              {.element = field, .value = std::move(value), .advice = std::move(advice)});
}

void validate_blend(const Job& job) {
  if (job.pattern == Pattern::double_spiral && job.blend == Blending::none) {
    refuse("blend", "none with the pattern double-spiral",
           "a double spiral needs nested levels, which only blending makes: leave it out, or take spiral or two-way");
  }
  if (!form_of(job.blend)) return;
  if (job.pattern == Pattern::planar || job.pattern == Pattern::meander) {
    refuse("blend", fmt::format("with the pattern {}", name_of(job.pattern)),
           "blended isolines are closed curves: take spiral, double-spiral, contour or two-way");
  }
  if (job.scallop > 0) refuse("blend", "with a scallop", "distances are blended in space only");
}

void validate_scallop(const Job& job) {
  const double height = job.scallop;
  if (!(height >= 0) || height == infinity) refuse("scallop", fmt::format("{}, allowed is 0 or more", height));
  if (height == 0) return;
  if (job.spacing > 0) {
    refuse("scallop", fmt::format("{} with a spacing of {}", height, job.spacing),
           "the scallop's height gives the spacing: leave one of them out");
  }
  if (job.tool.process == Process::spray) refuse("scallop", fmt::format("{}", height), "a spray leaves no cusps");
  if (!(height < 0.5 * job.tool.ball_diameter)) {
    refuse("scallop", fmt::format("{}, the ball's radius is {}", height, 0.5 * job.tool.ball_diameter),
           "give less than the radius");
  }
}

void validate_partition(const Job& job) {
  job.partition.validate();
  if (job.partition.by == PartitionBy::none) return;
  if (job.sources != std::vector{SourceSpec{}}) {
    refuse("partition",
           fmt::format("{} with source '{}'", name_of(job.partition.by),
                       job.sources.empty() ? "" : text_of(job.sources.front())),
           "every patch is measured from its own border: leave out the sources");
  }
}

void validate_programs(const Job& job) {
  for (const std::string& format : job.programs) {
    check_program_format(format);
    if (job.tool.axis_mode != AxisMode::fixed_direction) continue;
    const Vec3 axis = job.tool.fixed_axis.normalized();
    if (holds_axis(format, axis)) continue;
    refuse("programs",
           fmt::format("{} with a tool axis of {:.6g}, {:.6g}, {:.6g}", format, axis.x(), axis.y(), axis.z()),
           format == "gcode3" ? "a program for 3 axes needs the axis 0, 0, 1: turn the part, or take another format"
                              : "the table does not tilt that far: turn the part, or take poses, for example yaml");
  }
}

}  // namespace

std::string_view name_of(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::millimetre:
      return "mm";
    case LengthUnit::centimetre:
      return "cm";
    case LengthUnit::metre:
      return "m";
    case LengthUnit::inch:
      return "inch";
  }
  return "";
}

double millimetres_in(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::millimetre:
      return 1;
    case LengthUnit::centimetre:
      return 10;
    case LengthUnit::metre:
      return 1000;
    case LengthUnit::inch:
      return 25.4;
  }
  return 1;
}

std::string_view name_of(const std::optional<Pattern>& pattern) {
  for (const auto& [name, choice] : patterns) {
    if (choice == pattern) return name;
  }
  return "";
}

std::optional<Pattern> pattern_of(std::string_view name) {
  std::vector<std::string_view> names;
  for (const auto& [known, choice] : patterns) {
    if (known == name) return choice;
    names.push_back(known);
  }
  refuse_name("pattern", name, names);
}

std::string_view name_of(Blending blending) {
  switch (blending) {
    case Blending::automatic:
      return "auto";
    case Blending::none:
      return "none";
    case Blending::least:
      return "least";
    case Blending::paper:
      return "paper";
  }
  return "";
}

std::optional<BlendForm> form_of(Blending blending) {
  if (blending == Blending::least) return BlendForm::least;
  if (blending == Blending::paper) return BlendForm::paper;
  return std::nullopt;
}

Blending blending_of(std::string_view name) {
  return value_named("blend", name, std::array{Blending::automatic, Blending::none, Blending::least, Blending::paper});
}

Process process_of(std::string_view name) {
  return value_named("process", name, std::array{Process::spray, Process::mill, Process::grind});
}

LengthUnit unit_of(std::string_view name) {
  return value_named("unit", name,
                     std::array{LengthUnit::millimetre, LengthUnit::centimetre, LengthUnit::metre, LengthUnit::inch});
}

PartitionBy partition_of(std::string_view name) {
  return value_named("partition", name,
                     std::array{PartitionBy::none, PartitionBy::creases, PartitionBy::medial, PartitionBy::both});
}

void check_program_format(std::string_view name) {
  std::vector<std::string_view> names;
  for (const ExportFormat& format : export_formats()) names.push_back(format.name);
  if (std::find(names.begin(), names.end(), name) == names.end()) refuse_name("program format", name, names);
}

void Job::validate() const {
  if (mesh.empty()) refuse("mesh", "no file is named", "name the mesh file to plan on");
  if (sources.empty() && pattern != Pattern::planar) refuse("sources", "none given", "'auto' chooses one");
  if (!(spacing >= 0) || spacing == infinity) refuse("spacing", fmt::format("{}, allowed is 0 or more", spacing));
  if (!(clearance >= 0) || clearance == infinity) {
    refuse("clearance", fmt::format("{}, allowed is 0 or more", clearance));
  }
  const auto check_length = [](const char* field, double length) {
    if (!(length >= 0) || length == infinity) refuse(field, fmt::format("{}, allowed is 0 or more", length));
  };
  check_length("circle_radius", circle_radius);
  check_length("circle_step", circle_step);
  check_length("min_radius", min_radius);
  if (scallop > 0 && pattern == Pattern::trochoidal) {
    refuse("scallop", fmt::format("{} with circles", scallop), "circles need a spacing: give one instead");
  }
  if (!planar_direction.allFinite()) {
    refuse("planar_direction",
           fmt::format("{}, {}, {} is no direction", planar_direction.x(), planar_direction.y(), planar_direction.z()));
  }
  if (!(smooth >= 0) || smooth == infinity) refuse("smooth", fmt::format("{}, allowed is 0 or more", smooth));
  if (smooth > 0 && pattern == Pattern::planar) {
    refuse("smooth", fmt::format("{}", smooth), "parallel planes have nothing to smooth: leave it out");
  }
  if (smooth > 0 && pattern == Pattern::trochoidal) {
    refuse("smooth", fmt::format("{}", smooth), "circles have no corners to smooth: leave it out");
  }
  if (smooth > 0 && (form_of(blend) || pattern == Pattern::double_spiral)) {
    refuse("smooth", fmt::format("{}", smooth),
           "blended levels have no corners left to smooth, and what was raised would sink: leave one of them out");
  }
  validate_scallop(*this);
  validate_partition(*this);
  validate_blend(*this);
  if (pattern == Pattern::double_spiral && scallop > 0)
    refuse("pattern", "double-spiral with a scallop", "double spirals keep a spacing in space only");
  tool.validate();
  validate_programs(*this);
}

}  // namespace isopath
