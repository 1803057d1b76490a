#pragma once

#include <span>
#include <vector>

#include "isopath/contour/level_cut.h"

namespace isopath {

/// Finds the crossings of all levels with one edge at a time, in a consistent order. Keeps its buffers between edges.
class EdgeCutter {
 public:
  EdgeCutter(const TriangleMesh& mesh, const SurfaceFunction& function, std::span<const double> levels)
      : mesh_(mesh), function_(function), levels_(levels), max_slope_(function.max_slope()) {}

  /// Appends the crossings of this edge. Throws Error(internal) when their parity contradicts the edge's ends.
  void cut(Index edge, std::vector<LevelCut::Crossing>& out);

 private:
  void collect(Index edge, double from, double to);
  bool pending(Index level) const;
  double next_of(Index level) const { return parameters_[cursor_[level - first_level_]]; }

  const TriangleMesh& mesh_;
  const SurfaceFunction& function_;
  std::span<const double> levels_;
  double max_slope_;
  Index first_level_ = 0;
  std::vector<double> parameters_;   // of all levels, level by level
  std::vector<std::size_t> begin_;   // of each level from first_level_, and the end
  std::vector<std::size_t> cursor_;  // first crossing of each level that is not yet passed
};

}  // namespace isopath
