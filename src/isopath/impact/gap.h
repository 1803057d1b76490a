#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/impact/cover_field.h"
#include "isopath/impact/impact_curve.h"

namespace isopath {

/// The proof of coverage: how wide the gaps between neighbouring passes are, everywhere on the surface.
/// The gap at a point is twice its geodesic distance from the covering part of the curve, known to 2e-4 spacings (twice
/// `cover_accuracy`). Lengths in mm.
/// In a metric, distances and the spacing are lengths in it; areas stay those in space.
/// Where a part of the surface is not reached its gap is infinite, and so are max, mean and cv.
struct GapReport {
  double max = 0;  ///< of the vertices and of samples no farther than a ninth of a spacing from anywhere (in very large
                   ///< faces farther)
  double p99 = 0;  ///< 99 % of the area has at most this gap
  double mean = 0;  ///< area-weighted; half a spacing for ideal parallel passes
  /// Coefficient of variation: standard deviation / mean, area-weighted; ideal parallel passes have 1/√3.
  double cv = 0;
  double covered_fraction = 0;     ///< share of the area whose gap is at most 1.02 × spacing
  double area = 0;                 ///< mm²
  std::vector<double> vertex_gap;  ///< in the mesh's vertex order; infinity where no pass reaches
  std::vector<double> histogram;   ///< share of area per bin of width spacing / 20, from 0; the last bin takes the rest
};

/// Measures the gap by a distance field with the curve's covering moves as source (true segments).
/// Throws Error(bad_usage) for a spacing that is not positive, Error(no_plan) when the curve covers nothing,
/// Error(cancelled) on request.
GapReport measure_gap(const TriangleMesh& mesh, const ImpactCurve& curve, double spacing,
                      Progress& progress = Progress::none(), const IntrinsicGeometry* metric = nullptr);
/// The same for a caller who has the distance from the cover at hand.
GapReport measure_gap(const CoverField& cover, double spacing, Progress& progress = Progress::none());

}  // namespace isopath
