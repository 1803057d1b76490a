#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/impact/impact_curve.h"

namespace isopath {

/// The proof of coverage: how wide the gaps between neighbouring passes are, everywhere on the surface.
/// The gap at a point is twice its exact geodesic distance from the covering part of the curve. Lengths in mm.
struct GapReport {
  double max = 0;
  double p99 = 0;   ///< 99 % of the area has at most this gap
  double mean = 0;  ///< area-weighted; half a spacing for ideal parallel passes
  double cv =
      0;  ///< coefficient of variation: standard deviation / mean, area-weighted; ideal parallel passes have 1/√3
  double covered_fraction = 0;     ///< share of the area whose gap is at most 1.02 × spacing
  double area = 0;                 ///< mm²
  std::vector<double> vertex_gap;  ///< in the mesh's vertex order; infinity where no pass reaches
  std::vector<double> histogram;   ///< share of area per bin of width spacing / 20, from 0; the last bin takes the rest
};

/// Measures the gap by an exact distance field with the curve's covering moves as source (true segments).
GapReport measure_gap(const TriangleMesh& mesh, const ImpactCurve& curve, double spacing,
                      Progress& progress = Progress::none());

}  // namespace isopath
