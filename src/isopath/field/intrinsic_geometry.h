#pragma once

#include <span>

#include "isopath/core/geometry.h"
#include "isopath/field/large_pages.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Every triangle laid out in the plane: all that distances on a surface need to know of its shape.
///
/// The frame of a half-edge has its origin at the tail, x along the half-edge, and the half-edge's face at y > 0.
///
/// The lengths may be those of the edges in space, or those of another metric (paper ch. 10): then each triangle is
/// warped, the map from its plane in space to its layout is affine, and barycentric coordinates mean the same in both.
class IntrinsicGeometry {
 public:
  /// The shape that the vertex positions give.
  explicit IntrinsicGeometry(const TriangleMesh& mesh);

  /// The shape that a metric gives, by one length in mm for each edge of the mesh. Triangles may be flat within
  /// rounding. Throws Error(bad_usage) when the number of lengths is not that of the edges, Error(bad_input) that names
  /// the edge when a length is not finite and positive, or the face when its lengths break the triangle inequality.
  IntrinsicGeometry(const TriangleMesh& mesh, std::span<const double> edge_lengths);

  double length(Index halfedge) const { return length_[halfedge]; }
  /// The corner opposite the half-edge, in the half-edge's frame.
  const Vec2& apex(Index halfedge) const { return apex_[halfedge]; }
  /// Interior angle of the half-edge's face at its tail, in [0, π].
  double angle_at_tail(Index halfedge) const { return angle_[halfedge]; }
  /// The same of all half-edges.
  std::span<const double> lengths() const { return length_; }
  std::span<const Vec2> apexes() const { return apex_; }
  std::span<const double> angles() const { return angle_; }
  double face_area(Index face) const { return 0.5 * length_[3 * face] * apex_[3 * face].y(); }

  /// A point given by barycentric coordinates of the half-edge's face, in the half-edge's frame.
  Vec2 in_frame(Index halfedge, const Vec3& barycentric) const;

  /// The direction in space, of unit length, of a vector in the frame of half-edge 3·face: the layout is mapped
  /// affinely, so that a straight way in it is the same way in space. Zero for a zero vector.
  Vec3 direction_in_space(const TriangleMesh& mesh, Index face, const Vec2& v) const;

  /// The largest factor, over all faces and directions, by which a length exceeds that in space; 1 without a metric.
  double max_stretch() const { return max_stretch_; }
  /// The model's size as tolerances need it: no shorter than any straight way.
  double size() const { return size_; }
  /// Coordinates are turned from frame to frame, distances are sums of a few square roots: both are good to this.
  double rounding() const { return 1e-14 * size_; }

 private:
  bool is_metric_ = false;
  double max_stretch_ = 1;
  double size_ = 0;
  LargeVector<double> length_;
  LargeVector<Vec2> apex_;
  LargeVector<double> angle_;
};

}  // namespace isopath
