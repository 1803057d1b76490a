#pragma once

#include <numeric>
#include <utility>
#include <vector>

#include "isopath/core/geometry.h"

namespace isopath {

/// Union-find over 0 … n-1. The root of a set is its lowest member, so that results do not depend on the order of
/// joining.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

  Index root(Index i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }

  /// True when the two were apart.
  bool join(Index a, Index b) {
    a = root(a);
    b = root(b);
    if (a == b) return false;
    if (b < a) std::swap(a, b);
    parent_[b] = a;
    return true;
  }

  /// One more member, alone.
  void append() { parent_.push_back(static_cast<Index>(parent_.size())); }

 private:
  std::vector<Index> parent_;
};

}  // namespace isopath
