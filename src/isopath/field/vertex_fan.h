#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/large_pages.h"
#include "isopath/field/local_geometry.h"
#include "isopath/field/local_halfedges.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Directions around a vertex from which a front arrives, or that a source segment serves: no fan is needed within
/// `half_width` of `angle`, measured counter-clockwise from an outgoing half-edge.
struct BlockedArc {
  double angle = 0;  ///< at most once around
  double half_width = 0;
};

/// Directions, from a half-edge counter-clockwise, in which its tail sends a fan into its face; none when low > high.
struct FanArc {
  double low = infinity;
  double high = -infinity;
};

/// Angles are sums of a few arcus tangents, each good to 5e-16; a fan is opened this much wider than its shadow.
constexpr double angle_slack = 1e-12;

/// An edge at a vertex, and the face that follows it counter-clockwise.
struct Spoke {
  double length;
  double angle;    ///< of the face, at the vertex
  Index halfedge;  ///< outgoing, of the face; no_index for the edge that closes the fan of a boundary vertex
  Index to;        ///< the vertex at the other end
};

/// The spokes of every vertex counter-clockwise, side by side in memory: a walk around a vertex through the mesh would
/// touch as many cache lines as it has steps. On the boundary from the edge that opens the fan to the one that closes
/// it; elsewhere from the vertex's outgoing half-edge once around. None where no face uses the vertex.
class VertexRings {
 public:
  VertexRings() = default;
  VertexRings(const LocalHalfedges& halfedges, const LocalGeometry& geometry);

  std::span<const Spoke> of(Index vertex) const {
    return std::span(spokes_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

 private:
  std::vector<Index> first_;
  LargeVector<Spoke> spokes_;
};

/// The vertex is inside the surface.
inline bool is_closed(std::span<const Spoke> ring) { return !ring.empty() && ring.back().halfedge != no_index; }

/// True when shortest paths may bend at a vertex of this total angle: it is a saddle, or a reflex corner of the
/// boundary.
bool may_bend(bool on_boundary, double total_angle);

/// Where a fan from the tail of a half-edge of this length, from direction `low` to `high`, meets the opposite
/// half-edge, in its frame; `apex` and directions are those in the outgoing one's frame. Directions that are not
/// positive or infinite stand for the sides of the face.
struct FanInterval {
  double begin = 0;
  double end = 0;
};
FanInterval fan_interval(double length, const Vec2& apex, double opposite_length, double low, double high);

/// Calls visit(outgoing half-edge, low, high, cut) for every part of the faces around a vertex that no arc blocks;
/// `low` is zero where the part begins at the face's side, and `cut` tells that it ends before the other. Arcs are
/// measured from the spoke of number `first`, which is 0 on the boundary; `total` is the sum of all angles.
template <class Visit>
void for_each_free_arc(std::span<const Spoke> ring, std::size_t first, double total,
                       std::span<const BlockedArc> blocked, Visit&& visit) {
  const int turns = is_closed(ring) ? 1 : 0;
  double start = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Spoke& spoke = ring[first + k < ring.size() ? first + k : first + k - ring.size()];
    if (spoke.halfedge == no_index) break;
    const double angle = spoke.angle;
    const auto hides_face = [&](const BlockedArc& arc) {
      return arc.angle - arc.half_width <= start && start + angle <= arc.angle + arc.half_width;
    };
    const bool hidden = std::any_of(blocked.begin(), blocked.end(), hides_face);
    // From one blocked arc to the next: what they leave of [0, angle] in this face. A fan has few arcs.
    for (double low = hidden ? angle : 0; low < angle;) {
      double high = angle;
      double past = low;
      for (const BlockedArc& arc : blocked) {
        for (int turn = -turns; turn <= turns; ++turn) {
          const double arc_low = arc.angle - arc.half_width - start + turn * total;
          const double arc_high = arc.angle + arc.half_width - start + turn * total;
          if (arc_low <= low && arc_high > past) past = arc_high;
          if (arc_low > low) high = std::min(high, arc_low);
        }
      }
      if (past > low) {
        low = past;
        continue;
      }
      visit(spoke.halfedge, low, high, high < angle);
      low = high;
    }
    start += angle;
  }
}

}  // namespace isopath
