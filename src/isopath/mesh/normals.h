#pragma once

#include <array>
#include <numbers>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

struct NormalsOptions {
  /// Neighbouring faces whose normals differ by more than this meet in a crease and are not smoothed into each other;
  /// radians, in [0, π]. Default 40 degrees.
  double crease_angle = 40 * std::numbers::pi / 180;
  void validate() const;  ///< throws Error(bad_usage) naming the field, its value and its limit
};

/// Normals that vary continuously over a smooth surface and jump at its creases.
///
/// Around each vertex the faces between two creases share one normal: the mean of the face normals weighted by the
/// angle at the vertex (Thürmer & Wüthrich 1998), which does not depend on how the surface is cut into triangles.
/// Inside a face the normals of its corners are interpolated.
class SmoothNormals {
 public:
  /// Throws Error(bad_usage) for an invalid option.
  explicit SmoothNormals(const TriangleMesh& mesh, const NormalsOptions& options = {});

  /// Unit normal at a point, on the side that the triangles' orientation shows.
  Vec3 at(const SurfacePoint& point) const;
  /// Unit normal at corner `i` of a face.
  const Vec3& at_corner(Index face, int i) const { return corner_[3 * face + i]; }
  /// Unit normal of a face. A face too thin to have one takes that of a neighbour, across its longest edge where it
  /// can; z where a whole component has none.
  const Vec3& of_face(Index face) const { return face_[face]; }
  /// True where the face of the half-edge is not smoothed into the one beyond: at creases and on the boundary.
  bool is_crease(Index halfedge) const { return crease_[halfedge] != 0; }

 private:
  std::vector<Vec3> face_;
  std::vector<char> crease_;
  std::vector<Vec3> corner_;
};

}  // namespace isopath
