#pragma once

#include <queue>
#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/edge_windows.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/source.h"

namespace isopath {

/// Directions, from a half-edge counter-clockwise, in which its tail sends a fan into its face; none when low > high.
struct FanArc {
  double low = infinity;
  double high = -infinity;
};

/// Continuous Dijkstra over windows and vertices (paper ch. 4): events leave a queue in the order of their least
/// distance; a window crosses its face onto the two other edges, a vertex around which the surface is not flat or
/// convex becomes a pseudo-source.
///
/// Every window that is dropped is, at each of its points, beaten by what the edge holds; so each edge ends up tiled by
/// the exact distance, up to what merging windows changes (see merge_windows). Hair cracks from rounding, narrower than
/// `snap`, are closed when windows are inserted.
class WindowPropagation {
 public:
  WindowPropagation(const TriangleMesh& mesh, const IntrinsicGeometry& geometry, const SourceSet& sources,
                    const MergeLimits& limits);

  void run(double stop_distance, Progress& progress);

  EdgeWindows& windows() { return windows_; }
  std::vector<double>& vertex_distances() { return distance_; }
  std::vector<Index>& vertex_roots() { return root_; }
  /// Per half-edge.
  std::vector<FanArc>& fans() { return fans_; }
  std::size_t propagated() const { return propagated_; }

 private:
  struct Event {
    double distance;
    Index id;  ///< window, or ~vertex
    bool operator>(const Event& other) const {
      return distance != other.distance ? distance > other.distance : id > other.id;
    }
  };
  /// Directions around a vertex from which a front arrives, or that a source segment serves: no fan is needed within
  /// `half_width` of `angle`.
  struct BlockedArc {
    double angle;
    double half_width;
  };
  struct Arrival {
    Index halfedge = no_index;  ///< outgoing half-edge whose edge the front came by
    double error = 0;           ///< most that the distance is off
    double turn = 0;            ///< from that half-edge to the way back to the source, counter-clockwise
  };

  // sources (source_windows.cpp)
  void start(const SourceSet& sources);
  void start_segment(const SourceElement& element, Index id);
  void start_segment_in_face(const SourceElement& element, Index id, Index face);
  void start_point(std::span<const SourceElement> elements, Index id);
  void start_point_in_face(std::span<const SourceElement> elements, Index id, Index face);
  void start_vertex(std::span<const SourceElement> elements, Index id, Index vertex);
  std::vector<Vec2> segment_directions(std::span<const SourceElement> elements, Index id, Index halfedge) const;

  // vertices
  void settle_vertex(Index vertex);
  void emit_fan(Index vertex, double total_angle, std::span<const BlockedArc> blocked);
  void emit_into_face(Index outgoing, double low, double high);
  void follow_edges(Index vertex);
  void offer_vertex(Index vertex, double distance, Index root, const Arrival& arrival);
  double total_angle(Index vertex) const;
  double arrival_angle(Index vertex) const;

  // windows
  void propagate(Index id);
  /// Hands the part [begin, end] of a beam (end points in the frame of `halfedge`, which runs p → q; the rest in the
  /// frame it comes from) on.
  void propagate_to(Index halfedge, const Window& window, const Vec2& p, const Vec2& q);
  /// True when paths along the edge from its corners beat the whole window (given in the half-edge's frame).
  bool hopeless(Index halfedge, const Window& window) const;
  /// Inserts a window given in the frame of `halfedge`, which it arrives at from inside the half-edge's face.
  void insert_leaving(Index halfedge, Window window);
  void insert(Index edge, const Window& canonical);

  const TriangleMesh& mesh_;
  const IntrinsicGeometry& geometry_;
  EdgeWindows windows_;
  std::vector<double> distance_;
  std::vector<Index> root_;
  std::vector<Arrival> arrival_;
  std::vector<char> settled_;
  std::vector<FanArc> fans_;
  std::vector<std::vector<BlockedArc>> source_arcs_;  ///< of vertices that are sources: see source_at_
  std::vector<Index> source_at_;                      ///< per vertex: index into source_arcs_, or none
  std::priority_queue<Event, std::vector<Event>, std::greater<>> queue_;
  std::size_t propagated_ = 0;
  double size_;
};

}  // namespace isopath
