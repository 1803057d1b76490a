#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/core/progress.h"

namespace isopath {

struct ExactFieldData;

/// A window on an edge of a face, or a source in the face.
class NearCandidate {
 public:
  static constexpr unsigned in_face = 3;
  NearCandidate(unsigned where, std::size_t number) : code_(static_cast<std::uint32_t>(4 * number + where)) {}
  unsigned where() const { return code_ & 3U; }        ///< corner index of the edge's tail, or `in_face`
  std::uint32_t number() const { return code_ >> 2; }  ///< among the edge's windows, or the face's sources

 private:
  std::uint32_t code_;
};

/// Faces that many windows or sources concern, divided into parts in which few of them can be nearest.
///
/// Distances have slope 1, and so has the way by each window and to each source. What is farther than the nearest one
/// at the centre of a part by more than twice the part's radius is nearest nowhere in it. Fronts that leave the face by
/// an edge are not among the candidates: points on edges are to be asked otherwise.
class FaceTrees {
 public:
  FaceTrees() = default;
  /// For a field whose windows and sources are known. Throws Error(cancelled) on request.
  FaceTrees(const ExactFieldData& data, const Progress& progress);

  struct Part {
    std::span<const NearCandidate> candidates;  ///< sources first, then edge by edge; corners always count
    double bound = 0;                           ///< nothing that was left out gives as little anywhere in the part
  };
  /// The part around a point in the frame of half-edge 3·face; none where the face is not divided.
  std::optional<Part> part_at(Index face, const Vec2& p) const;

  /// Halved where p · normal is one side or the other of `offset`; or, where `normal` is zero, a part whose bound that
  /// is, with a range of candidates.
  struct Node {
    Vec2 normal = Vec2::Zero();
    double offset = 0;
    std::uint32_t first = 0;  ///< the side above the offset; or of the candidates
    std::uint32_t second = 0;
  };

 private:
  std::vector<Index> tree_;  ///< per face: its tree; empty where no face has one
  std::vector<std::vector<Node>> nodes_;
  std::vector<std::vector<NearCandidate>> candidates_;
};

}  // namespace isopath
