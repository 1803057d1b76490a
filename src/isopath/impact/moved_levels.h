#pragma once

#include <vector>

#include "isopath/contour/isolines.h"
#include "isopath/core/progress.h"
#include "isopath/field/surface_function.h"

namespace isopath {

/// A function less a level that differs from part to part of the surface, and unreached on parts without one: so one
/// extraction at level 0 draws another isoline on every part, or draws on one part alone. Mesh and function must
/// outlive it.
class MovedLevels final : public SurfaceFunction {
 public:
  /// `level_of_vertex` is infinity where the function is left out, and otherwise the same for all corners of a face.
  MovedLevels(const TriangleMesh& mesh, const SurfaceFunction& function, std::vector<double> level_of_vertex);

  double value_at_vertex(Index vertex) const override;
  double value(const SurfacePoint& point) const override;
  Slope slope(const SurfacePoint& point) const override;
  void edge_crossings(Index edge, double level, std::vector<double>& parameters) const override;
  bool linear_in_faces() const override { return function_.linear_in_faces(); }
  bool monotone_in_face(Index face) const override { return function_.monotone_in_face(face); }
  double max_slope() const override { return function_.max_slope(); }

 private:
  double level_in(Index face) const;

  const TriangleMesh& mesh_;
  const SurfaceFunction& function_;
  std::vector<double> level_;
};

/// The contours of `level` that can be come to from a contour through values between the two levels, without looking
/// at the rest of the surface. Throws Error(cancelled) on request.
std::vector<Contour> contours_beside(const TriangleMesh& mesh, const SurfaceFunction& function, const Contour& from,
                                     double level, Progress& progress);

}  // namespace isopath
