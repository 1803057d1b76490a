#pragma once

#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/surface_function.h"

namespace isopath {

/// A connected piece of a level set. Closed contours do not repeat their first point; open ones end on the boundary.
/// Walked from first to last point, the larger values lie on the left (seen from the side the normals point to).
struct Contour {
  double level = 0;
  bool closed = false;
  std::vector<SurfacePoint> points;  ///< consecutive points (cyclically when closed) share a face
};

struct IsolineOptions {
  double chord_tolerance = 0;  ///< largest distance of a chord from the isoline; 0 takes 1e-4 of the model's size
  void validate() const;       ///< throws Error(bad_usage)
  double chord_tolerance_for(const TriangleMesh& mesh) const;  ///< with the default filled in
};

/// Throws Error(bad_usage) naming the first level that is not finite or not above the one before.
void validate_levels(std::span<const double> levels);

/// All contours of the given levels, ordered by level; linear time in their length (paper ch. 5).
/// Every point p satisfies |f(p) - level| <= 1e-9 × model size × slope. Levels must be finite and ascending.
std::vector<Contour> isolines(const TriangleMesh& mesh, const SurfaceFunction& function, std::span<const double> levels,
                              const IsolineOptions& options = {}, Progress& progress = Progress::none());

/// Length in space of a contour.
double length_of(const TriangleMesh& mesh, const Contour& contour);

}  // namespace isopath
