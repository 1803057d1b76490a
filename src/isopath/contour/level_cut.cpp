#include "isopath/contour/level_cut.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "isopath/contour/edge_cut.h"
#include "isopath/contour/face_cut.h"

namespace isopath {

namespace {

// Work is dealt in blocks of fixed size and put together in their order, so that the number of threads cannot show.
constexpr Index block_size = 1024;

Index n_blocks(Index n) { return (n + block_size - 1) / block_size; }

void cut_edges(const TriangleMesh& mesh, const SurfaceFunction& function, LevelCut& cut, Progress& progress) {
  std::vector<std::vector<LevelCut::Crossing>> blocks(static_cast<std::size_t>(n_blocks(mesh.n_edges())));
  tbb::parallel_for(Index{0}, n_blocks(mesh.n_edges()), [&](Index block) {
    progress.checkpoint();
    EdgeCutter cutter(mesh, function, cut.levels);
    const Index end = std::min(mesh.n_edges(), (block + 1) * block_size);
    for (Index edge = block * block_size; edge < end; ++edge) cutter.cut(edge, blocks[block]);
  });
  cut.first_of_edge.assign(static_cast<std::size_t>(mesh.n_edges()) + 1, 0);
  for (const auto& block : blocks) {
    cut.crossings.insert(cut.crossings.end(), block.begin(), block.end());
    for (const LevelCut::Crossing& crossing : block) ++cut.first_of_edge[crossing.edge + 1];
  }
  for (Index edge = 0; edge < mesh.n_edges(); ++edge) cut.first_of_edge[edge + 1] += cut.first_of_edge[edge];
}

/// Cuts one face after the other, level by level.
class FaceWalker {
 public:
  FaceWalker(const TriangleMesh& mesh, const SurfaceFunction& function, const LevelCut& cut, double chord_tolerance)
      : mesh_(mesh),
        function_(function),
        cut_(cut),
        linear_(function.linear_in_faces()),
        cutter_(mesh, function, chord_tolerance) {}

  void cut(Index face, FaceCutter::Output& out) {
    if (LevelCut::is_unreached(mesh_, function_, face)) return;
    gather(face);
    if (events_.empty() && linear_) return;
    cutter_.start(face);
    auto [first, last] = cutter_.levels_inside(cut_.levels);
    if (!events_.empty()) {
      if (first == last) first = last = lowest_;
      first = std::min(first, lowest_);
      last = std::max(last, lowest_ + static_cast<Index>(begin_.size()) - 1);
    }
    for (Index level = first; level < last; ++level) {
      const Index i = level - lowest_;
      const bool crosses = i >= 0 && i + 1 < static_cast<Index>(begin_.size());
      const auto events = crosses ? std::span(sorted_).subspan(begin_[i], begin_[i + 1] - begin_[i])
                                  : std::span<const FaceCutter::Event>();
      cutter_.cut(level, cut_.levels[level], events, out);
    }
  }

 private:
  /// Collects the crossings around the face and sorts them by level, keeping their order around it.
  void gather(Index face) {
    events_.clear();
    begin_.assign(1, 0);
    lowest_ = 0;
    for (int side = 0; side < 3; ++side) add_side(3 * face + side, side);
    if (events_.empty()) return;
    const auto [low, high] = std::minmax_element(events_.begin(), events_.end(),
                                                 [](const auto& a, const auto& b) { return a.level < b.level; });
    lowest_ = low->level;
    // Around a face every level between the lowest and the highest is crossed, so counting costs no more than sorting.
    begin_.assign(static_cast<std::size_t>(high->level - lowest_) + 2, 0);
    for (const auto& event : events_) ++begin_[event.level - lowest_ + 1];
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    sorted_.resize(events_.size());
    next_.assign(begin_.begin(), begin_.end() - 1);
    for (const auto& event : events_) sorted_[next_[event.level - lowest_]++] = event;
  }

  void add_side(Index halfedge, int side) {
    const Index edge = mesh_.edge_of(halfedge);
    const Index first = cut_.first_of_edge[edge];
    const Index n = cut_.first_of_edge[edge + 1] - first;
    const bool canonical = mesh_.halfedge_of(edge) == halfedge;
    for (Index k = 0; k < n; ++k) {
      const Index crossing = canonical ? first + k : first + n - 1 - k;
      const double t = cut_.crossings[crossing].parameter;
      events_.push_back({crossing, cut_.crossings[crossing].level, side, canonical ? t : 1 - t});
    }
  }

  const TriangleMesh& mesh_;
  const SurfaceFunction& function_;
  const LevelCut& cut_;
  bool linear_;
  FaceCutter cutter_;
  std::vector<FaceCutter::Event> events_;
  std::vector<FaceCutter::Event> sorted_;
  Index lowest_ = 0;
  std::vector<std::size_t> begin_;  // in sorted_, of each level from lowest_, and the end
  std::vector<std::size_t> next_;
};

void cut_faces(const TriangleMesh& mesh, const SurfaceFunction& function, double chord_tolerance, LevelCut& cut,
               Progress& progress) {
  std::vector<FaceCutter::Output> blocks(static_cast<std::size_t>(n_blocks(mesh.n_faces())));
  tbb::parallel_for(Index{0}, n_blocks(mesh.n_faces()), [&](Index block) {
    FaceWalker walker(mesh, function, cut, chord_tolerance);
    const Index end = std::min(mesh.n_faces(), (block + 1) * block_size);
    for (Index face = block * block_size; face < end; ++face) {
      if (face % 64 == 0) progress.checkpoint();
      walker.cut(face, blocks[block]);
    }
  });
  for (const FaceCutter::Output& block : blocks) {
    const auto offset = static_cast<Index>(cut.points.size());
    for (LevelCut::Piece piece : block.pieces) {
      piece.first_point += offset;
      cut.pieces.push_back(piece);
    }
    cut.points.insert(cut.points.end(), block.points.begin(), block.points.end());
  }
}

}  // namespace

bool LevelCut::is_unreached(const TriangleMesh& mesh, const SurfaceFunction& function, Index face) {
  const Triangle& corners = mesh.triangle(face);
  return !std::all_of(corners.begin(), corners.end(),
                      [&](Index vertex) { return std::isfinite(function.value_at_vertex(vertex)); });
}

LevelCut cut_levels(const TriangleMesh& mesh, const SurfaceFunction& function, std::span<const double> levels,
                    double chord_tolerance, Progress& progress) {
  LevelCut cut;
  cut.levels.assign(levels.begin(), levels.end());
  cut_edges(mesh, function, cut, progress);
  cut_faces(mesh, function, chord_tolerance, cut, progress);
  return cut;
}

}  // namespace isopath
