#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/impact/open_spots.h"
#include "isopath/impact/surface_curve.h"
#include "isopath/mesh/sub_mesh.h"

namespace isopath {

/// The surface around an open spot, to ask how far the spot is from ways that are not part of the curve yet. Where the
/// surface is nearly flat straight distances tell, enlarged by as much as ways on it may be longer; where it is not, as
/// at the rim of a thin wall, distances are geodesic ones on the faces around.
class SpotPatch {
 public:
  /// With all faces that a way of length `reach` from the spot may cross. Mesh and spot must outlive it.
  SpotPatch(const TriangleMesh& mesh, const OpenSpot& spot, double reach, const Progress& progress);

  /// Whether straight distances tell: then ways need not lie on the surface.
  bool nearly_flat() const { return factor_ <= largest_factor; }
  /// How far each cell of the spot is from a way, mm; where that is much farther than the reach, infinity. Unless the
  /// surface is nearly flat, consecutive points of the way must share a face.
  std::vector<double> distances_from(const SurfaceCurve& way) const;

 private:
  /// Ways longer than straight ones by less than this are not worth a closer look.
  static constexpr double largest_factor = 1.02;

  void collect_faces();
  std::vector<double> straight_distances(const std::vector<Vec3>& way) const;

  const TriangleMesh& mesh_;
  const OpenSpot& spot_;
  double reach_;
  const Progress& progress_;
  std::vector<Index> faces_;  ///< in ascending order
  double factor_ = 1;         ///< ways in the patch are at most so many times as long as straight ones
  SubMesh part_;              ///< unless nearly flat
};

}  // namespace isopath
