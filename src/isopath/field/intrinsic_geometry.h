#pragma once

#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Every triangle laid out in the plane: all that distances on a surface need to know of its shape.
///
/// The frame of a half-edge has its origin at the tail, x along the half-edge, and the half-edge's face at y > 0.
class IntrinsicGeometry {
 public:
  /// The shape that the vertex positions give.
  explicit IntrinsicGeometry(const TriangleMesh& mesh);

  double length(Index halfedge) const { return length_[halfedge]; }
  /// The corner opposite the half-edge, in the half-edge's frame.
  const Vec2& apex(Index halfedge) const { return apex_[halfedge]; }
  /// Interior angle of the half-edge's face at its tail, in [0, π].
  double angle_at_tail(Index halfedge) const;

  /// A point given by barycentric coordinates of the half-edge's face, in the half-edge's frame.
  Vec2 in_frame(Index halfedge, const Vec3& barycentric) const;

 private:
  std::vector<double> length_;
  std::vector<Vec2> apex_;
};

}  // namespace isopath
