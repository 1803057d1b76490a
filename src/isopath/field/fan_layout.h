#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "isopath/field/large_pages.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// An edge from the vertex in the middle of a fan, and the face between it and the next edge counter-clockwise.
struct FanSpoke {
  std::uint32_t end;  ///< the vertex at its other end
  float length;
  float cosine;  ///< of the face's angle in the middle
  float sine;
};

/// The faces around every vertex as a fan of spokes, one fan after the other in memory and in single precision: all
/// that a front needs to step from a vertex on. Four spokes may be read at a time, past the end of a fan, too. Lengths
/// are divided by `unit`, a power of two near the mean edge length, so that single precision serves every scale and
/// scaling by powers of two rounds nothing.
class FanLayout {
 public:
  explicit FanLayout(const TriangleMesh& mesh);

  struct Fan {
    std::span<const FanSpoke> spokes;  ///< one more than faces: in a closed fan the first comes again at the end
    bool closed;                       ///< false where the vertex lies on the boundary
    bool bends;  ///< a saddle or a reflex corner of the boundary by more than a little: shortest ways may bend here
    bool bends_sharply;  ///< by so much that a strongly curved front may start here
  };
  Fan fan(std::uint32_t vertex) const {
    const Head& head = heads_[vertex];
    const std::uint32_t first = head.first;
    return {{spokes_.data() + first, heads_[vertex + 1].first - first}, head.closed, head.bends, head.bends_sharply};
  }
  bool bends(std::uint32_t vertex) const { return heads_[vertex].bends; }
  /// Fetches a fan into the cache ahead of its use.
  void prefetch(std::uint32_t vertex) const {
    const FanSpoke* first = spokes_.data() + heads_[vertex].first;
    __builtin_prefetch(first);
    __builtin_prefetch(first + 4);
    __builtin_prefetch(first + 6);
  }
  void prefetch_head(std::uint32_t vertex) const { __builtin_prefetch(&heads_[vertex]); }

  double unit() const { return unit_; }
  /// Spokes of the largest fan, with the one that comes again.
  std::size_t most_spokes() const { return most_spokes_; }

 private:
  struct Head {
    std::uint32_t first;
    bool closed;
    bool bends;
    bool bends_sharply;
  };

  std::uint32_t find_ends(const TriangleMesh& mesh, Index vertex, std::uint32_t n_spokes, std::size_t n_beside,
                          std::vector<float>& beside);
  void close(Index vertex, const float* angles);

  double unit_ = 1;
  std::size_t most_spokes_ = 0;
  LargeVector<Head> heads_;
  LargeVector<FanSpoke> spokes_;
};

}  // namespace isopath
