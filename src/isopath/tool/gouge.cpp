#include "isopath/tool/gouge.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "isopath/mesh/surface_locator.h"

namespace isopath {
namespace {

/// A small piece of the way.
struct Step {
  Vec3 centre;           ///< of the ball, in its middle
  double length;         ///< of the tip's way
  NearestPoint nearest;  ///< of the surface, where it reaches into the ball
};

std::vector<Step> steps_of(const ToolPath& path, double ball_radius) {
  std::vector<Step> steps;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const ToolPoint& from = path.points[i - 1];
    const ToolPoint& to = path.points[i];
    if (to.kind == MoveKind::lift || to.piece != from.piece) continue;
    // Machines that know the tool's length move its tip straight and turn its axis about it meanwhile.
    const auto centre = [&](double t) -> Vec3 {
      return (1 - t) * from.tip + t * to.tip + ball_radius * ((1 - t) * from.axis + t * to.axis).normalized();
    };
    const double way = (to.tip - from.tip).norm() + ball_radius * (to.axis - from.axis).norm();
    const int n = std::max(1, static_cast<int>(std::ceil(way / (0.25 * ball_radius))));
    const double length = (to.tip - from.tip).norm() / n;
    for (int k = 0; k < n; ++k) steps.push_back({centre((k + 0.5) / n), length, {}});
  }
  return steps;
}

}  // namespace

GougeReport measure_gouges(const TriangleMesh& mesh, const ToolPath& path, double ball_radius, double tolerance,
                           const Progress& progress) {
  std::vector<Step> steps = steps_of(path, ball_radius);
  const SurfaceLocator locator(mesh);
  tbb::parallel_for(std::size_t{0}, steps.size(), [&](std::size_t i) {
    if (i % 256 == 0) progress.checkpoint();
    steps[i].nearest = locator.nearest(steps[i].centre, ball_radius - tolerance);
  });
  GougeReport report;
  double length = 0;
  double gouged = 0;
  for (const Step& step : steps) {
    length += step.length;
    if (!step.nearest.at.valid()) continue;
    gouged += step.length;
    const double depth = ball_radius - step.nearest.distance;
    if (depth <= report.deepest) continue;
    report.deepest = depth;
    report.place = position_of(mesh, step.nearest.at);
  }
  report.share = length > 0 ? gouged / length : 0;
  return report;
}

}  // namespace isopath
