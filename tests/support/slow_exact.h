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
/// edge is known to be shorter. Beams are never trimmed against each other, and every value is the length of a real
/// path, so that rounding can only lengthen a result. It reads edge lengths, not positions. For meshes of some hundred
/// triangles.
class SlowExact {
 public:
  SlowExact(const TriangleMesh& mesh, std::span<const SourceElement> sources);
  /// In the metric of these lengths, one for each edge.
  SlowExact(const TriangleMesh& mesh, std::span<const double> edge_lengths, std::span<const SourceElement> sources);

  /// Infinity where no source reaches.
  const std::vector<double>& vertex_distances() const { return vertex_; }
  double distance(const SurfacePoint& point) const;

 private:
  /// Straight rays that enter a face across one of its half-edges. In the frame of the half-edge (along x, face above)
  /// they come from the point `from`, or in direction `along` from the line through `from`.
  struct Beam {
    Index halfedge = no_index;
    double low = 0;  ///< the part of the half-edge that the beam passes, as fractions from its start
    double high = 0;
    Vec2 from = Vec2::Zero();
    Vec2 along = Vec2::Zero();  ///< unit; zero for a point
    double sigma = 0;           ///< length of the way up to `from`

    bool is_parallel() const { return along != Vec2::Zero(); }
    Vec2 direction_through(const Vec2& at) const { return is_parallel() ? along : Vec2(at - from); }
    double length_to(const Vec2& at) const {
      return sigma + (is_parallel() ? along.dot(at - from) : (at - from).norm());
    }
    /// Where the ray that ends at `at`, above the half-edge, passes its line.
    double passage_to(const Vec2& at) const;
  };
  /// A vertex to emit from, or a beam to follow, once everything nearer is done.
  struct Event {
    double key = 0;
    Index vertex = no_index;
    Beam beam = {};
    bool operator<(const Event& other) const { return key > other.key; }
  };
  /// A source inside a closed face; two equal ends for a point.
  struct InFace {
    SurfacePoint a;
    SurfacePoint b;
  };

  std::array<Vec2, 3> corners_from(Index halfedge) const;
  Vec2 place(const SurfacePoint& point, Index halfedge) const;
  double shortest_through(const Beam& beam, const Vec2& at) const;
  void find_bending_vertices();
  void add_point(const SurfacePoint& point);
  void add_segment(const SurfacePoint& a, const SurfacePoint& b);
  void add_in_face(const SurfacePoint& a, const SurfacePoint& b);
  void emit_from_vertex(Index vertex, double sigma);
  void relax(Index vertex, double distance);
  void leave(Index halfedge, Beam beam);
  void follow(const Beam& beam);
  void run();

  double length_of(Index halfedge) const { return edge_length_[mesh_.edge_of(halfedge)]; }

  const TriangleMesh& mesh_;
  std::vector<double> edge_length_;
  std::vector<char> bends_;
  std::vector<double> vertex_;
  std::vector<std::vector<Beam>> beams_of_face_;
  std::vector<std::vector<InFace>> sources_of_face_;
  std::vector<Event> queue_;
};

}  // namespace isopath::test
