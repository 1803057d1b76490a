#pragma once

#include <array>
#include <vector>

#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// A point that two fronts reach at the same time.
struct BisectorPoint {
  SurfacePoint point;
  double clearance = 0;                            ///< distance from both roots, mm
  double angle = 0;                                ///< between the directions of arrival, radians
  std::array<Index, 2> roots{no_index, no_index};  ///< nearest on the left and on the right of the arc
};

/// A piece of a bisector inside one face, between two points that it shares with other pieces.
struct BisectorPiece {
  Index from = no_index;  ///< ids of the points it shares
  Index to = no_index;
  std::vector<BisectorPoint> points;  ///< both ends included
};

/// Bisectors on a surface, as arcs between nodes (paper ch. 8): a Voronoi diagram or a medial axis.
struct BisectorGraph {
  struct Arc {
    Index from = no_index;  ///< node at the first point
    Index to = no_index;    ///< node at the last point; the same one for a closed arc
    std::vector<BisectorPoint> points;
  };
  struct Node {
    SurfacePoint point;
    double clearance = 0;
    std::vector<Index> arcs;  ///< ascending; one that starts and ends here twice. One arc: a leaf
  };
  std::vector<Node> nodes;
  std::vector<Arc> arcs;
};

/// Strings pieces together. Nodes are the points where not just two pieces meet; a closed chain gets one node.
/// Ids of points lie in [0, n_points). Pieces no longer than `shortest`, in mm, shrink to a point.
BisectorGraph chain_bisectors(const TriangleMesh& mesh, Index n_points, std::vector<BisectorPiece> pieces,
                              double shortest);

/// Takes off the twigs: leaf arcs shorter than `ratio` times the clearance at their inner node, the shortest in this
/// measure first, as long as others remain at that node. Arcs that then follow each other become one.
/// Throws Error(bad_usage) when the ratio is not a number from 0 up.
BisectorGraph pruned(const TriangleMesh& mesh, const BisectorGraph& graph, double ratio);

/// Throws Error(bad_usage) for what `pruned` refuses.
void check_prune_ratio(double ratio);

/// Length in space of an arc, mm.
double length_of(const TriangleMesh& mesh, const BisectorGraph::Arc& arc);

}  // namespace isopath
