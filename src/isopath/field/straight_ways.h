#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/field/source.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Straight ways over the faces next to a start, unfolded exactly: to vertices that a start sees. Each is the length of
/// a real way, never shorter than the shortest. Within a few edges of where it starts a front is too strongly curved to
/// be told from the distances at the ends of edges; there these take its place.
class StraightWays {
 public:
  struct Way {
    std::uint32_t to;
    double length;  ///< in mm
  };

  explicit StraightWays(const TriangleMesh& mesh) : mesh_(mesh) {}

  /// From a vertex, to those behind at most `most_faces` faces. Valid until the next call, as the others.
  std::span<const Way> from_vertex(Index vertex, std::size_t most_faces);
  /// From a point or a segment of a source; from a segment perpendicularly, to both sides.
  std::span<const Way> from_element(const SourceElement& element, std::size_t most_faces);

 private:
  /// Rays that leave a face through a half-edge, in a plane that has the start at the origin, or along the x axis.
  struct Beam {
    Index halfedge;
    Vec2 tail;
    Vec2 head;
    Vec2 right;  ///< points that the outermost rays pass, both on or between tail and head
    Vec2 left;
  };
  void leave(Beam beam);
  template <bool parallel>
  void enter(const Beam& beam);
  template <bool parallel>
  void follow(std::size_t most_faces);
  void add_segment(const SourceElement& element, Index face, bool reversed);
  void add_point(const SourceElement& element, Index face);

  const TriangleMesh& mesh_;
  bool parallel_ = false;  ///< rays run along the y axis, not from the origin
  std::vector<Beam> beams_;
  std::vector<Way> ways_;
};

}  // namespace isopath
