#pragma once

#include <algorithm>
#include <vector>

#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Numbers of vertices and faces "here", in arrays of one's own, by which neighbours on the surface are neighbours in
/// memory. Where they are in the mesh already, these are the mesh's own; otherwise, as in files that a program wrote in
/// the order of a hash table, vertices are numbered along a Z-order curve through the mesh's box (Morton 1966), and
/// faces by the first of their vertices. The corners of a face keep their order.
class LocalNumbering {
 public:
  explicit LocalNumbering(const TriangleMesh& mesh);

  /// Nothing is numbered anew.
  bool is_that_of_mesh() const { return vertices_.in_mesh.empty(); }

  Index vertex_here(Index in_mesh) const { return is_that_of_mesh() ? in_mesh : vertices_.here[in_mesh]; }
  Index vertex_in_mesh(Index here) const { return is_that_of_mesh() ? here : vertices_.in_mesh[here]; }
  void prefetch_vertex(Index in_mesh) const { __builtin_prefetch(&vertices_.here[in_mesh]); }
  void prefetch_halfedge(Index in_mesh) const { __builtin_prefetch(&faces_.here[std::max(in_mesh, 0) / 3]); }
  /// `no_index` stays what it is.
  Index halfedge_here(Index in_mesh) const {
    return is_that_of_mesh() || in_mesh == no_index ? in_mesh : 3 * faces_.here[in_mesh / 3] + in_mesh % 3;
  }
  Index halfedge_in_mesh(Index here) const {
    return is_that_of_mesh() || here == no_index ? here : 3 * faces_.in_mesh[here / 3] + here % 3;
  }

 private:
  struct Numbers {
    std::vector<Index> here;     ///< by number in the mesh
    std::vector<Index> in_mesh;  ///< by number here
  };
  /// Numbers things from 0 to n - 1 in the order of their keys, which are below n_keys; of equal ones in that of the
  /// mesh.
  template <class Key>
  static Numbers in_order_of(Index n, std::size_t n_keys, const Key& key);

  Numbers vertices_;
  Numbers faces_;
};

}  // namespace isopath
