#include "isopath/field/vertex_fan.h"

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

bool may_bend(const TriangleMesh& mesh, Index vertex, double total_angle) {
  return total_angle > (mesh.is_boundary_vertex(vertex) ? 1 : 2) * std::numbers::pi + angle_slack;
}

FanInterval fan_interval(const IntrinsicGeometry& geometry, Index outgoing, double low, double high) {
  const double length = geometry.length(TriangleMesh::next(outgoing));
  const auto at_angle = [&](double angle) {
    const Vec2 direction(std::cos(angle), std::sin(angle));
    return length * hit_fraction(Vec2(geometry.length(outgoing), 0), geometry.apex(outgoing), direction);
  };
  return {low > 0 ? at_angle(low) : 0, high < infinity ? at_angle(high) : length};
}

}  // namespace isopath
