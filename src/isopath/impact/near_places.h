#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "isopath/core/geometry.h"

namespace isopath {

/// Places in a grid of cells, to ask what is near.
class NearPlaces {
 public:
  /// For questions with a radius of at most `reach`.
  NearPlaces(std::span<const Vec3> places, double reach) : reach_(reach) {
    for (const Vec3& p : places) places_.emplace_back(cell_of(p), p);
    std::sort(places_.begin(), places_.end(), before);
  }

  /// Whether one of them is within `radius`.
  bool any_near(const Vec3& p, double radius) const {
    const Cell at = cell_of(p);
    for (Index x = at[0] - 1; x <= at[0] + 1; ++x) {
      for (Index y = at[1] - 1; y <= at[1] + 1; ++y) {
        const Cell last{x, y, at[2] + 1};
        for (auto e = std::lower_bound(places_.begin(), places_.end(), Place{{x, y, at[2] - 1}, Vec3::Zero()}, before);
             e != places_.end() && e->first <= last; ++e) {
          if ((e->second - p).norm() <= radius) return true;
        }
      }
    }
    return false;
  }

 private:
  using Cell = std::array<Index, 3>;
  using Place = std::pair<Cell, Vec3>;
  static bool before(const Place& a, const Place& b) { return a.first < b.first; }
  Cell cell_of(const Vec3& p) const {
    return {static_cast<Index>(std::floor(p.x() / reach_)), static_cast<Index>(std::floor(p.y() / reach_)),
            static_cast<Index>(std::floor(p.z() / reach_))};
  }

  double reach_;
  std::vector<Place> places_;
};

}  // namespace isopath
