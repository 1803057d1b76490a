#pragma once

#include <algorithm>
#include <span>

#include "isopath/field/intrinsic_geometry.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Directions around a vertex from which a front arrives, or that a source segment serves: no fan is needed within
/// `half_width` of `angle`, measured counter-clockwise from an outgoing half-edge.
struct BlockedArc {
  double angle = 0;  ///< at most once around
  double half_width = 0;
};

/// Angles are sums of a few arcus tangents, each good to 1e-16; a fan is opened this much wider than its shadow.
constexpr double angle_slack = 1e-12;

/// True when shortest paths may bend at a vertex of this total angle: it is a saddle, or a reflex corner of the
/// boundary.
bool may_bend(const TriangleMesh& mesh, Index vertex, double total_angle);

/// Where a fan from the tail of `outgoing`, from direction `low` to `high`, meets the opposite half-edge, in its frame.
/// Directions are measured from `outgoing`; not positive or infinite ones stand for the sides of the face.
struct FanInterval {
  double begin = 0;
  double end = 0;
};
FanInterval fan_interval(const IntrinsicGeometry& geometry, Index outgoing, double low, double high);

/// Calls visit(outgoing half-edge, low, high, cut) for every part of the faces around a vertex that no arc blocks;
/// `low` is zero where the part begins at the face's side, and `cut` tells that it ends before the other. Arcs are
/// measured from the outgoing half-edge `first`, which is the vertex's first one on the boundary.
template <class Visit>
void for_each_free_arc(const TriangleMesh& mesh, const IntrinsicGeometry& geometry, Index vertex, Index first,
                       double total, std::span<const BlockedArc> blocked, Visit&& visit) {
  const int turns = mesh.is_boundary_vertex(vertex) ? 0 : 1;
  double start = 0;
  Index h = first;
  do {
    const double angle = geometry.angle_at_tail(h);
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
      visit(h, low, high, high < angle);
      low = high;
    }
    start += angle;
    h = mesh.next_outgoing(h);
  } while (h != no_index && h != first);
}

}  // namespace isopath
