#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <span>

#include "isopath/field/large_pages.h"
#include "isopath/mesh/local_numbering.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// How the half-edges of a mesh hang together, in the order of a numbering, for walks from neighbour to neighbour: the
/// arrays of the mesh itself where nothing is numbered anew, otherwise copies. The mesh must outlive it.
class LocalHalfedges {
 public:
  LocalHalfedges(const TriangleMesh& mesh, const LocalNumbering& numbering);
  LocalHalfedges(const LocalHalfedges&) = delete;
  LocalHalfedges& operator=(const LocalHalfedges&) = delete;

  Index n_halfedges() const { return static_cast<Index>(twin_.size()); }
  Index n_vertices() const { return static_cast<Index>(outgoing_.size()); }
  Index twin(Index halfedge) const { return twin_[halfedge]; }
  Index from(Index halfedge) const { return tail_[halfedge]; }
  Index to(Index halfedge) const { return tail_[TriangleMesh::next(halfedge)]; }
  /// See TriangleMesh::outgoing.
  Index outgoing(Index vertex) const { return outgoing_[vertex]; }
  bool is_boundary_vertex(Index vertex) const {
    return outgoing_[vertex] != no_index && twin_[outgoing_[vertex]] == no_index;
  }

 private:
  std::span<const Index> twin_;
  std::span<const Index> tail_;
  std::span<const Index> outgoing_;  ///< by vertex
  LargeVector<Index> own_twin_;
  LargeVector<Index> own_tail_;
  LargeVector<Index> own_outgoing_;
};

/// Calls copy(here, in_mesh) for the half-edges of all faces, in parallel, in the order of their numbers here. In the
/// mesh they may lie anywhere: before each face fetch(later, soon) is called with the first half-edges, in the mesh, of
/// two faces that come after it, to fetch into the cache what the later one needs, and what that tells by the time it
/// has become the sooner one.
template <class Fetch, class Copy>
void copy_halfedges(const LocalNumbering& numbering, Index n_halfedges, const Fetch& fetch, const Copy& copy) {
  constexpr Index faces_at_a_time = 1024;
  constexpr Index ahead = 16;
  const tbb::blocked_range<Index> all(0, n_halfedges / 3, faces_at_a_time);
  tbb::parallel_for(all, [&](const tbb::blocked_range<Index>& faces) {
    for (Index face = faces.begin(); face < faces.end(); ++face) {
      fetch(numbering.halfedge_in_mesh(3 * std::min(face + ahead, faces.end() - 1)),
            numbering.halfedge_in_mesh(3 * std::min(face + ahead / 2, faces.end() - 1)));
      const Index in_mesh = numbering.halfedge_in_mesh(3 * face);
      for (Index i = 0; i < 3; ++i) copy(3 * face + i, in_mesh + i);
    }
  });
}

}  // namespace isopath
