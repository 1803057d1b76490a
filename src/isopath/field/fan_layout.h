#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "isopath/field/edge_front.h"
#include "isopath/field/large_pages.h"
#include "isopath/field/local_halfedges.h"
#include "isopath/mesh/local_numbering.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// The neighbours of every vertex in order around it, one ring after the other in memory. Lengths and angles are worked
/// out from the positions when a front comes: that takes less time than to write them all down and to wait for them
/// later. Vertices have numbers of its own where those of the mesh lie in no order. The mesh must outlive it.
class FanLayout {
 public:
  explicit FanLayout(const TriangleMesh& mesh);
  FanLayout(const FanLayout&) = delete;
  FanLayout& operator=(const FanLayout&) = delete;

  std::uint32_t vertex_here(Index in_mesh) const { return static_cast<std::uint32_t>(numbering_.vertex_here(in_mesh)); }
  /// In a closed ring the first neighbour comes again at the end; empty where no face uses the vertex.
  std::span<const std::uint32_t> ring(std::uint32_t vertex) const {
    return {ends_.data() + first_[vertex], first_[vertex + 1] - first_[vertex]};
  }
  const Vec3& position(std::uint32_t vertex) const { return positions_[vertex]; }

  /// Three steps to fetch into the cache what a fan is worked out from, each to be taken well after the one before.
  void prefetch_head(std::uint32_t vertex) const { __builtin_prefetch(&first_[vertex]); }
  void prefetch_ring(std::uint32_t vertex) const {
    const std::uint32_t* const ends = ends_.data() + first_[vertex];
    __builtin_prefetch(ends);
    __builtin_prefetch(ends + usual_ring);
  }
  void prefetch_positions(std::uint32_t vertex) const {
    const std::uint32_t* const ends = ends_.data() + first_[vertex];
    for (std::size_t i = 0; i < usual_ring; ++i) __builtin_prefetch(&positions_[ends[i]]);
  }

  /// Lengths are divided by this power of two near the mean edge length, so that single precision serves every scale
  /// and scaling by powers of two rounds nothing.
  double unit() const { return unit_; }
  /// Neighbours in the largest ring, with the one that comes again.
  std::size_t most_spokes() const { return most_spokes_; }

 private:
  static constexpr std::size_t usual_ring = 6;

  void lay_out_rings(const LocalHalfedges& halfedges);

  LocalNumbering numbering_;
  LargeVector<Vec3> own_positions_;  ///< where vertices are numbered anew
  const Vec3* positions_;
  double unit_ = 1;
  std::size_t most_spokes_ = 0;
  LargeVector<std::uint32_t> first_;  ///< of each vertex's ring
  LargeVector<std::uint32_t> ends_;
};

/// A fan of faces around a vertex in single precision: for each spoke the vertex at its end and its length, and for the
/// face between it and the next one counter-clockwise the angle in the middle. In a closed fan the first spoke comes
/// again at the end. Four numbers may be read at a time, past the last one, too.
struct Fan {
  const std::uint32_t* ends = nullptr;
  std::size_t n_spokes = 0;  ///< one more than faces; 0 where no face uses the vertex
  bool closed = false;       ///< false where the vertex lies on the boundary
  /// A saddle or a reflex corner of the boundary by more than a little: shortest ways may bend here.
  bool bends = false;
  /// By so much that a strongly curved front may start here.
  bool bends_sharply = false;
  const float* length = nullptr;
  const float* next_length = nullptr;  ///< of the next spoke
  const float* cosine = nullptr;
  const float* sine = nullptr;
};

/// The fans of a few vertices, worked out one right after the other: each is a chain of roots and divisions, and the
/// processor begins the next while it waits for one.
class FanBatch {
 public:
  static constexpr std::size_t most_fans = 16;

  explicit FanBatch(const FanLayout& layout);

  void clear() { n_fans_ = n_numbers_ = 0; }
  bool full() const { return n_fans_ == most_fans || n_numbers_ + most_numbers_ > numbers_.size(); }
  /// Works out one more fan, and fetches into the cache what is known of its ends. Not where it is full.
  void add(std::uint32_t vertex, const Arrival* arrivals);
  const Fan& operator[](std::size_t i) const { return fans_[i]; }

 private:
  const FanLayout& layout_;
  std::size_t most_numbers_;  ///< of one fan
  std::size_t n_fans_ = 0;
  std::size_t n_numbers_ = 0;
  std::array<Fan, most_fans> fans_;
  LargeVector<float> numbers_;
};

}  // namespace isopath
