#pragma once

#include <span>
#include <vector>

#include "isopath/mesh/triangle_soup.h"

namespace isopath {

/// Half-edges of any triangles, grouped by undirected edge: what `check` and `repair` look at before there is a mesh.
/// Half-edge `3 f + i` runs from corner `i` of triangle `f` to corner `i + 1 mod 3`, as in TriangleMesh.
class EdgeTable {
 public:
  /// Every index must lie in [0, n_vertices) and no triangle may use a vertex twice. The triangles must outlive this.
  EdgeTable(std::span<const Triangle> triangles, std::size_t n_vertices);

  std::size_t size() const { return begin_.size() - 1; }
  /// Half-edges of an edge, ascending. Edges are ordered by their lower, then their upper vertex.
  std::span<const Index> operator[](std::size_t edge) const {
    return std::span(halfedges_).subspan(begin_[edge], begin_[edge + 1] - begin_[edge]);
  }
  Index from(Index halfedge) const { return triangles_[halfedge / 3][halfedge % 3]; }
  Index to(Index halfedge) const { return triangles_[halfedge / 3][(halfedge % 3 + 1) % 3]; }

 private:
  std::span<const Triangle> triangles_;
  std::vector<Index> halfedges_;
  std::vector<Index> begin_;
};

/// Half-edge glued to each half-edge, `no_index` where there is none.
using Pairing = std::vector<Index>;

/// Glues the two triangles of every edge that has exactly two, however they are oriented.
Pairing pair_simple_edges(const EdgeTable& edges, std::size_t n_triangles);

/// Which triangles to reverse so that glued triangles agree.
struct Orientation {
  std::vector<char> reverse;  ///< for each triangle
  std::vector<Index> patch;   ///< for each triangle: the glued piece it belongs to
  Index n_patches = 0;
  std::vector<Index> conflicts;  ///< one half-edge of each glued pair that cannot agree: the surface is one-sided
};

/// Walks over the glued triangles; in each patch as few triangles as possible are reversed, and the one of lowest index
/// stays when both choices reverse the same number.
Orientation orient(std::span<const Triangle> triangles, const Pairing& pairing);

}  // namespace isopath
