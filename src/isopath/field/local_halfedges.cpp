#include "isopath/field/local_halfedges.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace isopath {
namespace {

constexpr Index faces_at_a_time = 1024;
/// Faces that lie anywhere are fetched into the cache this many places before their turn.
constexpr Index faces_ahead = 16;

std::span<const Index> tails_of(const TriangleMesh& mesh) {
  static_assert(sizeof(Triangle) == 3 * sizeof(Index));  // half-edge h starts at corner h of all
  const auto& triangles = mesh.soup().triangles;
  return {triangles.empty() ? nullptr : triangles.front().data(), 3 * triangles.size()};
}

}  // namespace

LocalHalfedges::LocalHalfedges(const TriangleMesh& mesh, const IntrinsicGeometry& geometry,
                               const LocalNumbering& numbering)
    : length_(geometry.lengths()),
      apex_(geometry.apexes()),
      angle_(geometry.angles()),
      twin_(mesh.twins()),
      tail_(tails_of(mesh)),
      outgoing_(mesh.outgoing()) {
  if (numbering.is_that_of_mesh()) return;
  copy_half_edges(numbering);
  copy_outgoing(numbering);
}

void LocalHalfedges::copy_half_edges(const LocalNumbering& numbering) {
  const Index n = n_halfedges();
  own_length_.resize(n);
  own_apex_.resize(n);
  own_angle_.resize(n);
  own_twin_.resize(n);
  own_tail_.resize(n);
  tbb::parallel_for(tbb::blocked_range<Index>(0, n / 3, faces_at_a_time), [&](const tbb::blocked_range<Index>& faces) {
    for (Index face = faces.begin(); face < faces.end(); ++face) {
      const Index soon = numbering.halfedge_in_mesh(3 * std::min(face + faces_ahead, faces.end() - 1));
      __builtin_prefetch(&length_[soon]);
      __builtin_prefetch(&apex_[soon]);
      __builtin_prefetch(&angle_[soon]);
      __builtin_prefetch(&twin_[soon]);
      __builtin_prefetch(&tail_[soon]);
      const Index first = numbering.halfedge_in_mesh(3 * face);
      for (Index i = 0; i < 3; ++i) {
        own_length_[3 * face + i] = length_[first + i];
        own_apex_[3 * face + i] = apex_[first + i];
        own_angle_[3 * face + i] = angle_[first + i];
        own_twin_[3 * face + i] = numbering.halfedge_here(twin_[first + i]);
        own_tail_[3 * face + i] = numbering.vertex_here(tail_[first + i]);
      }
    }
  });
  length_ = own_length_;
  apex_ = own_apex_;
  angle_ = own_angle_;
  twin_ = own_twin_;
  tail_ = own_tail_;
}

void LocalHalfedges::copy_outgoing(const LocalNumbering& numbering) {
  own_outgoing_.resize(outgoing_.size());
  tbb::parallel_for(Index(0), n_vertices(), [&](Index vertex) {
    own_outgoing_[vertex] = numbering.halfedge_here(outgoing_[numbering.vertex_in_mesh(vertex)]);
  });
  outgoing_ = own_outgoing_;
}

}  // namespace isopath
