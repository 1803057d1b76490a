#pragma once

#include <utility>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

struct CoverGuardOptions {
  double reach = 0;        ///< nothing that is covered may come farther from the cover, mm
  double sample_size = 0;  ///< no place beside moving points is farther from a sample than this, mm
  double most_moved = 0;   ///< points are not moved farther than this from where they are, mm
};

/// Watches over what a curve covers while some of its points move: samples of the surface beside them are to stay in
/// reach of one of its segments, those that are out of reach no farther from it than they are. Distances are straight
/// ones, so that the last word is with a distance field.
class CoverGuard {
 public:
  /// The ends of a covering segment, as indices of points.
  using Segment = std::pair<Index, Index>;

  /// `movable` are the first points; each has at most one segment before and one behind it in `segments`.
  CoverGuard(const TriangleMesh& mesh, std::vector<Vec3> points, Index movable, std::vector<Segment> segments,
             const CoverGuardOptions& options, const Progress& progress);

  const Vec3& point(Index i) const { return points_[i]; }
  /// Moves a point unless that takes a sample out of reach. True when it moved.
  bool try_move(Index point, const Vec3& to);

 private:
  struct Sample {
    Vec3 position = Vec3::Zero();
    double limit = 0;
    Index witness = no_index;  ///< a segment within the limit
    Index block = no_index;
  };
  /// Samples that are near each other, and the segments near them.
  struct Block {
    Index first = 0;
    Index past = 0;
    std::vector<Index> segments;
  };

  /// One that is being made.
  struct WatchedBlock {
    std::vector<Index> segments;
    std::vector<Sample> samples;
    Index last_witness = no_index;
  };

  /// Adds a sample to the block, unless it is too near or too far for points that move to matter.
  void watch(const Vec3& place, WatchedBlock& block) const;
  void add_block(WatchedBlock block);
  double distance_to(Index segment, const Vec3& from) const;
  /// A segment other than two that has the sample in reach.
  Index other_witness(Index sample, Index a, Index b) const;

  std::vector<Vec3> points_;
  std::vector<Segment> segments_;
  CoverGuardOptions options_;
  std::vector<std::vector<Index>> segments_of_point_;  // of movable ones
  std::vector<Sample> samples_;
  std::vector<Block> blocks_;
  std::vector<std::vector<Index>> blocks_near_;  // of each segment that can move
  std::vector<std::pair<Index, Index>> pending_;
};

}  // namespace isopath
