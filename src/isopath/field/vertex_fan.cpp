#include "isopath/field/vertex_fan.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

namespace isopath {
namespace {

/// Fraction along p → q where the ray from the origin in direction d passes; clamped to the segment.
double hit_fraction(const Vec2& p, const Vec2& q, const Vec2& d) {
  const double at_p = cross(d, p);
  const double at_q = cross(d, q);
  return at_p == at_q ? 0 : std::clamp(at_p / (at_p - at_q), 0.0, 1.0);
}

}  // namespace

VertexRings::VertexRings(const LocalHalfedges& halfedges, const LocalGeometry& geometry)
    : first_(halfedges.n_vertices() + 1) {
  for (Index h = 0; h < halfedges.n_halfedges(); ++h) ++first_[halfedges.from(h) + 1];
  for (Index v = 0; v < halfedges.n_vertices(); ++v) {
    first_[v + 1] += first_[v] + (halfedges.is_boundary_vertex(v) ? 1 : 0);
  }
  spokes_.resize(first_.back());
  tbb::parallel_for(Index(0), halfedges.n_vertices(), [&](Index v) {
    Spoke* spoke = spokes_.data() + first_[v];
    const Index first = halfedges.outgoing(v);
    for (Index h = first; h != no_index;) {
      *spoke++ = {geometry.length(h), geometry.angle_at_tail(h), h, halfedges.to(h)};
      const Index incoming = TriangleMesh::prev(h);
      h = halfedges.twin(incoming);
      if (h == first) break;
      if (h == no_index) *spoke++ = {geometry.length(incoming), 0, no_index, halfedges.from(incoming)};
    }
  });
}

bool may_bend(bool on_boundary, double total_angle) {
  return total_angle > (on_boundary ? 1 : 2) * std::numbers::pi + angle_slack;
}

FanInterval fan_interval(double length, const Vec2& apex, double opposite_length, double low, double high) {
  const auto at_angle = [&](double angle) {
    return opposite_length * hit_fraction(Vec2(length, 0), apex, Vec2(std::cos(angle), std::sin(angle)));
  };
  return {low > 0 ? at_angle(low) : 0, high < infinity ? at_angle(high) : opposite_length};
}

}  // namespace isopath
