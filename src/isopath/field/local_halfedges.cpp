#include "isopath/field/local_halfedges.h"

namespace isopath {
namespace {

std::span<const Index> tails_of(const TriangleMesh& mesh) {
  static_assert(sizeof(Triangle) == 3 * sizeof(Index));  // half-edge h starts at corner h of all
  const auto& triangles = mesh.soup().triangles;
  return {triangles.empty() ? nullptr : triangles.front().data(), 3 * triangles.size()};
}

}  // namespace

LocalHalfedges::LocalHalfedges(const TriangleMesh& mesh, const LocalNumbering& numbering)
    : twin_(mesh.twins()), tail_(tails_of(mesh)), outgoing_(mesh.outgoing()) {
  if (numbering.is_that_of_mesh()) return;
  own_twin_.resize(twin_.size());
  own_tail_.resize(tail_.size());
  own_outgoing_.resize(outgoing_.size());
  const auto fetch = [&](Index later, Index soon) {
    __builtin_prefetch(&twin_[later]);
    __builtin_prefetch(&tail_[later]);
    for (Index h = soon; h < soon + 3; ++h) {
      numbering.prefetch_halfedge(twin_[h]);
      numbering.prefetch_vertex(tail_[h]);
    }
  };
  copy_halfedges(numbering, n_halfedges(), fetch, [&](Index here, Index in_mesh) {
    own_twin_[here] = numbering.halfedge_here(twin_[in_mesh]);
    own_tail_[here] = numbering.vertex_here(tail_[in_mesh]);
  });
  tbb::parallel_for(Index(0), n_vertices(), [&](Index vertex) {
    own_outgoing_[vertex] = numbering.halfedge_here(outgoing_[numbering.vertex_in_mesh(vertex)]);
  });
  twin_ = own_twin_;
  tail_ = own_tail_;
  outgoing_ = own_outgoing_;
}

}  // namespace isopath
