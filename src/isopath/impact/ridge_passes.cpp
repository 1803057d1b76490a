#include "isopath/impact/ridge_passes.h"

#include <algorithm>
#include <utility>

#include "isopath/contour/isolines.h"
#include "isopath/impact/cover_field.h"

namespace isopath {
namespace {

/// Between the ways out and back, in spacings: together they cover twice that, and leave nothing open between them.
constexpr double hairpin_width = 1;
/// Shorter stretches than this, in spacings, are left to bumps.
constexpr double shortest_stretch = 2;
/// Wide gaps no farther apart than this along a ridge, in spacings, belong to one stretch.
constexpr double joined = 4;

/// A ridge as a curve on the surface with a point every tenth of a spacing.
std::vector<SurfacePoint> fine_points(const SurfaceLinker& linker, std::span<const SurfacePoint> ridge,
                                      double spacing) {
  const TriangleMesh& mesh = linker.mesh();
  SurfaceCurve curve;
  for (const SurfacePoint& point : ridge) linker.extend(curve, point);
  std::vector<SurfacePoint> points;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    if (i > 0) append_between(mesh, curve.points[i - 1], curve.points[i], 0.1 * spacing, points);
    points.push_back(curve.points[i]);
  }
  return points;
}

/// The stretches of a ridge that are worth a pass: from one wide gap to the next while these follow each other
/// closely, and out at both ends until the gaps grow again; each starts where it is nearer to the curve.
std::vector<Contour> wide_stretches(const TriangleMesh& mesh, const ExactField& distance,
                                    std::vector<SurfacePoint> points, double spacing, double wide) {
  std::vector<double> gap;
  std::vector<double> arc;
  for (const SurfacePoint& point : points) {
    gap.push_back(2 * distance.value(point));
    const std::size_t i = arc.size();
    arc.push_back(i == 0 ? 0 : arc.back() + (position_of(mesh, point) - position_of(mesh, points[i - 1])).norm());
  }
  std::vector<Contour> stretches;
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (!(gap[i] > wide)) continue;
    std::size_t last = i;
    for (std::size_t k = i + 1; k < n && arc[k] - arc[last] <= joined * spacing; ++k) {
      if (gap[k] > wide) last = k;
    }
    std::size_t begin = i;
    while (begin > 0 && gap[begin - 1] < gap[begin]) --begin;
    while (last + 1 < n && gap[last + 1] < gap[last]) ++last;
    if (arc[last] - arc[begin] >= shortest_stretch * spacing) {
      Contour& stretch = stretches.emplace_back();
      stretch.points.assign(points.begin() + begin, points.begin() + last + 1);
      if (gap[last] < gap[begin]) std::reverse(stretch.points.begin(), stretch.points.end());
    }
    i = last;
  }
  return stretches;
}

}  // namespace

int add_ridge_passes(const SurfaceLinker& linker, const SmoothNormals& normals,
                     std::span<const std::vector<SurfacePoint>> ridges, ImpactCurve& curve, const GapLimits& limits,
                     Progress& progress) {
  const TriangleMesh& mesh = linker.mesh();
  const CoverField cover = distance_from_cover(mesh, curve, limits.spacing, progress, limits.metric);
  std::vector<Replacement> passes;
  for (const std::vector<SurfacePoint>& ridge : ridges) {
    for (const Contour& stretch : wide_stretches(mesh, cover.field, fine_points(linker, ridge, limits.spacing),
                                                 limits.spacing, limits.widest * limits.spacing)) {
      progress.checkpoint();
      passes.push_back(detour_along(stretch, linker, normals, curve, cover, hairpin_width * limits.spacing));
    }
  }
  return replace(mesh, curve, std::move(passes));
}

}  // namespace isopath
