#pragma once

#include <span>
#include <vector>

#include "isopath/contour/isolines.h"

namespace isopath {

/// How contours lie beside each other (paper ch. 6). Node k is contour k.
struct ContourGraph {
  /// For each contour its neighbours at the next level, ascending: those that share a band with it and, where several
  /// contours bound the band on both sides, those that a descent line leads from to this contour.
  std::vector<std::vector<Index>> children;
  std::vector<std::vector<Index>> parents;  ///< the same links from above: neighbours at the level before
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

/// The contours of some levels, and how they lie beside each other.
struct ContourSet {
  std::vector<Contour> contours;  ///< as `isolines` returns them
  ContourGraph graph;
};

/// Extracts contours together with their graph. The surface is cut at all levels; each connected component of the
/// band between two levels links its lower contours with its upper ones. Takes and throws what `isolines` does.
ContourSet contour_set(const TriangleMesh& mesh, const SurfaceFunction& function, std::span<const double> levels,
                       const IsolineOptions& options = {}, Progress& progress = Progress::none());

}  // namespace isopath
