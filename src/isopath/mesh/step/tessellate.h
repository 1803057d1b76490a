#pragma once

#include <filesystem>

#include "isopath/core/progress.h"
#include "isopath/mesh/step_reader.h"
#include "isopath/mesh/triangle_soup.h"

namespace isopath {

/// The part of read_step() that needs OpenCASCADE.
TriangleSoup tessellate_step(const std::filesystem::path& path, bool iges, const StepOptions& options,
                             Progress& progress);

}  // namespace isopath
