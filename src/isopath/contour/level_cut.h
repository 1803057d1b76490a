#pragma once

#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/surface_function.h"

namespace isopath {

/// All level sets of a function, cut at the mesh's edges: what isolines and the contour graph are both made from.
///
/// Crossings are found once for each edge and shared by the faces beside it, and in every face they are matched in
/// pairs; so every level set closes or ends on the boundary by construction, whatever rounding does.
struct LevelCut {
  struct Crossing {
    Index edge = no_index;
    Index level = no_index;
    double parameter = 0;  ///< along the edge's canonical half-edge
  };

  /// A level set's passage through one face, the larger values on its left; a loop inside the face has no crossings.
  struct Piece {
    Index face = no_index;
    Index level = no_index;
    Index from = no_index;  ///< crossing
    Index to = no_index;    ///< crossing
    Index first_point = 0;  ///< inner points, in `points`
    Index n_points = 0;
    bool is_loop() const { return from == no_index; }
  };

  std::vector<double> levels;
  /// The crossings of edge e are those from first_of_edge[e] up to first_of_edge[e + 1], in their order along the
  /// edge. Walking over them, the band (the number of levels at or below the value) changes by one at each.
  std::vector<Index> first_of_edge;
  std::vector<Crossing> crossings;
  std::vector<Piece> pieces;  ///< by face, then level
  std::vector<SurfacePoint> points;

  SurfacePoint point_of(const TriangleMesh& mesh, Index crossing) const {
    return point_on_halfedge(mesh.halfedge_of(crossings[crossing].edge), crossings[crossing].parameter);
  }
  std::span<const SurfacePoint> points_of(const Piece& piece) const {
    return std::span(points).subspan(static_cast<std::size_t>(piece.first_point),
                                     static_cast<std::size_t>(piece.n_points));
  }
  /// True when the face has an unreached corner: no level set is drawn in it.
  static bool is_unreached(const TriangleMesh& mesh, const SurfaceFunction& function, Index face);
};

/// Cuts the surface at the levels, in time proportional to the faces and crossings. `levels` are finite and ascending.
/// Throws Error(internal) when the function breaks its promise about the parity of crossings.
LevelCut cut_levels(const TriangleMesh& mesh, const SurfaceFunction& function, std::span<const double> levels,
                    double chord_tolerance, Progress& progress);

}  // namespace isopath
