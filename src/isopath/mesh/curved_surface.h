#pragma once

#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/mesh/curvature.h"
#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// The smooth surface that a mesh stands for. It passes through the vertices; between them it is curved the way the
/// normals of a fit say (Phong tessellation, Boubekeur & Alexa 2008, with the weight 1/2 that reproduces circles to
/// fourth order in the edges). It has the creases that the fit has.
class CurvedSurface {
 public:
  CurvedSurface(const TriangleMesh& mesh, const SurfaceFit& fit);
  /// With a fit of its own, see fit_surface.
  explicit CurvedSurface(const TriangleMesh& mesh, double radius = 0);

  /// The same surface seen from another mesh of the polyhedron: each face of `finer` must lie in a face of `mesh`, the
  /// one that this surface was made from. What was split flat is not flat for that.
  CurvedSurface over(const TriangleMesh& mesh, const TriangleMesh& finer) const;

  struct Point {
    Vec3 position;
    Vec3 normal;  ///< unit, on the side that the triangles' orientation shows
  };
  /// The point above a point of the mesh.
  Point at(const SurfacePoint& on_mesh) const;

 private:
  CurvedSurface() = default;

  std::vector<Point> corners_;  ///< at corner i of face f: [3 f + i]
};

}  // namespace isopath
