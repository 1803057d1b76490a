#pragma once

#include <vector>

#include "isopath/field/window.h"
#include "isopath/field/window_merge.h"

namespace isopath {

/// The ways along an edge of this length from a place on it that is at this distance.
Window along_edge(double place, double length, double distance, double error, Index root);

/// The windows of one edge: sorted, without overlap, the lower envelope of all fronts that come by.
class EdgeEnvelope {
 public:
  /// Begins with an empty edge. `snap` is the width below which an interval is nothing: it is given to its neighbour,
  /// never left open.
  void reset(double length, double snap);

  /// Puts in the parts of a window, in the frame of the canonical half-edge, that are nearer than what is there, and
  /// trims or removes what they beat.
  void insert(const Window& window);

  /// True when the windows cover the edge and their distances run on without a jump from the one at its tail to
  /// the one at its head. Then no path along the edge is shorter than they are, since none of them grows faster.
  bool is_continuous(double at_tail, double at_head) const;

  /// Closes what rounding tore open: where the distance jumps, the nearer side goes on. Across a hair between two
  /// windows that agree on both of its sides each of them goes on as it is; elsewhere the way along the edge does.
  void close_jumps();

  /// Merges neighbours that enter the same face as long as the limits allow it.
  void merge(const MergeLimits& limits);

  const std::vector<Window>& windows() const { return windows_; }
  std::vector<Window>& windows() { return windows_; }

 private:
  struct Part {
    double begin;
    double end;
    Index old;  ///< window that was there, or `newcomer`
  };
  static constexpr Index newcomer = -2;

  double least_width(const Window& window) const;
  /// True when a part of a window of this width is nothing.
  bool is_narrow(const Window& window, double width) const;
  /// True for a window below the snap width, which is there for the many directions that pass it: on the edge itself
  /// others are as near.
  bool is_pinhole(const Window& window) const;
  bool jumps(const Window& left, const Window& right, double x) const;
  void append(double begin, double end, Index old);
  void divide_overlap(Index old, const Window& window, double low, double high);
  /// The same where one of the two is a filler, which has to be nearer by a margin.
  void divide_by_margin(Index old, const Window& window, double low, double high);
  void absorb_narrow_parts(const Window& window);
  void write_back(std::size_t first, std::size_t past, const Window& window);

  double length_ = 0;
  double snap_ = 0;
  std::vector<Window> windows_;
  std::vector<Part> parts_;       // scratch of insert
  std::vector<Window> replaced_;  // scratch of insert
  std::vector<Window> closing_;   // scratch of close_jumps
};

}  // namespace isopath
