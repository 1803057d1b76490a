#pragma once

#include <array>
#include <functional>
#include <vector>

#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// A triangle during refinement: a face of the old mesh, or a part of one.
struct RefineTriangle {
  Index face = no_index;                 ///< face of the old mesh
  std::array<Vec3, 3> barycentric = {};  ///< of its corners, with respect to that face
  std::array<Vec3, 3> position = {};     ///< of its corners
  int level = 0;                         ///< how often it was split: 0 for a face of the old mesh
};

/// A finer mesh of the same surface.
struct RefinedMesh {
  TriangleMesh mesh;
  std::vector<SurfacePoint> on_old;  ///< of each vertex, where it lies on the old mesh; old vertices keep their numbers
  std::vector<Index> old_face;       ///< of each face, the old face it is a part of
};

/// Red-green refinement (Bank, Sherman & Weiser 1983): triangles for which `wants_split` holds are split 1-to-4 at the
/// midpoints of their edges, and so on with their parts, at most `max_levels` times; what then has one split edge is
/// halved. The result is conforming. Its triangles are similar to those of the old mesh or are halves of such ones, so
/// that no angle gets worse with the number of levels. `wants_split` is asked once for each triangle, in a fixed order.
/// Throws Error(bad_usage) for a negative number of levels or one above 20, and Error(bad_input) when the result would
/// have more triangles than an Index can number.
RefinedMesh refine(const TriangleMesh& mesh, const std::function<bool(const RefineTriangle&)>& wants_split,
                   int max_levels);

/// Where the faces of a mesh that was made finer step by step lie on the one it was made from.
class RefinementTrail {
 public:
  /// One more step: from the mesh so far, which is the first one at the first step.
  void add(const TriangleMesh& mesh, const RefinedMesh& refined);
  /// A point of the last mesh, on the first one. Points that share a face there share one here. Without steps the point
  /// itself; an invalid point stays invalid.
  SurfacePoint on_first(const SurfacePoint& point) const;

 private:
  struct Part {
    Index face;
    std::array<Vec3, 3> corners;  // barycentric in the face
  };
  std::vector<Part> parts_;
};

/// A mesh that was made finer twice, in one step from the first: `second` is a finer mesh of `first.mesh`.
RefinedMesh composed(const TriangleMesh& mesh, const RefinedMesh& first, RefinedMesh second);

/// Every triangle split 1-to-4, once.
RefinedMesh split_uniformly(const TriangleMesh& mesh);

/// Halves edges, the longest first, until none is longer than `longest` mm or one more round would lead to more than
/// `most_faces` triangles. Slivers are divided mostly along their length; angles may get worse. For pictures and
/// samples, not for computing on. Throws Error(bad_usage) unless `longest` is positive.
RefinedMesh split_long_edges(const TriangleMesh& mesh, double longest, Index most_faces);

}  // namespace isopath
