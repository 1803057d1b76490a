#pragma once

#include "isopath/contour/level_cut.h"

namespace isopath {

/// Follows the function downwards over the surface, from face to face along the steepest way.
class Descent {
 public:
  Descent(const TriangleMesh& mesh, const SurfaceFunction& function, const LevelCut& cut)
      : mesh_(mesh), function_(function), cut_(cut) {}

  /// The piece of the given level that the way down from `start` meets; `no_index` when it ends before.
  Index piece_below(SurfacePoint start, Index level) const;

 private:
  struct Step {
    SurfacePoint from;  // in the face it passes
    SurfacePoint to;
    double rate = 0;  // of descent
  };
  Step steepest(const SurfacePoint& point) const;
  void try_down_the_face(const SurfacePoint& point, Step& best) const;
  void try_along(Index halfedge, const SurfacePoint& point, Step& best) const;
  void consider(const SurfacePoint& from, const SurfacePoint& to, Step& best) const;
  Index nearest_piece(const SurfacePoint& point, Index level) const;
  double distance_to_piece(const Vec3& point, const LevelCut::Piece& piece) const;

  const TriangleMesh& mesh_;
  const SurfaceFunction& function_;
  const LevelCut& cut_;
};

}  // namespace isopath
