#pragma once

#include <filesystem>

#include "isopath/core/progress.h"
#include "isopath/mesh/triangle_soup.h"

namespace isopath {

/// How finely curved faces are cut into triangles.
struct StepOptions {
  double chordal_tolerance = 0;    ///< largest distance of the triangles from the surface, mm; 0 takes 1e-3 of its size
  double angular_tolerance = 0.3;  ///< largest turn of the surface along an edge, radians, in (0, π/2]
  void validate() const;           ///< throws Error(bad_usage) naming the field, its value and its limit
};

/// True when isopath was built with OpenCASCADE, so that read_step() can work.
bool can_read_step();

/// True for the file names that read_step() is for: .step, .stp, .iges, .igs in any case.
bool is_step_file_name(const std::filesystem::path& path);

/// Reads a STEP (.step, .stp) or IGES (.iges, .igs) file and cuts its faces into triangles, in mm whatever the file's
/// unit. Neighbouring faces share their vertices along common edges, so a closed shell stays closed; faces that come
/// without common edges, as in IGES, are sewn where they are nearer than a tenth of the chordal tolerance.
/// Throws Error(bad_input) when the file cannot be read or holds no faces, Error(bad_usage) when this build of isopath
/// has no OpenCASCADE, Error(cancelled) when `progress` says so. One file is read at a time.
TriangleSoup read_step(const std::filesystem::path& path, const StepOptions& options = {},
                       Progress& progress = Progress::none());

}  // namespace isopath
