#pragma once

#include <span>

#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/large_pages.h"
#include "isopath/mesh/local_numbering.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// The half-edges of a mesh in the order of a numbering, for walks from neighbour to neighbour: those of the mesh and
/// the geometry themselves where nothing is numbered anew, otherwise copies. All must outlive it.
class LocalHalfedges {
 public:
  LocalHalfedges(const TriangleMesh& mesh, const IntrinsicGeometry& geometry, const LocalNumbering& numbering);

  Index n_halfedges() const { return static_cast<Index>(twin_.size()); }
  Index n_vertices() const { return static_cast<Index>(outgoing_.size()); }
  double length(Index halfedge) const { return length_[halfedge]; }
  const Vec2& apex(Index halfedge) const { return apex_[halfedge]; }
  double angle_at_tail(Index halfedge) const { return angle_[halfedge]; }
  Index twin(Index halfedge) const { return twin_[halfedge]; }
  Index from(Index halfedge) const { return tail_[halfedge]; }
  Index to(Index halfedge) const { return tail_[TriangleMesh::next(halfedge)]; }
  /// See TriangleMesh::outgoing.
  Index outgoing(Index vertex) const { return outgoing_[vertex]; }

 private:
  void copy_half_edges(const LocalNumbering& numbering);
  void copy_outgoing(const LocalNumbering& numbering);

  std::span<const double> length_;
  std::span<const Vec2> apex_;
  std::span<const double> angle_;
  std::span<const Index> twin_;
  std::span<const Index> tail_;
  std::span<const Index> outgoing_;  ///< by vertex
  LargeVector<double> own_length_;
  LargeVector<Vec2> own_apex_;
  LargeVector<double> own_angle_;
  LargeVector<Index> own_twin_;
  LargeVector<Index> own_tail_;
  LargeVector<Index> own_outgoing_;
};

}  // namespace isopath
