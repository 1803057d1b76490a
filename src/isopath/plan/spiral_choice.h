#pragma once

#include <optional>
#include <span>
#include <string>

#include "isopath/core/progress.h"
#include "isopath/impact/impact_plan.h"
#include "isopath/plan/job.h"

namespace isopath {

/// What a curve costs whoever runs it.
struct CurveCost {
  double length = 0;  ///< on the surface, covering and links, mm
  Index lifts = 0;
  Index sharp_corners = 0;  ///< see PathFigures
  /// False where gaps were not closed and corners not rounded, as the curve was not the better one anyway: then it
  /// would be longer than this.
  bool finished = true;
};
CurveCost cost_of(const ImpactCurve& curve, double spacing, bool finished);
/// As a length, mm: a lift counts as 20 spacings, a sharp corner, where a machine stops, as five.
double as_length(const CurveCost& cost, double spacing);

/// How the planner chose between a spiral by the distance alone and one by blended levels, or between a double spiral
/// and a two-way curve, where the job leaves it to the planner (Blending::automatic).
struct SpiralChoice {
  bool blended = false;
  /// The blended mesh would have so many triangles that it was not tried, 0 where it was worth a try.
  double too_fine = 0;
  std::optional<CurveCost> by_distance;  ///< or that of what was planned in its place, where no pattern was named
  std::optional<CurveCost> by_blend;     ///< none where it was not tried, or is not possible
  /// Of the closed curve over levels that need not be nested, in the place of a double spiral on a part with holes.
  std::optional<CurveCost> by_two_way;
};

/// True when a job may have either spiral: it names the spiral or no pattern, and the part's components are discs whose
/// whole rim is at distance 0. `distances` are those at the vertices.
bool may_blend_spiral(const Job& job, const TriangleMesh& mesh, std::span<const double> distances);
/// True when a job that names the double spiral may have a two-way curve in its place, which ends where it began as
/// well: the part has holes, so that it would have to be cut open or levels lie as close as its narrowest place asks
/// for, and its whole rim is at distance 0.
bool may_close_two_way(const Job& job, const TriangleMesh& mesh, std::span<const double> distances);
/// About how many triangles the mesh would have that distances are blended on.
double triangles_for_blend(const TriangleMesh& mesh, double spacing);
/// Blending takes about 20 seconds for a million triangles; beyond this a user has to ask for it.
inline constexpr double most_triangles_unasked = 100000;

/// A spiral so good that blending has nothing to win.
bool is_good_spiral(const CurveCost& cost, double area, double spacing);

/// False for a curve that is too short to cover the area: a smallest radius of many spacings swallows passes.
bool may_cover(const CurveCost& cost, double area, double spacing);

/// What was chosen and why, as a sentence without full stop. `area` in mm².
std::string text_of(const SpiralChoice& choice, double area, double spacing);

}  // namespace isopath
