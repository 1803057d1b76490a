#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "isopath/contour/contour_graph.h"
#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/impact/min_radius.h"

namespace isopath {

/// How isolines become a curve (paper ch. 7).
enum class Pattern {
  contour,  ///< every isoline is a pass of its own
  spiral,   ///< nested closed isolines become one spiral
  /// nested closed isolines become one closed curve that goes in along one arm and out along another; planned by
  /// level_spiral, not by plan_impact
  double_spiral,
  meander,     ///< quasi-parallel open isolines are joined end to end
  two_way,     ///< all isolines become one closed curve without a lift, on any connected surface
  trochoidal,  ///< circles whose centre moves along the isolines, see impact/trochoid.h
  planar,      ///< the cutting-plane baseline: the function is a height, the isolines are plane cuts
};
std::string_view name_of(Pattern pattern);

struct ImpactOptions {
  Pattern pattern = Pattern::spiral;
  double spacing = 0;        ///< distance between neighbouring passes, mm; required, > 0
  double clearance = 0;      ///< height of lifts above the surface, mm; 0 takes the spacing
  double circle_radius = 0;  ///< trochoidal: greatest radius of the circles, mm; 0 takes three
                             ///< spacings, or more where `min_radius` asks for it
  double circle_step = 0;    ///< trochoidal: way of their centre in a turn, mm; 0 takes the spacing
  bool close_gaps = true;    ///< and round corners, see gap_repair.h and min_radius.h
  /// Smallest radius that the curve may turn with on the surface, mm. 0: corners of two-way curves are rounded with
  /// 0.08 spacings, which costs no coverage, and those of other patterns stay. Trochoidal: circles are as large as that
  /// takes, unless their radius is given; bumps and links keep their corners.
  double min_radius = 0;
  /// The function is smooth, and so are its levels: gaps are closed as gently as can be. Rounds the corners of every
  /// pattern as those of two-way curves, and draws it as tight.
  bool smooth_levels = false;
  /// What the function and the spacing are measured in; null for lengths in space. Must outlive the call.
  const IntrinsicGeometry* metric = nullptr;
  void validate() const;  ///< throws Error(bad_usage) naming the field, its value and its limit
};

struct ImpactPlan {
  ImpactCurve curve;
  std::vector<Contour> contours;      ///< the isolines the curve was made from
  double radius = 0;                  ///< that corners were rounded with, mm; 0 where they were not
  std::vector<TightPlace> tight;      ///< where the smallest radius could not be kept
  std::vector<std::string> warnings;  ///< what the user should know, one sentence each
};

/// Covers the part of the surface where `function` is finite: isolines, contour graph, one curve for each run of
/// contours, joined by links on the surface where these are short and by lifts elsewhere. Throws Error(no_plan) with
/// the reason when nothing can be covered.
ImpactPlan plan_impact(const TriangleMesh& mesh, const SurfaceFunction& function, const ImpactOptions& options,
                       Progress& progress = Progress::none());

/// Closes gaps and rounds corners of a plan that was made without `close_gaps`, as plan_impact does with it; not for
/// trochoidal plans. `options` are those of the plan otherwise.
void finish_plan(const TriangleMesh& mesh, const ImpactOptions& options, ImpactPlan& plan,
                 Progress& progress = Progress::none());

}  // namespace isopath
