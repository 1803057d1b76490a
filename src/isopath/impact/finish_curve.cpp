#include "isopath/impact/finish_curve.h"

#include "isopath/impact/min_radius.h"

namespace isopath {
namespace {

/// Swells of a curve that was rounded with the default may add to the turn of a corner, and so close what its rounding
/// opened.
constexpr double swell_radius_over_default = 0.85;
/// Rounding changes bumps: before it, it is enough that they are there.
constexpr int rounds_before_rounding = 2;

}  // namespace

void finish_curve(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactPlan& plan, GapLimits limits,
                  bool radius_first, Progress& progress) {
  if (limits.radius > 0) limits.most_rounds = rounds_before_rounding;
  progress.stage("wide gaps");
  close_wide_gaps(linker, normals, plan.curve, limits, progress);
  if (limits.radius == 0) return;
  plan.radius = limits.radius;
  plan.tight = keep_min_radius(linker, normals, plan.curve, limits.radius, progress);
  limits.round = true;
  limits.most_rounds = GapLimits{}.most_rounds;
  if (!radius_first) limits.radius *= swell_radius_over_default;
  int changes = close_wide_gaps(linker, normals, plan.curve, limits, progress);
  if (radius_first) {
    // what was asked for comes before the last gaps; turns that meet the curve near a bend may have corners
    if (changes > 0) plan.tight = keep_min_radius(linker, normals, plan.curve, limits.radius, progress);
    return;
  }
  // where only a corner or a loop reaches, the gap matters more
  limits.round = false;
  limits.radius = 0;
  changes += close_wide_gaps(linker, normals, plan.curve, limits, progress);
  if (changes > 0) plan.tight = tight_places(linker.mesh(), plan.curve, plan.radius, progress);
}

}  // namespace isopath
