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

/// What a smooth surface through the vertices of a mesh looks like at each of them.
struct SurfaceFit {
  std::vector<PrincipalCurvatures> curvatures;  ///< at every vertex
  std::vector<Vec3> corner_normals;  ///< unit, at corner i of face f: [3 f + i]; the corners of a smooth group agree
};

/// A cubic height function is fitted around every vertex to those within two rings, by weighted least squares (Cazals &
/// Pouget 2005): of edges of length h, normals are right to h³ and curvatures to h², however irregular the triangles
/// are. Where there are too few vertices, as at the corners of a boundary, further rings are taken, or a quadratic.
/// With a `radius` (mm) all vertices within it are looked at, up to some 80: that evens out the noise of scans.
///
/// Does not look across the creases of `normals`: a vertex on a crease has a normal for each smooth group around it,
/// and the curvature of the one with the largest angle there. The fit is scaled along the main axes of its points, so
/// that slivers do not spoil it; what the points leave open counts as flat.
SurfaceFit fit_surface(const TriangleMesh& mesh, const SmoothNormals& normals, double radius = 0);

/// The curvatures of `fit_surface` alone.
std::vector<PrincipalCurvatures> principal_curvatures(const TriangleMesh& mesh, const SmoothNormals& normals);

}  // namespace isopath
