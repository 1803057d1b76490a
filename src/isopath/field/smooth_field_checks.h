#pragma once

#include <span>
#include <vector>

#include "isopath/field/surface_laplacian.h"

namespace isopath {

/// What all ways of smoothing ask of their input; throws Error(bad_usage), see smooth_field.h.
void check_smoothing(const SurfaceLaplacian& laplacian, std::span<const double> values, std::span<const double> local,
                     bool conserve_volume);

/// Multiplies values so that the volume under them is what it was before.
void restore_volume(const SurfaceLaplacian& laplacian, std::span<const double> before, std::vector<double>& values);

}  // namespace isopath
