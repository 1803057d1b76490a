#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/exact_field.h"

namespace isopath {

/// Where the shortest path to a point ends when it is prolonged beyond it as a shortest path: on the medial axis of the
/// field's sources, or on the boundary. Every point off the axis lies on one spoke.
struct Spoke {
  double length = 0;  ///< of the whole spoke, mm: the distance of its end from the sources
  SurfacePoint end;   ///< invalid where the point is unreached or on a source
  /// Rate at which the distance grows along the axis there, from 0 where two fronts meet head on to 1 where they run
  /// side by side, and at the boundary.
  double axis_slope = 1;
};

/// The spokes through all vertices. A spoke ends where prolonging it by `tolerance` mm or less would have it longer
/// than the distance by `tolerance`; fronts that meet at an angle of a few degrees are passed over within that.
/// Throws Error(bad_usage) unless the tolerance is positive, Error(cancelled) on request.
std::vector<Spoke> spokes(const ExactField& field, double tolerance, const Progress& progress = Progress::none());

}  // namespace isopath
