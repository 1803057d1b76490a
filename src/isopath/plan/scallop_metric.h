#pragma once

#include <string>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// A part warped by the metric of a ball tool (paper ch. 10).
struct ScallopMetric {
  TriangleMesh mesh;                 ///< the part, finer where the metric changes fast; old vertices keep their numbers
  std::vector<double> edge_lengths;  ///< in the metric, mm
  double clamped_fraction = 0;       ///< share of the area where the ball is almost as hollow as the part, or more
  double gouged_fraction = 0;        ///< share of the area where the ball does not fit
  std::vector<std::string> warnings;
};

/// For passes at this pitch: triangles smaller than a quarter of it are only split to keep the triangle inequality.
/// Throws Error(bad_usage) unless the radius (mm) is positive, Error(cancelled) on request.
ScallopMetric scallop_metric(const TriangleMesh& mesh, double ball_radius, double pitch,
                             Progress& progress = Progress::none());

/// Length of a curve's covering moves in a metric, and the area in it.
double cover_length(const TriangleMesh& mesh, const ImpactCurve& curve, const IntrinsicGeometry& metric);
double area_in(const TriangleMesh& mesh, const IntrinsicGeometry& metric);

}  // namespace isopath
