#pragma once

#include <array>
#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/impact/ring.h"

namespace isopath {

/// A place on a ring, and how the ring runs there.
struct RingSample {
  Index ring = no_index;
  double arc = 0;
  Vec3 position = Vec3::Zero();
  double bend = 0;  ///< 0 where the ring is straight a spacing to either side, 1 where it turns back
};

/// A place where two rings face each other.
struct FacingPlace {
  std::array<Index, 2> ring = {no_index, no_index};
  std::array<double, 2> arc = {0, 0};
  double distance = 0;  ///< mm, in space
  double bend = 0;      ///< the larger of both
};

/// Samples of rings in a grid of cells, to find what lies near.
class RingSamples {
 public:
  /// Samples a quarter of a spacing apart.
  RingSamples(const std::vector<Ring>& rings, double spacing, Progress& progress);

  /// For every sample of the rings that `ask` marks, the nearest sample of every other ring of the same group within
  /// `radius`, in an order that depends on nothing else.
  std::vector<FacingPlace> facing(std::span<const char> ask, std::span<const Index> group, double radius,
                                  Progress& progress) const;
  /// True when a ring other than the two lies within `radius` of a place.
  bool other_ring_near(const Vec3& place, double radius, Index a, Index b) const;

 private:
  using Cell = std::array<Index, 3>;
  struct Grid {
    double size = 0;
    std::vector<std::pair<Cell, Index>> entries;  // sorted
  };
  Grid grid_of(double size) const;
  template <class Visit>
  void visit_near(const Grid& grid, const Vec3& place, double radius, const Visit& visit) const;

  std::vector<RingSample> samples_;
  Grid fine_;
};

}  // namespace isopath
