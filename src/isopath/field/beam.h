#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

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

/// From the start of a segment to its end. Where all sources are points, nothing.
template <bool with_segments>
struct Extent {
  FlatPoint along;
};
template <>
struct Extent<false> {};

/// What a beam waits for in the queue: to be brought on, or only to look whether ways bend at the half-edge's ends.
enum class Errand : std::uint8_t { none, bend, spread };

/// The light that enters a face through a half-edge, in the half-edge's frame: its source, unfolded into the face's
/// plane, and the part of the half-edge that it goes through.
template <bool with_segments>
struct Beam : Extent<with_segments> {
  FlatPoint start;  ///< of the source; never above the half-edge
  float bent;       ///< way from the root to the source, which is a vertex where the way bends; 0 for a root itself
  float value;      ///< length of the way to the apex through the lit part
  float low;        ///< the lit part of the half-edge
  float high;
  std::uint32_t source;  ///< the vertex, or n_vertices + the element, that the source is
  Errand errand;
};

/// How the apex of a half-edge's face sees the source of a beam.
struct Sight {
  float straight;  ///< length of the straight way, whether or not it goes through the lit part
  float crossing;  ///< where it crosses the half-edge's line
};

/// The point of the source that is nearest.
template <bool with_segments>
[[gnu::always_inline]] inline FlatPoint nearest(const Beam<with_segments>& beam, FlatPoint to) {
  if constexpr (with_segments) {
    const float squared = dot(beam.along, beam.along);
    if (squared > 0) {
      const float t = std::clamp(dot(to - beam.start, beam.along) / squared, 0.0F, 1.0F);
      return {beam.start.x + t * beam.along.x, beam.start.y + t * beam.along.y};
    }
  }
  return beam.start;
}

template <bool with_segments>
[[gnu::always_inline]] inline Sight sight(const Beam<with_segments>& beam, FlatPoint apex) {
  const FlatPoint from = nearest(beam, apex);
  const float rise = apex.y - from.y;
  return {beam.bent + norm(apex - from), rise > 0 ? cross(from, apex) / rise : apex.x};
}

/// Length of the way of a beam to the apex: straight where that goes through the lit part or misses it by no more than
/// `slack`, else round the end of it.
template <bool with_segments>
[[gnu::always_inline]] inline float way_to(const Beam<with_segments>& beam, FlatPoint apex, const Sight& seen,
                                           float slack) {
  if (seen.crossing >= beam.low - slack && seen.crossing <= beam.high + slack) return seen.straight;
  const FlatPoint clip{seen.crossing < beam.low ? beam.low : beam.high, 0};
  return beam.bent + norm(clip - nearest(beam, clip)) + norm(apex - clip);
}

/// The same source seen from the frame with origin at `origin` and the x axis along the unit vector `u`; what belongs
/// to the half-edge is to be filled in.
template <bool with_segments>
[[gnu::always_inline]] inline Beam<with_segments> in_frame(const Beam<with_segments>& beam, FlatPoint origin,
                                                           FlatPoint u) {
  Beam<with_segments> next;
  const FlatPoint start = beam.start - origin;
  next.start = {dot(u, start), std::min(cross(u, start), 0.0F)};
  if constexpr (with_segments) next.along = {dot(u, beam.along), cross(u, beam.along)};
  next.bent = beam.bent;
  next.source = beam.source;
  return next;
}

/// Turns the source of a beam about one end of its half-edge so that its distance from the other end becomes as given,
/// to first order. Leaves it where that takes more than a small angle.
template <bool with_segments>
void turn(Beam<with_segments>& beam, FlatPoint pivot, FlatPoint end, float distance_wanted) {
  constexpr float most = 0.3F;
  constexpr float noise = 4e-6F;  // of single precision
  const FlatPoint from = nearest(beam, end);
  const float distance = norm(end - from);
  const float lever = from.y * (end.x - pivot.x);
  const float needed = (distance_wanted - distance) * distance;
  if (std::abs(needed) <= noise * distance * distance || !(std::abs(needed) < most * std::abs(lever))) return;
  const float half = 0.5F * needed / lever;  // half the angle, or its tangent, as it is small
  const float scale = 1 / (1 + half * half);
  const FlatPoint u{(1 - half * half) * scale, 2 * half * scale};
  const FlatPoint arm = beam.start - pivot;
  beam.start = {pivot.x + u.x * arm.x - u.y * arm.y, std::min(u.x * arm.y + u.y * arm.x, 0.0F)};
  if constexpr (with_segments) {
    beam.along = {u.x * beam.along.x - u.y * beam.along.y, u.x * beam.along.y + u.y * beam.along.x};
  }
}

}  // namespace isopath
