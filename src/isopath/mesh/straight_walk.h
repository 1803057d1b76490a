#pragma once

#include <vector>

#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// A way straight on over the surface.
struct StraightWalk {
  /// The start, crossings of edges and vertices with exact zeros in their coordinates, and the end; consecutive ones
  /// share a face.
  std::vector<SurfacePoint> points;
  double length = 0;         ///< mm
  bool at_boundary = false;  ///< it ends there, before its length is used up
};

/// The straightest geodesic from a point (Polthier & Schmies 1998): a straight line wherever the triangles it crosses
/// are laid out in the plane; through a vertex it goes on with the same angle on both sides.
///
/// It leaves in the direction `reference`, measured in the plane of `from.face`, turned by `turn` radians
/// counter-clockwise seen from the side the normals point to. Around a vertex, angles are scaled so that a turn of 2π
/// comes back. At a boundary it stops, at once where it starts there and would leave the surface; otherwise after
/// `longest` mm. Throws Error(bad_usage) when the reference has no part in the face's plane, or `longest` is not finite
/// and positive.
StraightWalk straight_walk(const TriangleMesh& mesh, const SurfacePoint& from, const Vec3& reference, double turn,
                           double longest);

/// Straight on from the last point of a polyline whose consecutive points share a face.
/// Throws Error(bad_usage) when its last two points are one place.
StraightWalk straight_on(const TriangleMesh& mesh, const std::vector<SurfacePoint>& line, double longest);

}  // namespace isopath
