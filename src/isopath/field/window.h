#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "isopath/core/geometry.h"

namespace isopath {

/// An interval of an edge over which the distance is that of one front (Mitchell, Mount & Papadimitriou 1987): a circle
/// around an unfolded pseudo-source, or a straight front of parallel rays beside a source segment (Bommes & Kobbelt
/// 2007).
///
/// All coordinates are in the frame of the edge's canonical half-edge; the side the front comes from shows in the sign
/// of `source.y` (or of `direction.y`, reversed).
struct Window {
  enum class Kind : std::uint8_t { point, line };

  double begin = 0;  ///< interval along the edge
  double end = 0;
  Vec2 source = Vec2::Zero();  ///< point: unfolded pseudo-source. line: unit direction the front travels in
  double offset = 0;  ///< point: distance already travelled at the pseudo-source. line: distance at the edge's origin
  double error = 0;   ///< most that its distances are off, by merging windows on the way
  Index halfedge = no_index;  ///< the half-edge whose face the front enters; none when it goes no farther
  Index root = no_index;      ///< source element it comes from
  Kind kind = Kind::point;
  /// A path along the edge from its end, or the source on the edge itself. It goes no farther, and gives way to real
  /// fronts in a tie: it is there for points that are reached by a single ray, along the edge.
  bool filler = false;

  double distance(double x) const { return kind == Kind::point ? offset + radius(x) : offset + source.x() * x; }
  /// Distance of x from a point window's source. Coordinates are limited so that squares stay finite (see
  /// TriangleMesh).
  double radius(double x) const {
    const double dx = x - source.x();
    return std::sqrt(dx * dx + source.y() * source.y());
  }
  double min_distance() const {
    if (kind == Kind::point && source.x() > begin && source.x() < end) return offset + std::abs(source.y());
    return std::min(distance(begin), distance(end));
  }
  /// Sign of y where the front comes from; zero when it runs along the edge.
  int source_side() const {
    const double y = kind == Kind::point ? source.y() : -source.y();
    return (y > 0) - (y < 0);
  }
  /// Unit direction of travel at x on the edge (canonical frame); zero at the source itself.
  Vec2 direction(double x) const;

  /// The same window seen from the opposite half-edge of an edge of this length.
  Window flipped(double length) const;
};

/// At most two points in (low, high), ascending, between which one of two windows of an edge is the nearer. One of them
/// may be a root that squaring brought in, where they are not equally far: both its sides then have the same winner.
struct Ties {
  int count = 0;
  double x[2] = {0, 0};
};
Ties ties_between(const Window& a, const Window& b, double low, double high);

}  // namespace isopath
