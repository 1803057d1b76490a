#include "isopath/impact/taut_curve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "isopath/impact/cover_guard.h"
#include "isopath/impact/walked_stretch.h"

namespace isopath {
namespace {

// all of these in spacings
constexpr double step_between_points = 0.05;
constexpr double least_turn_radius = 0.75;  ///< what turns more gently has nothing to give
constexpr double legs_of_turn = 0.6;
constexpr double sample_size = 0.02;
constexpr double most_moved = 0.12;
constexpr double least_move = 5e-4;

constexpr int most_sweeps_over_band = 60;
/// What one band gives up, its neighbours may need.
constexpr int rounds_over_bands = 2;
/// Points stand for arcs, whose radius is a little less than that of the circle through them.
constexpr double drawn_over_least_radius = 1.1;

/// A stretch of one run that is drawn tight, with points a step apart.
struct Band {
  std::size_t run = 0;
  double from = 0;
  double to = 0;
  std::vector<CurveNode> nodes;
  Index first_point = 0;  ///< the guard's number of the first node
  bool moved = false;
};

class TautDrawer {
 public:
  TautDrawer(const SurfaceLinker& linker, const ImpactCurve& curve, const TautLimits& limits, const Progress& progress)
      : linker_(linker), mesh_(linker.mesh()), limits_(limits), progress_(progress) {
    for (const auto& [first, end] : runs_on_surface(curve)) runs_.emplace_back(mesh_, nodes_of(curve, first, end));
    for (std::size_t r = 0; r < runs_.size(); ++r) find_bands(r);
  }

  std::vector<std::vector<CurveNode>> run(std::vector<Vec3>& moved) {
    CoverGuard guard = watch();
    for (int round = 0; round < rounds_over_bands; ++round) {
      for (Band& band : bands_) draw(band, guard);
    }
    std::vector<std::vector<CurveNode>> runs;
    std::size_t next = 0;
    for (std::size_t r = 0; r < runs_.size(); ++r) runs.push_back(with_bands(r, next, moved));
    return runs;
  }

 private:
  double in_mm(double spacings) const { return spacings * limits_.spacing; }

  void find_bands(std::size_t r) {
    const WalkedStretch& stretch = runs_[r];
    const double arm = in_mm(0.25);
    double from = infinity;
    double to = -infinity;
    const auto flush = [&] {
      if (to > from) add_band(r, std::max(0.0, from), std::min(stretch.length(), to));
    };
    for (std::size_t i = 0; i < stretch.size(); ++i) {
      const double s = stretch.arc(i);
      if (s < arm || s > stretch.length() - arm) continue;
      if (turn_at(mesh_, stretch.at(s - arm), stretch.node(i), stretch.at(s + arm)).radius() >=
          in_mm(least_turn_radius))
        continue;
      if (s - in_mm(legs_of_turn) > to) {
        flush();
        from = s - in_mm(legs_of_turn);
      }
      to = s + in_mm(legs_of_turn);
    }
    flush();
  }

  void add_band(std::size_t r, double from, double to) {
    Band band{r, from, to, WalkedStretch(mesh_, runs_[r].part(from, to)).sampled(in_mm(step_between_points)), 0, false};
    bands_.push_back(std::move(band));
  }

  /// The guard over the bands' points, and the rest of the curve beside them.
  CoverGuard watch() {
    std::vector<Vec3> points;
    std::vector<CoverGuard::Segment> segments;
    for (Band& band : bands_) {
      band.first_point = static_cast<Index>(points.size());
      for (const CurveNode& node : band.nodes) points.push_back(node.position);
    }
    const auto movable = static_cast<Index>(points.size());
    for (const Band& band : bands_) {
      for (Index i = 1; i < static_cast<Index>(band.nodes.size()); ++i) {
        if (band.nodes[i].kind == MoveKind::cover)
          segments.emplace_back(band.first_point + i - 1, band.first_point + i);
      }
    }
    std::size_t next = 0;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      double from = 0;
      for (; next < bands_.size() && bands_[next].run == r; ++next) {
        add_fixed(runs_[r], from, bands_[next].from, points, segments);
        from = bands_[next].to;
      }
      add_fixed(runs_[r], from, runs_[r].length(), points, segments);
    }
    return CoverGuard(
        mesh_, std::move(points), movable, std::move(segments),
        {.reach = in_mm(0.5 * limits_.widest), .sample_size = in_mm(sample_size), .most_moved = in_mm(most_moved)},
        progress_);
  }

