#pragma once

#include <span>
#include <string>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/mesh/curvature.h"
#include "isopath/mesh/curved_surface.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// A part warped by the metric of a ball tool (paper ch. 10).
struct ScallopMetric {
  TriangleMesh mesh;                 ///< the part, finer where the metric changes fast; old vertices keep their numbers
  std::vector<Index> old_face;       ///< of each face, the face of the part that it is a piece of
  std::vector<double> edge_lengths;  ///< in the metric, mm
  double clamped_fraction = 0;       ///< share of the area where the ball is almost as hollow as the part, or more
  double gouged_fraction = 0;        ///< share of the area where the ball does not fit
  std::vector<std::string> warnings;
};

/// From the curvatures at the vertices, for passes at this pitch: triangles smaller than a quarter of it are only split
/// to keep the triangle inequality. Throws Error(bad_usage) unless the radius (mm) is positive, Error(cancelled) on
/// request.
ScallopMetric scallop_metric(const TriangleMesh& mesh, std::span<const PrincipalCurvatures> curvatures,
                             double ball_radius, double pitch, Progress& progress = Progress::none());

/// The part as it was read, with the smooth surface that it stands for: fitted over a pitch, as bumps narrower than
/// that lie between two passes and noise does.
struct FittedPart {
  FittedPart(const TriangleMesh& part, double pitch);
  TriangleMesh mesh;
  SurfaceFit fit;
};

/// The smooth surface as seen from a finer mesh of the part.
CurvedSurface surface_over(const FittedPart& part, const TriangleMesh& finer);
/// Gives the points of a curve on the mesh the normals of the smooth surface over it: a ball's centre stands along
/// them, and where they are wrong so is the distance of its passes.
void take_normals(const CurvedSurface& surface, ImpactCurve& curve);

/// Length of a curve's covering moves in a metric, and the area in it.
double cover_length(const TriangleMesh& mesh, const ImpactCurve& curve, const IntrinsicGeometry& metric);
double area_in(const TriangleMesh& mesh, const IntrinsicGeometry& metric);

}  // namespace isopath
