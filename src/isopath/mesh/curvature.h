#pragma once

#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/mesh/normals.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Principal curvatures at a vertex, in 1/mm, and their directions.
///
/// Positive where the surface bends towards its normal: the centre of curvature is on the tool's side, the surface is
/// concave there. The outside of a ball of radius r has -1/r.
struct PrincipalCurvatures {
  double max = 0;
  double min = 0;
  Vec3 max_direction = Vec3::Zero();  ///< unit, tangent; zero at a vertex that no face uses
  Vec3 min_direction = Vec3::Zero();  ///< unit, tangent, orthogonal to the other

  double mean() const { return 0.5 * (max + min); }
  double gaussian() const { return max * min; }
  /// Normal curvature in a tangent direction, by Euler's formula; the direction need not have unit length.
  double along(const Vec3& direction) const;
};

/// Principal curvatures at every vertex, by a weighted least-squares fit of a quadratic height function to the vertices
/// within two rings (Cazals & Pouget 2005). Exact on planes; the error is of the order of the edge length.
///
/// Does not look across the creases of `normals`: a vertex on a crease takes the surface of the smooth group that has
/// the largest angle there. The fit is scaled along the main axes of its points, so that slivers do not spoil it;
/// what the points leave open (a boundary corner with few of them) counts as flat.
std::vector<PrincipalCurvatures> principal_curvatures(const TriangleMesh& mesh, const SmoothNormals& normals);

}  // namespace isopath
