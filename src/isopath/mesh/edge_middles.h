#pragma once

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/mesh/surface_point.h"

namespace isopath {

/// Vertices in the middle of edges that are halved, made once for both sides of an edge.
class EdgeMiddles {
 public:
  /// The middle of an edge; `no_index` while nobody has halved it.
  Index find(Index a, Index b) const {
    const auto found = vertex_.find(key(a, b));
    return found == vertex_.end() ? no_index : found->second;
  }
  /// The same, made where there is none: added to the positions, with where it lies on the old mesh.
  Index make(Index a, Index b, const SurfacePoint& at, std::vector<Vec3>& positions,
             std::vector<SurfacePoint>& on_old) {
    const auto [found, fresh] = vertex_.try_emplace(key(a, b), static_cast<Index>(positions.size()));
    if (fresh) {
      const Vec3 middle = 0.5 * (positions[a] + positions[b]);
      positions.push_back(middle);
      on_old.push_back(at);
    }
    return found->second;
  }
  void clear() { vertex_.clear(); }

 private:
  static std::uint64_t key(Index a, Index b) {
    const auto [low, high] = std::minmax(a, b);
    return static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high);
  }
  std::unordered_map<std::uint64_t, Index> vertex_;
};

}  // namespace isopath
