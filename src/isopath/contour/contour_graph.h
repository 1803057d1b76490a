#pragma once

#include <span>
#include <utility>
#include <vector>

#include "isopath/contour/isolines.h"

namespace isopath {

/// How contours lie beside each other (paper ch. 6). Node k is contour k.
struct ContourGraph {
  std::vector<std::vector<Index>>
      children;  ///< neighbours at the next level that a descent line connects to this contour
  std::vector<std::vector<Index>> parents;  ///< neighbours at the level before
  std::vector<Index> order;                 ///< topological order: parents before children

  /// A maximal run of contours each with one child and one parent in between: concentric or quasi-parallel isolines.
  struct Run {
    std::vector<Index> contours;  ///< ascending level
    bool closed = false;          ///< all closed, or all open
    std::vector<Index> children;  ///< runs that continue it
    std::vector<Index> parents;
  };
  std::vector<Run> runs;  ///< the simplified graph, in topological order
};

/// Builds the graph by bands between consecutive levels: a component of the band links its lower with its upper
/// contours. `contours` are those `isolines` returned for the same function and levels.
ContourGraph contour_graph(const TriangleMesh& mesh, const SurfaceFunction& function, std::span<const double> levels,
                           std::span<const Contour> contours, Progress& progress = Progress::none());

}  // namespace isopath
