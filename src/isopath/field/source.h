#pragma once

#include <span>
#include <vector>

#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// One root of a distance field: a point, or a straight open segment inside one (closed) face (paper ch. 4 and 8).
/// Its index in the `SourceSet` is the root id that distances, nearest roots and Voronoi cells refer to.
struct SourceElement {
  enum class Kind { point, segment };
  Kind kind = Kind::point;
  SurfacePoint a;  ///< the point, or the segment's start
  SurfacePoint b;  ///< the segment's end, in the same face as `a`
  /// Segments that meet at this point, `no_index` where there is none: what lies beside them is theirs, not the
  /// point's.
  Index segment_before = no_index;
  Index segment_after = no_index;
};

/// The set S that distances are measured from: any mixture of vertices, surface points, polylines and boundary loops.
class SourceSet {
 public:
  void add_vertex(const TriangleMesh& mesh, Index vertex);
  void add_point(const SurfacePoint& point);
  /// A polyline whose consecutive points share a face, as `trace_polyline` makes it. Throws Error(internal) where they
  /// do not.
  void add_polyline(const TriangleMesh& mesh, std::span<const SurfacePoint> points, bool closed);
  /// A chain of half-edges, for example a boundary loop or a feature edge, as true segments.
  void add_halfedges(const TriangleMesh& mesh, std::span<const Index> halfedges, bool closed);

  bool empty() const { return elements_.empty(); }
  std::span<const SourceElement> elements() const { return elements_; }

 private:
  Index add_segment(const SurfacePoint& a, const SurfacePoint& b);
  std::vector<SourceElement> elements_;
};

/// Every boundary loop of the mesh, or only loop `k` (longest first). Throws Error(bad_usage) when there is no such
/// loop.
SourceSet boundary_source(const TriangleMesh& mesh);
SourceSet boundary_source(const TriangleMesh& mesh, Index loop);

}  // namespace isopath
