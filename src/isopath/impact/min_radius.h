#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/impact/surface_curve.h"
#include "isopath/mesh/normals.h"

namespace isopath {

/// Throws Error(bad_usage) unless the radius is finite and at least 1e-9 of the part's size: of a smaller one the
/// positions of points do not tell whether a curve keeps it.
void check_min_radius(const TriangleMesh& mesh, double radius);

/// A place where a curve turns more tightly than it should.
struct TightPlace {
  Vec3 position = Vec3::Zero();  ///< mm
  double radius = 0;             ///< mm
};

/// Radii of geodesic curvature are measured over this share of the radius asked for, before and behind a point: of the
/// circle through the three points in the tangent plane. So neither chords nor bends of the surface count as turns.
inline constexpr double radius_window = 0.5;

/// Where the curve turns on the surface with a radius below `radius`, one place for each stretch of such points.
/// Lifts do not count, nor does what is within an eighth of the radius of the ends of the stretches between them.
/// Throws what `check_min_radius` does, and Error(cancelled) on request.
std::vector<TightPlace> tight_places(const TriangleMesh& mesh, const ImpactCurve& curve, double radius,
                                     const Progress& progress = Progress::none());

/// Rounds the curve on the surface where it turns with a radius below `radius` (mm): there it is drawn tight like a
/// band that does not bend further, so that corners between straight legs become circular arcs, and what is smooth
/// enough stays as it is. Ends of the curve and of the stretches between lifts stay. Returns where the radius could not
/// be reached, as at narrow turns back and at ends. Throws what `tight_places` does.
std::vector<TightPlace> keep_min_radius(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactCurve& curve,
                                        double radius, const Progress& progress = Progress::none());

}  // namespace isopath
