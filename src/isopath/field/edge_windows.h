#pragma once

#include <memory>
#include <span>
#include <vector>

#include "isopath/field/window.h"
#include "isopath/field/window_merge.h"

namespace isopath {

/// Windows in blocks: ids stay valid, nothing is copied when it grows, freed ids are used again.
class WindowPool {
 public:
  Index allocate(const Window& window);
  void release(Index id) { free_.push_back(id); }
  /// Puts window `order[k]` at place k, for all k, and forgets the others.
  void reorder(std::vector<Index> order);

  const Window& operator[](Index id) const { return blocks_[id >> block_bits][id & block_mask]; }
  Window& operator[](Index id) { return blocks_[id >> block_bits][id & block_mask]; }
  std::size_t size() const { return static_cast<std::size_t>(size_) - free_.size(); }

 private:
  static constexpr int block_bits = 14;
  static constexpr Index block_mask = (1 << block_bits) - 1;
  std::vector<std::unique_ptr<Window[]>> blocks_;
  std::vector<Index> free_;
  Index size_ = 0;
};

/// The windows of all edges: on each a list, sorted, without overlap, that holds the lower envelope of all fronts that
/// came by.
class EdgeWindows {
 public:
  /// `snap[e]` is the width below which an interval of edge e is nothing: it is given to its neighbour, never left
  /// open.
  EdgeWindows(std::vector<double> edge_length, std::vector<double> snap, const MergeLimits& limits);

  /// Puts the parts of a window that are nearer than what the edge holds into the edge's list, and trims or removes
  /// what they beat. Returns the ids of the pieces to propagate or look at; valid until the next call.
  std::span<const Index> insert(Index edge, const Window& window);

  const Window& operator[](Index id) const { return pool_[id]; }
  Window& operator[](Index id) { return pool_[id]; }

  /// Hands over all windows, side by side edge after edge; edge e has those from first[e] up to first[e + 1]. Leaves
  /// nothing behind.
  WindowPool take(std::vector<Index>& first);

 private:
  struct Slot {
    double begin;  ///< of the window, for the search
    Index id;
  };
  struct Part {
    double begin;
    double end;
    Index id;  ///< window in the list, or `newcomer`
  };
  static constexpr Index newcomer = -2;

  void append(double begin, double end, Index id);
  void divide_overlap(Index old_id, const Window& window, double low, double high, double snap);
  void absorb_narrow_parts(double snap);
  void merge_neighbours();
  void write_back(std::vector<Slot>& list, std::size_t first, std::size_t last, const Window& window);

  WindowPool pool_;
  std::vector<std::vector<Slot>> lists_;
  std::vector<double> length_;
  std::vector<double> snap_;
  std::vector<Part> parts_;  // scratch of insert
  std::vector<Slot> slots_;  // scratch of insert
  MergeLimits limits_;
  std::vector<Index> inserted_;  // result of insert
};

}  // namespace isopath
