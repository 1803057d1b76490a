#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Another triangulation of the same surface, whose edges are straight in it without being edges of the mesh: known by
/// lengths alone. Half-edge 3 f + i belongs to face f, its next ones follow round. Two faces may share two edges, and a
/// face may meet itself.
struct IntrinsicTriangulation {
  /// A vertex on a boundary edge, at (1 - t) a + t b; a and b come before it.
  struct AddedVertex {
    Index a = no_index;
    Index b = no_index;
    double t = 0;
  };

  std::vector<Index> tail;         ///< vertex that each half-edge starts at
  std::vector<Index> twin;         ///< the opposite half-edge, `no_index` on the boundary
  std::vector<double> length;      ///< of each half-edge, mm
  std::vector<AddedVertex> added;  ///< numbered on from the mesh's vertices
  Index n_vertices = 0;            ///< with those added

  Index n_halfedges() const { return static_cast<Index>(tail.size()); }
  /// The corner opposite a half-edge, which itself runs along x from the origin.
  Vec2 apex(Index halfedge) const;
  /// Cotangent of the angle opposite a half-edge. Heights below 1e-6 of their base are taken for that: no angle is
  /// smaller, and sums of cotangents keep ten digits.
  double cotangent(Index halfedge) const;
};

/// The intrinsic Delaunay triangulation (Bobenko & Springborn 2007; Fisher, Springborn, Schröder & Bajaj 2007): edges
/// are flipped inside the surface until the angles opposite each of them add up to π at most, so that no cotangent
/// weight is negative. Boundary edges cannot be flipped: one that is seen from its triangle under more than π/2 is
/// divided at the foot of the opposite corner. Where sharp corners of the boundary would ask for that without end it is
/// done ten times at most. Throws Error(cancelled) on request.
IntrinsicTriangulation intrinsic_delaunay(const TriangleMesh& mesh, const IntrinsicGeometry& geometry,
                                          const Progress& progress = Progress::none());

}  // namespace isopath
