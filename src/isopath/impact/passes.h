#pragma once

#include <span>
#include <vector>

#include "isopath/contour/contour_graph.h"
#include "isopath/core/progress.h"

namespace isopath {

/// Which contours of a set become passes. `levels`, those of the set, alternate: passes at even places, between them
/// half levels. A half-level contour without anything above it encloses a top that the pass below does not reach: it
/// becomes a pass itself.
std::vector<char> mark_passes(const ContourSet& set, std::span<const double> levels);

/// The isolines that become passes, and the runs they form.
struct Passes {
  std::vector<Contour> contours;
  /// A run of contours that lie one inside the other, or side by side: indices into `contours`, ascending level.
  struct Run {
    std::vector<Index> contours;
    bool closed = false;
  };
  std::vector<Run> runs;
  /// The spacing that was used: the one asked for, or with even layout a little less.
  double spacing = 0;
};

/// How levels fill the range of the function.
enum class PassLayout {
  even,   ///< half a spacing in from both ends and evenly between, the spacing a little smaller where it has to be
  exact,  ///< half a spacing in from the least value and the spacing asked for apart; what is left is at the top
};

/// Levels half a spacing in from the least value, as far apart as the layout tells, and in addition a last pass
/// wherever the function rises by more than half a spacing above the last level inside it (paper ch. 8: bumps and
/// branches). Empty when the function is finite nowhere. Throws Error(bad_usage) when that would be more than a
/// million levels, Error(cancelled) on request.
Passes choose_passes(const TriangleMesh& mesh, const SurfaceFunction& function, double spacing, Progress& progress,
                     PassLayout layout = PassLayout::even);

}  // namespace isopath
