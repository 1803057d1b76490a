#pragma once

#include <vector>

#include "isopath/contour/level_cut.h"

namespace isopath {

/// The connected components of the bands between consecutive levels, as seen from the pieces that bound them.
///
/// The crossings cut every edge into intervals. A face joins the intervals that meet at its corners, and those that
/// face each other along a piece; what is joined in this way lies in one component. Nothing is measured, so that
/// components are as consistent as the pieces are.
class Bands {
 public:
  Bands(const TriangleMesh& mesh, const SurfaceFunction& function, const LevelCut& cut);

  /// The component on the left of a piece, and the one on its right: numbers that only tell components apart.
  Index above(Index piece) { return find(above_[piece]); }
  Index below(Index piece) { return find(below_[piece]); }

 private:
  Index interval(Index edge, Index k) const { return cut_.first_of_edge[edge] + edge + k; }
  Index interval_at(Index halfedge, double t) const;
  Index at_start(Index halfedge) const;
  Index at_end(Index halfedge) const;
  void join_at_corners(const SurfaceFunction& function);
  void join_along(Index piece);
  void place_loop(Index piece, Index first_of_face, Index last_of_face);
  std::vector<Vec2> outline(Index piece) const;
  Index find(Index node);
  void unite(Index a, Index b);

  const TriangleMesh& mesh_;
  const LevelCut& cut_;
  std::vector<Index> parent_;  // union-find over edge intervals, then two nodes for each loop
  std::vector<Index> above_;   // a node on the left of each piece
  std::vector<Index> below_;
};

}  // namespace isopath
