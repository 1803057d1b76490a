#include "isopath/contour/chain.h"

#include <utility>

namespace isopath {

namespace {

class Chainer {
 public:
  Chainer(const TriangleMesh& mesh, const LevelCut& cut) : mesh_(mesh), cut_(cut) {
    leaving_.assign(cut.crossings.size(), no_index);
    arriving_.assign(cut.crossings.size(), no_index);
    for (Index piece = 0; piece < static_cast<Index>(cut.pieces.size()); ++piece) {
      if (cut.pieces[piece].is_loop()) continue;
      leaving_[cut.pieces[piece].from] = piece;
      arriving_[cut.pieces[piece].to] = piece;
    }
    chains_.contour_of_piece.assign(cut.pieces.size(), no_index);
    visited_.assign(cut.pieces.size(), false);
  }

  Chains run() {
    for (const Index start : starts_by_level()) {
      if (!visited_[start]) follow(start);
    }
    return std::move(chains_);
  }

 private:
  /// Where contours may start, by level; within a level first the open ones, then the closed ones, then loops.
  std::vector<Index> starts_by_level() const {
    const std::size_t n_levels = cut_.levels.size();
    std::vector<std::size_t> next(3 * n_levels + 1, 0);
    const auto bucket = [&](Index piece) {
      const LevelCut::Piece& p = cut_.pieces[piece];
      const std::size_t rank = p.is_loop() ? 2 : arriving_[p.from] == no_index ? 0 : 1;
      return 3 * static_cast<std::size_t>(p.level) + rank;
    };
    const auto n = static_cast<Index>(cut_.pieces.size());
    for (Index piece = 0; piece < n; ++piece) ++next[bucket(piece) + 1];
    for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
    std::vector<Index> starts(cut_.pieces.size());
    for (Index piece = 0; piece < n; ++piece) starts[next[bucket(piece)]++] = piece;
    return starts;
  }

  void follow(Index first) {
    Contour contour;
    contour.level = cut_.levels[cut_.pieces[first].level];
    members_.clear();
    Index piece = first;
    while (piece != no_index && !visited_[piece]) {
      visited_[piece] = true;
      members_.push_back(piece);
      const LevelCut::Piece& p = cut_.pieces[piece];
      if (!p.is_loop()) add(contour, cut_.point_of(mesh_, p.from));
      for (const SurfacePoint& point : cut_.points_of(p)) add(contour, point);
      if (p.is_loop()) break;
      piece = leaving_[p.to];
    }
    contour.closed = cut_.pieces[first].is_loop() || piece == first;
    if (!contour.closed) add(contour, cut_.point_of(mesh_, cut_.pieces[members_.back()].to));
    while (contour.closed && contour.points.size() > 1 && same(contour.points.back(), contour.points.front())) {
      contour.points.pop_back();
    }
    if (length_of(mesh_, contour) <= mesh_.tolerance().length) return;
    for (const Index member : members_) {
      chains_.contour_of_piece[member] = static_cast<Index>(chains_.contours.size());
    }
    chains_.some_piece_of.push_back(first);
    chains_.contours.push_back(std::move(contour));
  }

  void add(Contour& contour, const SurfacePoint& point) const {
    if (contour.points.empty() || !same(contour.points.back(), point)) contour.points.push_back(point);
  }

  bool same(const SurfacePoint& a, const SurfacePoint& b) const {
    if (a.face == b.face && a.barycentric == b.barycentric) return true;
    const Support at_a = support_of(mesh_, a);
    const Support at_b = support_of(mesh_, b);
    return at_a.kind == Support::Kind::vertex && at_b.kind == Support::Kind::vertex && at_a.index == at_b.index;
  }

  const TriangleMesh& mesh_;
  const LevelCut& cut_;
  std::vector<Index> leaving_;   // piece that starts at each crossing
  std::vector<Index> arriving_;  // piece that ends at each crossing
  std::vector<bool> visited_;
  std::vector<Index> members_;
  Chains chains_;
};

}  // namespace

Chains chain_pieces(const TriangleMesh& mesh, const LevelCut& cut) { return Chainer(mesh, cut).run(); }

}  // namespace isopath
