#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "isopath/core/geometry.h"

namespace isopath {

/// Places sorted into boxes within boxes, to ask what is near.
class NearPlaces {
 public:
  explicit NearPlaces(std::span<const Vec3> places) : places_(places.begin(), places.end()) {
    if (!places_.empty()) divide(0, places_.size());
  }

  /// Whether one of them is within `radius`.
  bool any_near(const Vec3& p, double radius) const {
    if (boxes_.empty()) return false;
    std::array<std::size_t, most_depth + 1> open{};
    std::size_t n_open = 1;
    while (n_open > 0) {
      const std::size_t index = open[--n_open];
      const Box& box = boxes_[index];
      // squares of lengths just below the radius may come out above its square
      if (box.bounds.squaredExteriorDistance(p) > rounding * radius * radius) continue;
      if (box.right == 0) {
        for (std::size_t i = box.first; i < box.past; ++i) {
          if ((places_[i] - p).norm() <= radius) return true;
        }
        continue;
      }
      open[n_open++] = box.right;
      open[n_open++] = index + 1;
    }
    return false;
  }

 private:
  static constexpr std::size_t few = 4;
  static constexpr std::size_t most_depth = 64;  // halves of halves: no vector is as long as 2^64
  static constexpr double rounding = 1 + 1e-12;

  struct Box {
    Box3 bounds;
    std::size_t first = 0;
    std::size_t past = 0;
    std::size_t right = 0;  ///< the left one comes next; 0 where places are listed
  };

  void divide(std::size_t first, std::size_t past) {
    const std::size_t here = boxes_.size();
    Box& box = boxes_.emplace_back(Box{Box3(), first, past, 0});
    for (std::size_t i = first; i < past; ++i) box.bounds.extend(places_[i]);
    if (past - first <= few) return;
    int axis = 0;
    box.bounds.sizes().maxCoeff(&axis);
    const std::size_t middle = first + (past - first) / 2;
    const auto at = [&](std::size_t i) { return places_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(first), at(middle), at(past),
                     [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
    divide(first, middle);
    boxes_[here].right = boxes_.size();
    divide(middle, past);
  }

  std::vector<Vec3> places_;
  std::vector<Box> boxes_;
};

}  // namespace isopath
