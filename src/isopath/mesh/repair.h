#pragma once

#include <string>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/mesh/triangle_soup.h"

namespace isopath {

struct RepairOptions {
  bool weld = true;                ///< make vertices at exactly equal positions one
  bool largest_component = false;  ///< keep only the connected component with the largest area
  double fill_holes_length = 0;    ///< close boundary loops no longer than this, in mm, ≥ 0; 0 closes none
  Index fill_holes_edges = 200;    ///< and with no more edges than this, in [3, 1000]: the work grows with its cube
  /// How far the copies of a split vertex are moved apart, relative to the largest coordinate, in [0, 1e-3]. Without
  /// it they would be welded again when the mesh is written and read. The default is four units in the last place of
  /// single precision, so that it survives STL: half a micrometre on a part of a metre.
  double separation = 0x1p-21;

  /// Throws Error(bad_usage) when a value is out of its range.
  void validate() const;
};

/// One kind of change, and how often it was made.
struct RepairChange {
  std::string what;  ///< "duplicate triangles dropped"
  Index count = 0;
};

struct RepairResult {
  TriangleSoup soup;
  std::vector<RepairChange> changes;  ///< empty when nothing was wrong: then the soup is the input, bit for bit
  /// Output vertex of each input vertex, `no_index` where it was dropped. Of a split vertex it is the copy with the
  /// most triangles.
  std::vector<Index> vertex_of_input;
};

/// Mends a triangle soup so that TriangleMesh accepts it, and says what it changed.
///
/// In turn, until nothing changes any more: triangles with unusable coordinates or indices are dropped; equal positions
/// welded; triangles that repeat a vertex or another triangle dropped (the first of several stays). A triangle without
/// area (height within the tolerance) is removed without opening a crack: its shortest edge is collapsed when that is
/// within the tolerance, else the neighbours across its longest edge are split at its tip. Then triangles are oriented
/// consistently: as few as possible are reversed, closed pieces that needed it face outward, and a one-sided surface is
/// cut where it disagrees. Where more than two triangles meet in an edge, the flattest consistent pairs stay joined and
/// the others are cut off; vertices where sheets only touch are split.
///
/// Throws Error(bad_input) when nothing is left, or when all of it is too small to compute with.
RepairResult repair_mesh(TriangleSoup soup, const RepairOptions& options = {}, Progress& progress = Progress::none());

}  // namespace isopath
