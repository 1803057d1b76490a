#pragma once

#include <array>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// The point of a surface nearest to a point in space.
struct NearestPoint {
  SurfacePoint at;             ///< invalid when the surface has no point within the asked distance
  double distance = infinity;  ///< mm
};

/// Where a segment first meets a surface.
struct SegmentHit {
  bool hit = false;
  double t = infinity;    ///< fraction of the segment, in [0, 1]
  Index face = no_index;  ///< the face that is met
};

/// Finds nearest points and intersections on a mesh by a bounding volume hierarchy, in double precision.
/// Keeps its own copy of what it needs of the mesh. Queries are const and may run in any number of threads; the same
/// query always has the same answer.
class SurfaceLocator {
 public:
  explicit SurfaceLocator(const TriangleMesh& mesh);

  /// The nearest point of the surface. Barycentric coordinates below 1e-12 are exactly zero, so that `support_of`
  /// tells vertices and edges. Invalid only for a mesh without faces or a point that is not finite.
  NearestPoint nearest(const Vec3& point) const { return nearest(point, infinity); }
  /// The same, if it is nearer than `max_distance`; costs less the smaller that is.
  NearestPoint nearest(const Vec3& point, double max_distance) const;

  /// The first point that the segment from a to b has in common with the surface, ends included. A segment never
  /// slips through between two triangles that share an edge (Woop, Benthin & Wald, JCGT 2013). Triangles that contain
  /// its direction (seen edge-on) are not met.
  SegmentHit first_hit(const Vec3& a, const Vec3& b) const { return cast(a, b, false); }
  /// True when the segment meets the surface; faster than `first_hit`.
  bool intersects(const Vec3& a, const Vec3& b) const { return cast(a, b, true).hit; }

 private:
  struct Corners {
    std::array<Vec3, 3> p;
    Index face;
  };
  /// Inner nodes have count 0, their left child is the next node and `other` is the right one; leaves hold
  /// `count` triangles from `other` on.
  struct Node {
    Box3 box;
    Index other;
    Index count;
  };
  struct Builder;

  SegmentHit cast(const Vec3& a, const Vec3& b, bool any) const;

  std::vector<Corners> corners_;
  std::vector<Node> nodes_;
};

}  // namespace isopath
