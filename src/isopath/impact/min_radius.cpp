#include "isopath/impact/min_radius.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/impact/walked_stretch.h"

namespace isopath {
namespace {

/// The band is drawn to a radius this much larger than asked for: its points stand for arcs.
constexpr double drawn_over_asked = 1.04;
/// Steps between the points of the band, as parts of the radius: coarse first, as tightening spreads from point to
/// point.
constexpr double steps_over_radius[] = {0.4, 0.2, 0.2, 0.14};
constexpr int most_sweeps = 150;
/// An arc of this sag turns by 13 degrees from chord to chord.
constexpr double chord_tolerance_over_radius = 0.006;
/// Places within this of the radius asked for are taken as good.
constexpr double radius_tolerance = 0.02;
/// Near the ends of a stretch radii are measured over less than the window, down to this share of it.
constexpr double least_arm = 0.3;
/// What does not come round is tried with so many times longer legs.
constexpr int most_tries = 3;
/// A thousand times the tolerance of the mesh: turns over a part of the radius are still told from rounding.
constexpr double least_radius_over_size = 1e-9;

/// An interval of arc that turns too tightly, and its worst place.
struct Tight {
  double from = 0;
  double to = 0;
  TightPlace worst;
};

std::vector<Tight> tight_intervals(const TriangleMesh& mesh, const WalkedStretch& stretch, double from, double to,
                                   double radius, const Progress& progress) {
  std::vector<Tight> found;
  const double window = radius_window * radius;
  for (std::size_t i = stretch.behind(from); i < stretch.size() && stretch.arc(i) <= to; ++i) {
    if (i % 4096 == 0) progress.checkpoint();
    const double s = stretch.arc(i);
    const double arm = std::min({window, s, stretch.length() - s});
    if (arm < least_arm * window) continue;
    const double here = turn_at(mesh, stretch.at(s - arm), stretch.node(i), stretch.at(s + arm)).radius();
    if (here >= (1 - radius_tolerance) * radius) continue;
    if (found.empty() || s - found.back().to > window) found.push_back({s, s, {stretch.node(i).position, here}});
    found.back().to = s;
    if (here < found.back().worst.radius) found.back().worst = {stretch.node(i).position, here};
  }
  return found;
}

class BandTightener {
 public:
  BandTightener(const SurfaceLinker& linker, double radius, const Progress& progress)
      : linker_(linker), mesh_(linker.mesh()), radius_(radius), progress_(progress) {}

  /// The stretch between two arcs, drawn tight; its ends, and the directions there, stay.
  std::vector<CurveNode> tightened(const WalkedStretch& stretch, double from, double to) const {
    std::vector<CurveNode> nodes = stretch.part(from, to);
    for (const double step : steps_over_radius) {
      std::vector<CurveNode> band = WalkedStretch(mesh_, std::move(nodes)).sampled(step * radius_);
      sweep(band);
      nodes = joined(linker_, band);
    }
    return thinned(mesh_, nodes, chord_tolerance_over_radius * radius_);
  }

 private:
  /// Each point goes towards the middle of its neighbours as far as the turn it has is too large, again and again,
  /// back and forth.
  void sweep(std::vector<CurveNode>& band) const {
    const auto n = static_cast<int>(band.size());
    for (int k = 0; k < most_sweeps; ++k) {
      progress_.checkpoint();
      double worst = 0;
      for (int j = 2; j + 2 < n; ++j) {
        const int i = k % 2 == 0 ? j : n - 1 - j;
        worst = std::max(worst, tighten(band[i - 1], band[i], band[i + 1]));
      }
      if (worst <= 1.005) break;
    }
  }

