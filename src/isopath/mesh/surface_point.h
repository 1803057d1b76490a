#pragma once

#include "isopath/core/geometry.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// A point on the surface: a face and barycentric coordinates with respect to its corners 0, 1, 2.
/// A coordinate that is exactly zero puts the point on the opposite edge; two put it on a vertex.
struct SurfacePoint {
  Index face = no_index;
  Vec3 barycentric = Vec3::Zero();

  bool valid() const { return face != no_index; }
};

/// What a surface point lies on.
struct Support {
  enum class Kind { vertex, edge, face };
  Kind kind = Kind::face;
  Index index = no_index;  ///< vertex, half-edge of the point's own face, or face
};

Support support_of(const TriangleMesh& mesh, const SurfacePoint& point);

SurfacePoint point_at_vertex(const TriangleMesh& mesh, Index vertex);
/// The point at fraction `t` in [0, 1] along a half-edge, in the half-edge's own face.
SurfacePoint point_on_halfedge(Index halfedge, double t);

/// The same point expressed in another face; `face` must contain the point's support.
/// Throws Error(internal) when it does not.
SurfacePoint express_in(const TriangleMesh& mesh, const SurfacePoint& point, Index face);

/// Barycentric coordinates that add up to 1, with what rounding left below 1e-12 set to exactly zero.
Vec3 snapped(Vec3 barycentric);

/// Position in space.
Vec3 position_of(const TriangleMesh& mesh, const SurfacePoint& point);

}  // namespace isopath
