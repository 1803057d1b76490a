#pragma once

#include <span>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/core/tolerance.h"
#include "isopath/mesh/triangle_soup.h"

namespace isopath {

/// A consistently oriented manifold triangle mesh, with or without boundary, of any genus and number of components.
/// Immutable.
///
/// Half-edge `3 f + i` runs from corner `i` of face `f` to corner `i + 1 mod 3`, with the face on its left. Edge `e` is
/// the undirected edge; its canonical half-edge is the lower of its two. Vertices keep the numbering of the soup; a
/// vertex that no triangle uses stays, without half-edge.
class TriangleMesh {
 public:
  TriangleMesh() = default;

  /// Throws Error(bad_input) that names the first offending element when a coordinate is not finite or too large to
  /// square, the whole is too small to square, an index is out of range, a triangle repeats a vertex, or an edge or
  /// vertex is not manifold and consistently oriented.
  explicit TriangleMesh(TriangleSoup soup);

  Index n_vertices() const { return static_cast<Index>(soup_.positions.size()); }
  Index n_faces() const { return static_cast<Index>(soup_.triangles.size()); }
  Index n_halfedges() const { return 3 * n_faces(); }
  Index n_edges() const { return static_cast<Index>(halfedge_of_edge_.size()); }

  const TriangleSoup& soup() const { return soup_; }
  const Vec3& position(Index vertex) const { return soup_.positions[vertex]; }
  const Triangle& triangle(Index face) const { return soup_.triangles[face]; }

  static Index face_of(Index halfedge) { return halfedge / 3; }
  static Index next(Index halfedge) { return halfedge % 3 == 2 ? halfedge - 2 : halfedge + 1; }
  static Index prev(Index halfedge) { return halfedge % 3 == 0 ? halfedge + 2 : halfedge - 1; }
  Index from(Index halfedge) const { return soup_.triangles[halfedge / 3][halfedge % 3]; }
  Index to(Index halfedge) const { return from(next(halfedge)); }
  /// The opposite half-edge, `no_index` on the boundary.
  Index twin(Index halfedge) const { return twin_[halfedge]; }
  std::span<const Index> twins() const { return twin_; }

  Index edge_of(Index halfedge) const { return edge_of_halfedge_[halfedge]; }
  /// The edge's canonical half-edge.
  Index halfedge_of(Index edge) const { return halfedge_of_edge_[edge]; }
  bool is_boundary_edge(Index edge) const { return twin_[halfedge_of_edge_[edge]] == no_index; }
  double edge_length(Index edge) const { return edge_length_[edge]; }
  std::span<const double> edge_lengths() const { return edge_length_; }

  /// An outgoing half-edge of the vertex; the one without twin when the vertex is on the boundary, so that
  /// `next_outgoing` from it visits the whole fan. `no_index` for an unused vertex.
  Index outgoing(Index vertex) const { return outgoing_[vertex]; }
  std::span<const Index> outgoing() const { return outgoing_; }
  /// The next outgoing half-edge counter-clockwise, `no_index` past the boundary. Interior fans come round.
  Index next_outgoing(Index halfedge) const { return twin_[prev(halfedge)]; }
  bool is_boundary_vertex(Index vertex) const {
    return outgoing_[vertex] != no_index && twin_[outgoing_[vertex]] == no_index;
  }

  /// Boundary loops as closed sequences of half-edges without twin, each with the surface on its left; longest first.
  const std::vector<std::vector<Index>>& boundary_loops() const { return boundary_loops_; }
  /// Connected component of a face, numbered from 0 by lowest face.
  Index component_of(Index face) const { return component_of_face_[face]; }
  Index n_components() const { return n_components_; }

  Vec3 face_normal(Index face) const;  ///< unit; zero for a triangle without area
  double face_area(Index face) const;
  double area() const;
  const Box3& bounds() const { return bounds_; }
  /// Diagonal of the bounding box: the size that tolerances are relative to.
  double size() const { return bounds_.isEmpty() ? 0 : bounds_.diagonal().norm(); }
  Tolerance tolerance() const { return Tolerance::of_size(size()); }

 private:
  void pair_halfedges();
  void number_edges();
  void choose_outgoing();
  void trace_boundary();
  void label_components();

  TriangleSoup soup_;
  std::vector<Index> twin_;
  std::vector<Index> edge_of_halfedge_;
  std::vector<Index> halfedge_of_edge_;
  std::vector<double> edge_length_;
  std::vector<Index> outgoing_;
  std::vector<std::vector<Index>> boundary_loops_;
  std::vector<Index> component_of_face_;
  Index n_components_ = 0;
  Box3 bounds_;
};

}  // namespace isopath