  /// Returns by how much the turn was too large.
  double tighten(const CurveNode& before, CurveNode& node, const CurveNode& behind) const {
    const Turn turn = turn_at(mesh_, before, node, behind);
    const double allowed = 2 * std::asin(std::min(1.0, turn.step / (2 * drawn_over_asked * radius_)));
    if (turn.angle <= allowed) return 1;
    const Vec3 to_middle = 0.5 * (turn.behind - turn.before);
    const double share = std::sin(0.5 * allowed) / std::sin(0.5 * turn.angle);
    const Vec3 goal = node.position + (1 - share) * to_middle;
    const NearestPoint there = linker_.locator().nearest(goal, turn.step + mesh_.tolerance().length);
    // not to the other side of a thin wall
    if (there.at.valid() && mesh_.face_normal(there.at.face).dot(mesh_.face_normal(node.at.face)) > 0) {
      node.at = there.at;
      node.position = position_of(mesh_, there.at);
    }
    return turn.angle / allowed;
  }

  const SurfaceLinker& linker_;
  const TriangleMesh& mesh_;
  double radius_;
  const Progress& progress_;
};

/// Tight intervals with legs on both sides to draw on, those that meet made one.
std::vector<Tight> with_legs(std::vector<Tight> tight, double legs, double length) {
  std::vector<Tight> merged;
  for (Tight& t : tight) {
    t.from = std::max(0.0, t.from - legs);
    t.to = std::min(length, t.to + legs);
    if (!merged.empty() && t.from <= merged.back().to) {
      merged.back().to = std::max(merged.back().to, t.to);
    } else {
      merged.push_back(t);
    }
  }
  return merged;
}

/// The nodes of a stretch with every tight interval drawn round.
std::vector<CurveNode> rounded(const SurfaceLinker& linker, std::vector<CurveNode> nodes, double radius, double legs,
                               const Progress& progress) {
  const TriangleMesh& mesh = linker.mesh();
  const WalkedStretch stretch(mesh, std::move(nodes));
  const BandTightener tightener(linker, radius, progress);
  std::vector<CurveNode> whole;
  std::size_t next = 0;
  for (const Tight& tight :
       with_legs(tight_intervals(mesh, stretch, 0, infinity, radius, progress), legs * radius, stretch.length())) {
    for (; next < stretch.size() && stretch.arc(next) < tight.from; ++next) whole.push_back(stretch.node(next));
    const std::vector<CurveNode> band = tightener.tightened(stretch, tight.from, tight.to);
    whole.insert(whole.end(), band.begin(), band.end());
    while (next < stretch.size() && stretch.arc(next) <= tight.to) ++next;
  }
  for (; next < stretch.size(); ++next) whole.push_back(stretch.node(next));
  return whole;
}

}  // namespace

void check_min_radius(const TriangleMesh& mesh, double radius) {
  const double least = least_radius_over_size * mesh.size();
  if (radius >= least && std::isfinite(radius)) return;
  throw Error(ErrorCode::bad_usage, "the smallest radius of the curve cannot be this",
              {.element = "min radius",
               .value = fmt::format("{:.4g} mm, limit {:.4g} mm", radius, least),
               .advice = "give a larger one, or none"});
}

std::vector<TightPlace> tight_places(const TriangleMesh& mesh, const ImpactCurve& curve, double radius,
                                     const Progress& progress) {
  check_min_radius(mesh, radius);
  std::vector<TightPlace> places;
  for (const auto& [first, end] : runs_on_surface(curve)) {
    const WalkedStretch stretch(mesh, nodes_of(curve, first, end));
    for (const Tight& tight : tight_intervals(mesh, stretch, 0, infinity, radius, progress))
      places.push_back(tight.worst);
  }
  return places;
}

std::vector<TightPlace> keep_min_radius(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactCurve& curve,
                                        double radius, const Progress& progress) {
  check_min_radius(linker.mesh(), radius);
  std::vector<std::vector<CurveNode>> runs;
  for (const auto& [first, end] : runs_on_surface(curve)) {
    runs.push_back(nodes_of(curve, first, end));
    for (int legs = 3, k = 0; k < most_tries; ++k, legs *= 2)
      runs.back() = rounded(linker, std::move(runs.back()), radius, legs, progress);
  }
  replace_runs(normals, curve, runs);
  return tight_places(linker.mesh(), curve, radius, progress);
}

}  // namespace isopath
