#include "isopath/plan/auto_pattern.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "isopath/contour/isolines.h"

namespace isopath {
namespace {

/// One lift is worth so much of the length.
constexpr double similar_length = 1.05;
/// The right angles of joints are worth so much of it.
constexpr double worthwhile_length = 1.05;

/// Where every pattern needs more lifts than this, from one component to the next, sparing less than the share of them
/// is not worth planning all anew.
constexpr Index many_lifts = 20;
constexpr double worthwhile_lifts = 0.1;

Index lifts_of(const ImpactCurve& curve) { return curve.points.back().piece; }

double length_on_surface(const ImpactCurve& curve) {
  return length_of(curve, MoveKind::cover) + length_of(curve, MoveKind::link);
}

bool clearly_better(const ImpactCurve& curve, const ImpactCurve& than) {
  const double length = length_on_surface(curve);
  const double other_length = length_on_surface(than);
  if (lifts_of(curve) < lifts_of(than)) return length <= similar_length * other_length;
  return lifts_of(curve) == lifts_of(than) && worthwhile_length * length < other_length;
}

/// Whether closed curves, one for every component, could spare a good share of the lifts.
bool may_spare_lifts(const ImpactCurve& curve, const TriangleMesh& mesh) {
  const Index least = mesh.n_components() - 1;
  return least <= many_lifts || lifts_of(curve) - least > worthwhile_lifts * lifts_of(curve);
}

/// Area that the function reaches.
double reached_area(const TriangleMesh& mesh, std::span<const double> values) {
  double sum = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const Triangle& t = mesh.triangle(f);
    if (std::all_of(t.begin(), t.end(), [&](Index v) { return values[v] < infinity; })) sum += mesh.face_area(f);
  }
  return sum;
}

}  // namespace

Pattern pattern_by_isolines(const TriangleMesh& mesh, const SurfaceFunction& function, std::span<const double> values,
                            Progress& progress) {
  double largest = 0;
  for (const double value : values) {
    if (value < infinity) largest = std::max(largest, value);
  }
  std::vector<double> levels;
  if (largest > 0) {
    for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) levels.push_back(share * largest);
  }
  double closed = 0;
  double open = 0;
  for (const Contour& contour : isolines(mesh, function, levels, {}, progress)) {
    (contour.closed ? closed : open) += length_of(mesh, contour);
  }
  return closed >= open ? Pattern::spiral : Pattern::meander;
}

ChosenPlan plan_by_part(const TriangleMesh& mesh, const SurfaceFunction& function, std::span<const double> values,
                        const ImpactOptions& options, Progress& progress,
                        const std::function<const SurfaceFunction&()>& two_way_function) {
  const auto two_way = [&]() -> const SurfaceFunction& { return two_way_function ? two_way_function() : function; };
  ImpactOptions tried = options;
  const auto draft = [&](Pattern pattern) {
    // gaps are closed where it is certain that the curve is the one: that takes longer than all else
    tried.pattern = pattern;
    tried.close_gaps = false;
    return ChosenPlan{pattern, plan_impact(mesh, pattern == Pattern::two_way ? two_way() : function, tried, progress)};
  };
  const auto finished = [&](ChosenPlan plan) {
    tried.pattern = plan.pattern;
    tried.close_gaps = options.close_gaps;
    if (options.close_gaps) finish_plan(mesh, tried, plan.plan, progress);
    return plan;
  };
  ChosenPlan first = draft(pattern_by_isolines(mesh, function, values, progress));
  if (lifts_of(first.plan.curve) > 0) {
    if (!may_spare_lifts(first.plan.curve, mesh)) return finished(std::move(first));
    ChosenPlan other = draft(Pattern::two_way);
    return finished(clearly_better(other.plan.curve, first.plan.curve) ? std::move(other) : std::move(first));
  }
  first = finished(std::move(first));
  const double ratio = length_on_surface(first.plan.curve) * options.spacing / reached_area(mesh, values);
  if (ratio <= good_length_ratio) return first;
  ChosenPlan other = finished(draft(Pattern::two_way));
  return clearly_better(other.plan.curve, first.plan.curve) ? std::move(other) : std::move(first);
}

}  // namespace isopath
