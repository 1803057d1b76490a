#pragma once

#include <vector>

#include "isopath/contour/contour_graph.h"
#include "isopath/core/progress.h"

namespace isopath {

/// The isolines that become passes, and the runs they form.
struct Passes {
  std::vector<Contour> contours;
  /// A run of contours that lie one inside the other, or side by side: indices into `contours`, ascending level.
  struct Run {
    std::vector<Index> contours;
    bool closed = false;
  };
  std::vector<Run> runs;
  double spacing =
      0;  ///< the spacing that was used: the one asked for, or a little less so that passes divide the range evenly
};

/// Levels half a spacing in from the least and the greatest value and evenly between, and in addition a last pass
/// wherever the function rises by more than half a spacing above the last level inside it (issue of paper ch. 8: bumps
/// and branches). Empty when the function is finite nowhere.
Passes choose_passes(const TriangleMesh& mesh, const SurfaceFunction& function, double spacing, Progress& progress);

}  // namespace isopath
