#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace isopath {

/// A point of the plane in single precision.
struct FlatPoint {
  float x;
  float y;
};
inline FlatPoint operator-(FlatPoint a, FlatPoint b) { return {a.x - b.x, a.y - b.y}; }
inline float dot(FlatPoint a, FlatPoint b) { return a.x * b.x + a.y * b.y; }
inline float cross(FlatPoint a, FlatPoint b) { return a.x * b.y - a.y * b.x; }
inline float norm(FlatPoint a) { return std::sqrt(dot(a, a)); }

/// In place of the way that lies behind a centre, for fronts from segments, which have none.
constexpr float no_centre = -std::numeric_limits<float>::infinity();

/// What is known of the shortest way to a vertex.
struct Arrival {
  float distance = std::numeric_limits<float>::infinity();
  float bent = no_centre;    ///< the part of it before the centre of the front: the way to where it bent last
  std::uint32_t source = 0;  ///< tells centres apart
  std::uint32_t root = 0;    ///< tells apart what fronts may meet; with the user's marks in its lowest three bits
};

/// A front between two vertices that it has reached, in the plane that the faces on both sides of the edge unfold into:
/// a circle about a centre that fits both distances, or a straight line. It lies behind the edge and comes towards
/// y > 0.
struct EdgeFront {
  FlatPoint at;  ///< the centre, in the frame of the edge; the direction of travel where the front is straight
  float way;     ///< behind the centre; to the tail where the front is straight
  bool straight;

  FlatPoint ray_to(FlatPoint point) const { return straight ? at : point - at; }
  float distance_of(FlatPoint point, FlatPoint ray) const { return straight ? way + dot(at, point) : way + norm(ray); }
};

/// The front between the vertices at 0 and at `length` of an edge. Where the distances do not fit one, or both ends
/// belong to a source, its numbers are not finite and compare to nothing.
///
/// Two centres on one edge belong to fronts that run side by side, one of them perhaps in the shadow of the other. The
/// longer radius is the cautious choice: between its ends a flatter front arrives later.
[[gnu::always_inline]] inline EdgeFront fit_front(const Arrival& tail, const Arrival& head, float length) {
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  const float bent = std::min(tail.bent, head.bent);
  const bool two_roots = tail.source != head.source && std::max(tail.bent, head.bent) == 0 && bent == 0 &&
                         tail.distance > 0 && head.distance > 0;
  if (bent == no_centre || two_roots) {
    const float slope = (head.distance - tail.distance) / length;
    const float squared = 1 - slope * slope;
    const bool fits = squared > 0 && std::max(tail.distance, head.distance) > 0;
    return {{slope, fits ? std::sqrt(squared) : none}, tail.distance, true};
  }
  const float to_tail = tail.distance - bent;
  const float to_head = head.distance - bent;
  const float x = 0.5F * ((to_tail - to_head) * (to_tail + to_head) * (1 / length) + length);
  const float squared = (to_tail - x) * (to_tail + x);
  return {{x, squared >= 0 ? -std::sqrt(squared) : none}, bent, false};
}

}  // namespace isopath