  static void add_fixed(const WalkedStretch& stretch, double from, double to, std::vector<Vec3>& points,
                        std::vector<CoverGuard::Segment>& segments) {
    if (!(to > from)) return;
    const std::vector<CurveNode> nodes = stretch.part(from, to);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      points.push_back(nodes[i].position);
      const auto here = static_cast<Index>(points.size()) - 1;
      if (i > 0 && nodes[i].kind == MoveKind::cover) segments.emplace_back(here - 1, here);
    }
  }

  void draw(Band& band, CoverGuard& guard) {
    const auto n = static_cast<int>(band.nodes.size());
    std::vector<char> rests(band.nodes.size(), 0);
    for (int k = 0; k < most_sweeps_over_band; ++k) {
      progress_.checkpoint();
      bool any = false;
      for (int j = 2; j + 2 < n; ++j) {
        const int i = k % 2 == 0 ? j : n - 1 - j;
        if (rests[i]) continue;
        if (pull(band, i, guard)) {
          any = true;
          for (int m = i - 2; m <= i + 2; ++m) rests[m] = 0;
        } else {
          rests[i] = 1;
        }
      }
      if (!any) break;
      band.moved = true;
    }
  }

  /// Moves a node towards the middle of its neighbours, all the way or as far as it may go.
  bool pull(Band& band, int i, CoverGuard& guard) const {
    std::vector<CurveNode>& nodes = band.nodes;
    if (nodes[i].kind != MoveKind::cover || nodes[i + 1].kind != MoveKind::cover) return false;
    const Vec3 way = 0.5 * (nodes[i - 1].position + nodes[i + 1].position) - nodes[i].position;
    const CurveNode old = nodes[i];
    for (const double share : {1.0, 0.25}) {
      if (share * way.norm() < in_mm(least_move)) return false;
      const NearestPoint there = linker_.locator().nearest(old.position + share * way, in_mm(2 * step_between_points));
      if (!there.at.valid() || mesh_.face_normal(there.at.face).dot(mesh_.face_normal(old.at.face)) <= 0) continue;
      const CurveNode goal{there.at, position_of(mesh_, there.at), old.kind};
      if ((goal.position - old.position).norm() < in_mm(least_move)) continue;
      if (turns_too_tightly(nodes, i, goal)) continue;
      if (!guard.try_move(band.first_point + i, goal.position)) continue;
      nodes[i] = goal;
      return true;
    }
    return false;
  }

  /// Whether a turn at the node or beside it is then too tight and tighter than it was.
  bool turns_too_tightly(std::vector<CurveNode>& nodes, int i, const CurveNode& goal) const {
    const CurveNode old = nodes[i];
    for (int m = i - 1; m <= i + 1; ++m) {
      if (m < 1 || m + 1 >= static_cast<int>(nodes.size())) continue;
      const double before = turn_at(mesh_, nodes[m - 1], nodes[m], nodes[m + 1]).radius();
      nodes[i] = goal;
      const double after = turn_at(mesh_, nodes[m - 1], nodes[m], nodes[m + 1]).radius();
      nodes[i] = old;
      if (after < drawn_over_least_radius * limits_.radius && after < before) return true;
    }
    return false;
  }

  /// A run with its bands in their places.
  std::vector<CurveNode> with_bands(std::size_t r, std::size_t& next_band, std::vector<Vec3>& moved) const {
    const WalkedStretch& stretch = runs_[r];
    std::vector<CurveNode> whole;
    std::size_t next = 0;
    for (; next_band < bands_.size() && bands_[next_band].run == r; ++next_band) {
      const Band& band = bands_[next_band];
      if (!band.moved) continue;
      for (; next < stretch.size() && stretch.arc(next) < band.from; ++next) whole.push_back(stretch.node(next));
      const std::vector<CurveNode> drawn = thinned(mesh_, joined(linker_, band.nodes), 0.006 * limits_.radius);
      whole.insert(whole.end(), drawn.begin(), drawn.end());
      for (const CurveNode& node : band.nodes) moved.push_back(node.position);
      while (next < stretch.size() && stretch.arc(next) <= band.to) ++next;
    }
    for (; next < stretch.size(); ++next) whole.push_back(stretch.node(next));
    return whole;
  }

  const SurfaceLinker& linker_;
  const TriangleMesh& mesh_;
  TautLimits limits_;
  const Progress& progress_;
  std::vector<WalkedStretch> runs_;
  std::vector<Band> bands_;
};

}  // namespace

std::vector<Vec3> draw_taut(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactCurve& curve,
                            const TautLimits& limits, const Progress& progress) {
  std::vector<Vec3> moved;
  replace_runs(normals, curve, TautDrawer(linker, curve, limits, progress).run(moved));
  return moved;
}

}  // namespace isopath
