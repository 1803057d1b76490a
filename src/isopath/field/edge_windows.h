#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "isopath/field/window.h"

namespace isopath {

/// The windows of every edge, side by side in memory and in order along the edge. Edges themselves come in parts, in
/// whatever order is quickest for who fills them in.
class EdgeWindows {
 public:
  EdgeWindows() = default;
  /// No edge has any.
  EdgeWindows(Index n_edges, std::size_t n_parts) : places_(n_edges), parts_(n_parts) {}

  std::span<const Window> of(Index edge) const {
    const Place& place = places_[edge];
    return std::span(parts_[place.part]).subspan(place.first, place.count);
  }
  std::span<Window> of(Index edge) {
    const Place& place = places_[edge];
    return std::span(parts_[place.part]).subspan(place.first, place.count);
  }
  /// Calls visit(window) for those that reach into [low, high] of the edge.
  template <class Visit>
  void for_each(Index edge, double low, double high, Visit&& visit) const {
    const std::span<const Window> all = of(edge);
    std::size_t i = 0;
    std::size_t past = all.size();
    while (past - i > 8) {  // the first that ends behind `low`
      const std::size_t middle = i + (past - i) / 2;
      (all[middle].end < low ? i : past) = middle;
    }
    for (; i < all.size() && all[i].begin <= high; ++i) {
      if (all[i].end >= low) visit(all[i]);
    }
  }
  /// Of all edges.
  std::size_t size() const;

  /// Sets those of an edge, once. Different threads may set those of different edges in different parts.
  void add(std::size_t part, Index edge, std::span<const Window> windows);
  /// Gives memory back that a part will not need any more.
  void finish(std::size_t part) { parts_[part].shrink_to_fit(); }

 private:
  struct Place {
    std::uint32_t part = 0;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  std::vector<Place> places_;  ///< by edge
  std::vector<std::vector<Window>> parts_;
};

}  // namespace isopath
