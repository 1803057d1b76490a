#pragma once

#include <array>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// A triangular part of a face, by the barycentric coordinates of its corners: for searches and samples that go as
/// deep into a face as they need.
struct FacePart {
  Index face = no_index;
  std::array<Vec3, 3> corner = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  int depth = 0;  ///< how often the face was halved: the part has 2^-depth of its area

  static FacePart whole(Index face) { return {.face = face}; }
  Vec3 centre() const { return (corner[0] + corner[1] + corner[2]) / 3; }
};

/// Where a face's corners lie: in space, or laid out by the lengths of another metric.
using FaceCorners = std::array<Vec3, 3>;
FaceCorners corners_of(const TriangleMesh& mesh, Index face);

/// Distance from the part's centre to its farthest corner.
double radius_of(const FaceCorners& corners, const FacePart& part);

/// Appends the two halves of a part, cut across its longest side: thin parts become round.
void halve(const FaceCorners& corners, const FacePart& part, std::vector<FacePart>& parts);

}  // namespace isopath
