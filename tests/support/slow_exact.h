#pragma once

#include <array>
#include <span>
#include <vector>

#include "isopath/field/source.h"

namespace isopath::test {

/// Geodesic distances by exhaustive unfolding, as a judge of the library's exact field, with which it shares no code.
///
/// From every source element, and from every vertex that a shortest path may bend at, beams are followed through all
/// sequences of faces; a beam ends only where it is empty, or where at each of its points the way over an end of the
/// edge is known to be shorter, or where it would come into a face again. Beams are never trimmed against each other,
/// and every value is the length of a real path, so that rounding can only lengthen a result. It computes with 64 bits
/// of mantissa, from the positions on: on meshes of slivers, too, it knows distances to about 1e-15 of the mesh's size
/// (docs/robustness.md). For meshes of some hundred triangles.
class SlowExact {
 public:
  using Real = long double;
  using Vec = Eigen::Matrix<Real, 2, 1>;

  SlowExact(const TriangleMesh& mesh, std::span<const SourceElement> sources);
  /// In the metric of these lengths, one for each edge. Slivers are then known less well: lengths define them badly.
  SlowExact(const TriangleMesh& mesh, std::span<const double> edge_lengths, std::span<const SourceElement> sources);

  /// Infinity where no source reaches.
  const std::vector<double>& vertex_distances() const { return result_; }
  double distance(const SurfacePoint& point) const;

 private:
  /// Straight rays that enter a face across one of its half-edges. In the frame of the half-edge (along x, face above)
  /// they come from the point `from`, or in direction `along` from the line through `from`.
  struct Beam {
    Index halfedge = no_index;
    Real low = 0;  ///< the part of the half-edge that the beam passes, as fractions from its start
    Real high = 0;
    Vec from = Vec::Zero();
    Vec along = Vec::Zero();  ///< unit; zero for a point
    Real sigma = 0;           ///< length of the way up to `from`
    Index trail = no_index;   ///< the faces it has passed, in trail_

    bool is_parallel() const { return along != Vec::Zero(); }
    Vec direction_through(const Vec& at) const { return is_parallel() ? along : Vec(at - from); }
    Real length_to(const Vec& at) const { return sigma + (is_parallel() ? along.dot(at - from) : (at - from).norm()); }
    /// Where the ray that ends at `at`, above the half-edge, passes its line.
    Real passage_to(const Vec& at) const;
  };
  /// A vertex to emit from, or a beam to follow, once everything nearer is done.
  struct Event {
    Real key = 0;
    Index vertex = no_index;
    Beam beam = {};
    bool operator<(const Event& other) const { return key > other.key; }
  };
  /// A face that beams passed, and the trail before it.
  struct Passed {
    Index face = no_index;
    Index before = no_index;
  };
  /// A source inside a closed face; two equal ends for a point.
  struct InFace {
    SurfacePoint a;
    SurfacePoint b;
  };

  explicit SlowExact(const TriangleMesh& mesh);
  void solve(std::span<const SourceElement> sources);
  Real length_of(Index halfedge) const { return corners_[halfedge][1].x(); }
  Vec place(const SurfacePoint& point, Index halfedge) const;
  Real shortest_through(const Beam& beam, const Vec& at) const;
  void find_bending_vertices();
  void add_point(const SurfacePoint& point);
  void add_segment(const SurfacePoint& a, const SurfacePoint& b);
  void add_in_face(const SurfacePoint& a, const SurfacePoint& b);
  void emit_from_vertex(Index vertex, Real sigma);
  void relax_along_edges(Index vertex, Real sigma);
  void relax(Index vertex, Real distance);
  bool has_passed(Index trail, Index face) const;
  void leave(Index halfedge, Beam beam);
  void follow(const Beam& beam);
  void run();

  const TriangleMesh& mesh_;
  std::vector<char> bends_;
  std::vector<std::array<Vec, 3>> corners_;  ///< per half-edge, in its frame: its start, its end, the third corner
  std::vector<std::array<Vec, 2>> sides_;    ///< the same: directions of the next half-edge and of the one before
  std::vector<Passed> trail_;
  std::vector<Real> vertex_;
  std::vector<double> result_;
  std::vector<std::vector<Beam>> beams_of_face_;
  std::vector<std::vector<InFace>> sources_of_face_;
  std::vector<Event> queue_;
};

}  // namespace isopath::test
