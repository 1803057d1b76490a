#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/surface_function.h"
#include "isopath/impact/impact_plan.h"
#include "isopath/impact/surface_curve.h"

namespace isopath {

/// A circle whose centre moves along a guiding curve while a point runs round it (paper ch. 12). Lengths in mm.
struct CircleOptions {
  double radius = 0;           ///< > 0
  double step = 0;             ///< way of the centre in one turn, > 0; adapted so that the turns of a curve are whole
  double chord_tolerance = 0;  ///< greatest distance of a chord from the circle; 0 takes 1/500 of the radius
  void validate() const;       ///< throws Error(bad_usage) naming the field, its value and its limit
};

/// The smallest radius that the trace turns with beside a straight guide: (r - v)²/r, v being the way of the centre for
/// each radian of a turn. There the point runs against the centre. 0 where the trace has loops no more.
double tightest_radius(const CircleOptions& options);
/// The radius of the circles whose trace turns no tighter than with `tightest` (mm, >= 0): the inverse for this step.
double circle_radius_for(double tightest, double step);

/// A point of the trace, and the centre it belongs to.
struct CirclePoint {
  SurfacePoint centre;
  SurfacePoint at;  ///< a radius from the centre along a straightest geodesic, or where that meets the boundary
};

/// The trace of the point over the whole guide, counter-clockwise as seen from the side the normals point to. The
/// direction from centre to point turns evenly against one that is carried along the guide in parallel, so that corners
/// of the guide make no corners in the trace. It starts in the direction of `towards`; that of a closed guide, whose
/// first point is repeated at its end, ends where it begins.
/// Throws Error(bad_usage) for invalid options, for more than 2e7 points and for a guide without length,
/// Error(cancelled) on request.
std::vector<CirclePoint> trochoid(const TriangleMesh& mesh, const SurfaceCurve& guide, const Vec3& towards,
                                  const CircleOptions& options, const Progress& progress = Progress::none());

/// Where the guides lie so that traces of circles cover with a uniform density.
struct GuideLayout {
  double radius = 0;    ///< of the circles: at most the one asked for
  double distance = 0;  ///< between neighbouring guides
  std::vector<double> levels;
};

/// Straight guides `distance` apart with circles of radius ρ cross a line beside them at y with the density
/// Σ 1/√(1 - (y - k·distance)²/ρ²), whose harmonics are J0(2π k ρ/distance). With ρ = 0.8786 distance, the second zero
/// of the Bessel function, the first one vanishes and neighbouring bands overlap by three quarters.
///
/// Levels fill the range from `low` to `high`. At a rim the outermost guide is a radius away, so that circles touch it;
/// elsewhere half a distance, as another guide lies on the other side. Throws Error(bad_usage) unless radius > 0 and
/// low < high, and for more than 20000 levels.
GuideLayout guide_layout(double low, double high, double radius, bool rim_at_low, bool rim_at_high);

/// Covers a surface with circles along the isolines of a function (Pattern::trochoidal). Throws what `plan_impact`
/// does.
ImpactPlan plan_trochoids(const TriangleMesh& mesh, const SurfaceFunction& function, const ImpactOptions& options,
                          Progress& progress);

}  // namespace isopath
