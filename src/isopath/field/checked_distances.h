#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/source.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

struct CheckedDistancesOptions {
  /// Largest relative error that is acceptable, above 0 and below 1.
  double max_error = 0.01;
  /// Share of the vertices, those nearest to the sources, whose distances are compared with exact ones; above 0, at
  /// most 1. With 1 the comparison costs as much as exact distances and the estimate is the true error.
  double sample = 0.25;

  void validate() const;  ///< throws Error(bad_usage)
};

struct CheckedDistances {
  std::vector<double> at_vertices;  ///< in mm; infinity where no source reaches
  /// The largest relative error that virtual sources made at the vertices of the sample.
  double estimated_error = 0;
  /// Whether that was more than acceptable, so that `at_vertices` are exact.
  bool exact = false;
};

/// Distances by virtual sources where these are good enough, else exact ones. Whether they are good enough is
/// estimated, not proven: they are compared with the exact distances of the vertices nearest to the sources, and errors
/// may be larger further out. Throws Error(bad_usage) for an empty source set or invalid options, Error(cancelled) on
/// request.
CheckedDistances checked_distances(const TriangleMesh& mesh, const SourceSet& sources,
                                   const CheckedDistancesOptions& options = {}, Progress& progress = Progress::none());

}  // namespace isopath
