#include "isopath/impact/finish_curve.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "isopath/impact/min_radius.h"
#include "isopath/impact/taut_curve.h"

namespace isopath {
namespace {

/// Swells of a curve that was rounded with the default may add to the turn of a corner, and so close what its rounding
/// opened.
constexpr double swell_radius_over_default = 0.85;
/// Swells among smooth passes turn with no less than this, in spacings: a machine does not slow down there.
constexpr double gentle_radius = 0.25;
constexpr int rounds_of_gentle_swells = 2;
/// Rounding changes bumps: before it, it is enough that they are there.
constexpr int rounds_before_rounding = 2;

/// What drawing tight leaves covered, in spacings: less than what counts as wide, as it looks at samples only.
constexpr double taut_gap = 1.02;

/// Rounding that leaves less of what a curve covers has taken more than corners.
constexpr double least_left = 0.8;

bool before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

std::vector<Vec3> sorted_positions(const ImpactCurve& curve) {
  std::vector<Vec3> positions;
  for (const ImpactPoint& point : curve.points) positions.push_back(point.position);
  std::sort(positions.begin(), positions.end(), before);
  return positions;
}

double cover_length(const ImpactCurve& curve) {
  double length = 0;
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    if (curve.points[i].kind == MoveKind::cover)
      length += (curve.points[i].position - curve.points[i - 1].position).norm();
  }
  return length;
}

/// Rounds the curve, unless that would swallow passes, as radii of many spacings do, and not just their corners.
std::vector<TightPlace> round_where_possible(const SurfaceLinker& linker, const SmoothNormals& normals,
                                             ImpactCurve& curve, double radius, const Progress& progress) {
  ImpactCurve rounded = curve;
  std::vector<TightPlace> tight = keep_min_radius(linker, normals, rounded, radius, progress);
  if (cover_length(rounded) < least_left * cover_length(curve)) {
    return tight_places(linker.mesh(), curve, radius, progress);
  }
  curve = std::move(rounded);
  return tight;
}

/// Rounds the curve and adds the points that this has moved, where they were and where they are.
std::vector<TightPlace> round_corners(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactCurve& curve,
                                      double radius, std::vector<Vec3>& moved, const Progress& progress) {
  const std::vector<Vec3> old_positions = sorted_positions(curve);
  std::vector<TightPlace> tight = round_where_possible(linker, normals, curve, radius, progress);
  const std::vector<Vec3> positions = sorted_positions(curve);
  std::set_symmetric_difference(old_positions.begin(), old_positions.end(), positions.begin(), positions.end(),
                                std::back_inserter(moved), before);
  return tight;
}

}  // namespace

void finish_curve(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactPlan& plan, GapLimits limits,
                  const FinishOptions& options, Progress& progress) {
  progress.stage("wide gaps");
  if (options.gently) {
    GapLimits gentle = limits;
    gentle.form = GapForm::swells;
    gentle.radius = std::max(limits.radius, gentle_radius * limits.spacing);
    gentle.most_rounds = rounds_of_gentle_swells;
    close_gaps_everywhere(linker, normals, plan.curve, gentle, progress);
  }
  if (limits.radius > 0) limits.most_rounds = rounds_before_rounding;
  ClosedGaps closed = close_gaps_everywhere(linker, normals, plan.curve, limits, progress);
  if (limits.radius == 0) return;
  plan.radius = limits.radius;
  plan.tight = round_corners(linker, normals, plan.curve, limits.radius, closed.unsettled, progress);
  limits.form = GapForm::round;
  limits.most_rounds = GapLimits{}.most_rounds;
  if (!options.radius_first) limits.radius *= swell_radius_over_default;
  closed = close_gaps_beside(linker, normals, plan.curve, closed.unsettled, limits, progress);
  int changes = closed.count;
  if (options.radius_first) {
    // what was asked for comes before the last gaps; turns that meet the curve near a bend may have corners
    if (changes > 0) plan.tight = round_where_possible(linker, normals, plan.curve, limits.radius, progress);
    return;
  }
  if (options.taut) {
    const std::vector<Vec3> moved = draw_taut(
        linker, normals, plan.curve, {.spacing = limits.spacing, .widest = taut_gap, .radius = plan.radius}, progress);
    closed.unsettled.insert(closed.unsettled.end(), moved.begin(), moved.end());
    closed = close_gaps_beside(linker, normals, plan.curve, closed.unsettled, limits, progress);
    changes += closed.count + static_cast<int>(moved.size());
  }
  // where only a corner or a loop reaches, the gap matters more
  limits.form = GapForm::bumps;
  limits.radius = 0;
  changes += close_gaps_beside(linker, normals, plan.curve, closed.unsettled, limits, progress).count;
  if (changes > 0) plan.tight = tight_places(linker.mesh(), plan.curve, plan.radius, progress);
}

}  // namespace isopath
