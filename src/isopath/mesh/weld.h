#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "isopath/core/geometry.h"

namespace isopath {

/// Numbers points so that exactly equal ones share a number, in order of first appearance.
/// Zero and minus zero are equal; a NaN equals the same NaN. A hash table with open addressing.
class PointWelder {
 public:
  /// Room for this many distinct points without growing.
  explicit PointWelder(std::size_t expected = 0);

  /// Number of each of `points`, appended to what was welded before.
  void add(std::span<const Vec3> points, std::span<Index> numbers);

  const std::vector<Vec3>& points() const { return points_; }
  std::vector<Vec3> take_points() { return std::move(points_); }

 private:
  struct Slot {
    std::uint32_t tag = 0;
    Index point = no_index;
  };

  Index find_or_add(const Vec3& point, std::uint64_t hash);
  void grow();

  std::vector<Vec3> points_;
  std::vector<Slot> slots_;
  std::uint64_t mask_ = 0;
};

}  // namespace isopath
