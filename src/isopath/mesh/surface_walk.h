#pragma once

#include <vector>

#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// A face that contains both points, `no_index` when there is none. Prefers the face of `a`, then that of `b`.
Index common_face(const TriangleMesh& mesh, const SurfacePoint& a, const SurfacePoint& b);

/// The polyline on the surface between two nearby points: where the plane through both points and the mean of their
/// normals cuts the mesh, followed face by face. On a plane it is the straight line.
///
/// The first and last points are `from` and `to` themselves; those between lie on edges or vertices, with exact zeros
/// in their coordinates, and consecutive ones share a face. Empty when the cut does not lead from one point to the
/// other: across a gap, over a boundary, along the normal, or by a way longer than four times the straight distance.
std::vector<SurfacePoint> surface_walk(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to);

}  // namespace isopath
