#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/surface_function.h"
#include "isopath/mesh/refine.h"

namespace isopath {

struct FieldRefinementOptions {
  /// Most that linear interpolation may be off inside a face, in mm; required, positive.
  double tolerance = 0;
  /// Most times that a triangle is split, 0 to 20: edges get no shorter than 2^-max_levels of theirs. A front starts
  /// with a kink at its source, so that the faces there are split until this, or until they are as small as the
  /// tolerance.
  int max_levels = 8;

  void validate() const;  ///< throws Error(bad_usage)
};

/// A finer mesh of the same surface with the function at its vertices: a VertexField of these is close to it
/// everywhere.
struct RefinedField {
  RefinedMesh refined;
  std::vector<double> value;  ///< of each vertex of the refined mesh; infinity where the function is
  /// Largest difference from linear interpolation that was met in triangles that are not split any more, in mm.
  double largest_error = 0;
};

/// Red-green refinement where the function is not linear enough, as near sources and where fronts meet (paper ch. 4;
/// Bommes & Kobbelt 2007). A triangle is split where linear interpolation misses the function's value by more than a
/// third of the tolerance at the middle of an edge, at the centroid or half-way from there to a corner. The third is
/// for what lies between: a kink that cuts off a corner moves the corner's value, and half of that shows at the middles
/// of its edges; halving a triangle to close the mesh adds as much again. Triangles with an unreached corner are not
/// split. Throws Error(bad_usage) for invalid options, Error(bad_input) when the result would be too large,
/// Error(cancelled) on request.
RefinedField refine_for_field(const TriangleMesh& mesh, const SurfaceFunction& function,
                              const FieldRefinementOptions& options, const Progress& progress = Progress::none());

}  // namespace isopath
