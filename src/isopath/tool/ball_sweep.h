#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "isopath/core/geometry.h"

namespace isopath {

/// The space that a ball passes through when its centre runs along polylines.
class BallSweep {
 public:
  /// A straight piece of the centre's way.
  struct Segment {
    Vec3 a;
    Vec3 b;
  };

  /// Segments must not be longer than `cell`, which should be about the distance that queries reach.
  BallSweep(std::vector<Segment> segments, double radius, double cell);

  double radius() const { return radius_; }

  /// The segments that may come within `reach` of a place.
  void near(const Vec3& place, double reach, std::vector<Segment>& out) const;

  /// How far one has to go from p along the unit vector n to get into one of the balls that are centred on the
  /// segments; negative where p is inside. Infinite when no such ball is met.
  double height(const Vec3& p, const Vec3& n, const std::vector<Segment>& segments) const;

 private:
  std::int64_t cell_of(double coordinate) const;
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z);

  std::vector<Segment> segments_;  ///< ordered by the cell that their middle lies in
  std::vector<std::uint64_t> keys_;
  double radius_;
  double cell_;
};

}  // namespace isopath
