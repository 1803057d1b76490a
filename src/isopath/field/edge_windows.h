#pragma once

#include <span>
#include <vector>

#include "isopath/field/window.h"

namespace isopath {

/// The windows of all edges: on each a list, sorted, without overlap, that holds the lower envelope of all fronts that
/// came by.
class EdgeWindows {
 public:
  /// `snap[e]` is the width below which an interval of edge e is nothing: it is given to its neighbour, never left
  /// open.
  EdgeWindows(std::vector<double> edge_length, std::vector<double> snap);

  /// Puts the parts of a window that are nearer than what the edge holds into the edge's list, and trims or removes
  /// what they beat. Returns the ids of the pieces put in; valid until the next call.
  std::span<const Index> insert(Index edge, const Window& window);

  Index first(Index edge) const { return head_[edge]; }
  const Window& operator[](Index id) const { return windows_[id]; }
  Window& operator[](Index id) { return windows_[id]; }
  std::size_t live() const { return windows_.size() - free_.size(); }

 private:
  struct Part {
    double begin;
    double end;
    Index id;  ///< window in the list, or `newcomer`
  };
  static constexpr Index newcomer = -2;

  Index allocate(const Window& window);
  void append(double begin, double end, Index id);
  void divide_overlap(const Window& old, Index old_id, const Window& window, double low, double high, double snap);
  void absorb_narrow_parts(double snap);
  void write_back(Index edge, Index before, Index after, const Window& window);

  std::vector<Window> windows_;
  std::vector<Index> free_;
  std::vector<Index> head_;
  std::vector<double> length_;
  std::vector<double> snap_;
  std::vector<Part> parts_;       // scratch of insert
  std::vector<Index> displaced_;  // scratch of insert
  std::vector<Index> inserted_;   // result of insert
};

}  // namespace isopath
