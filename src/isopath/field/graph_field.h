#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/source.h"

namespace isopath {

struct GraphOptions {
  /// Points put evenly on every edge, joined to all others of their faces; at least 0, at most 100. 0 keeps the path on
  /// the edges.
  int virtual_vertices = 0;
  /// Also joins the two vertices opposite an edge where the straight line between them crosses it in the unfolded pair
  /// of faces.
  bool across_pairs = false;

  /// Throws Error(bad_usage) that names the option and its limits.
  void validate() const;
};

/// Lengths in mm of the shortest paths to every vertex in a graph on the surface (Dijkstra; paper ch. 4); infinity
/// where no source reaches. The corners and virtual vertices of a face that holds a source start with their exact
/// distance to it. Every path lies on the surface, so that no value is below the exact distance d.
///
/// None is above d + k L / (m + 1), where the shortest path crosses k edges no longer than L and m is the number of
/// virtual vertices: the path that goes through the node nearest to each crossing moves both ends of every chord by at
/// most L / (2 (m + 1)). More triangles of the same shape therefore do not bring the values closer to d, more virtual
/// vertices do.
///
/// Throws Error(bad_usage) for an empty source set, invalid options or more than 2³¹ - 1 nodes, Error(cancelled) on
/// request.
std::vector<double> graph_distances(const TriangleMesh& mesh, const SourceSet& sources,
                                    const GraphOptions& options = {}, Progress& progress = Progress::none());

}  // namespace isopath
