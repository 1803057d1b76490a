#pragma once

#include <vector>

#include "isopath/contour/isolines.h"
#include "isopath/contour/level_cut.h"

namespace isopath {

/// The pieces of a cut, strung together.
struct Chains {
  std::vector<Contour> contours;        ///< by level; open ones before closed ones, then by their first piece
  std::vector<Index> contour_of_piece;  ///< `no_index` for pieces of a contour that is a mere point
  std::vector<Index> some_piece_of;     ///< for each contour, one of its pieces
};

/// Strings the pieces together in linear time, and drops contours shorter than the mesh's tolerance: the loops around
/// a vertex whose value is the level.
Chains chain_pieces(const TriangleMesh& mesh, const LevelCut& cut);

}  // namespace isopath
