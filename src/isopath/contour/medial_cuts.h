#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/exact_field.h"
#include "isopath/mesh/surface_point.h"

namespace isopath {

struct MedialCutOptions {
  /// Greatest over least clearance of the medial axis that still counts as even; above 1. Where an arm meets a room, a
  /// ratio of 1.5 splits them when the room is half as wide again as the arm.
  double unevenness = 1.5;
  void validate() const;  ///< throws Error(bad_usage)
};

/// Where to cut a surface so that the medial axis of its boundary keeps a more even distance from it (paper ch. 12).
struct MedialCuts {
  double least_clearance = 0;     ///< of the medial axis without its branches into corners, mm; 0 where nothing is left
  double greatest_clearance = 0;  ///< mm
  /// Each the shortest way between the two places of the boundary that a point of the axis is nearest to; consecutive
  /// points share a face. None where the clearance is even.
  std::vector<std::vector<SurfacePoint>> lines;
};

/// The cuts that part wide from narrow: wherever the clearance along the axis passes the geometric mean of its
/// extremes, at the foot of that step, where the cut is short. A branch counts as one into a corner as far as the
/// clearance rises along it at an angle of more than 17 degrees, as between sides that meet at more than 35 degrees.
/// `field` is the exact distance from the boundary (accuracy 0). Throws Error(bad_usage) for invalid options,
/// Error(cancelled) on request.
MedialCuts medial_cuts(const ExactField& field, const MedialCutOptions& options = {},
                       Progress& progress = Progress::none());

}  // namespace isopath
