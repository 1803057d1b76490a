#include "isopath/mesh/step_reader.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include "isopath/core/error.h"
#include "isopath/mesh/mesh_formats.h"
#ifdef ISOPATH_HAS_STEP
#include "isopath/mesh/step/tessellate.h"
#endif

namespace isopath {
namespace {

bool is_iges(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".igs" || extension == ".iges";
}

}  // namespace

void StepOptions::validate() const {
  if (!(chordal_tolerance >= 0 && std::isfinite(chordal_tolerance))) {
    throw Error(ErrorCode::bad_usage, "the chordal tolerance must be a length in mm, or 0 for the default",
                {.element = "chordal_tolerance", .value = fmt::format("{}", chordal_tolerance)});
  }
  if (!(angular_tolerance > 0 && angular_tolerance <= std::numbers::pi / 2)) {
    throw Error(ErrorCode::bad_usage, "the angular tolerance must be above 0 and at most pi/2 radians",
                {.element = "angular_tolerance", .value = fmt::format("{}", angular_tolerance)});
  }
}

bool can_read_step() {
#ifdef ISOPATH_HAS_STEP
  return true;
#else
  return false;
#endif
}

bool is_step_file_name(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".stp" || extension == ".step" || is_iges(path);
}

TriangleSoup read_step(const std::filesystem::path& path, const StepOptions& options,
                       [[maybe_unused]] Progress& progress) {
  options.validate();
  if (!is_step_file_name(path)) {
    throw Error(ErrorCode::bad_input, "not the name of a STEP or IGES file",
                {.file = path.string(), .advice = "such files end in .step, .stp, .iges or .igs"});
  }
#ifdef ISOPATH_HAS_STEP
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored) || !std::ifstream(path)) {
    throw Error(ErrorCode::bad_input, "the file cannot be opened",
                {.file = path.string(), .advice = "check its name and that you may read it"});
  }
  return tessellate_step(path, is_iges(path), options, progress);
#else
  throw Error(
      ErrorCode::bad_usage, "this build of isopath cannot read STEP and IGES files",
      {.file = path.string(),
       .advice = "build it with OpenCASCADE and -DISOPATH_STEP=ON, or export the part as STL, OBJ, PLY or OFF"});
#endif
}

}  // namespace isopath
