#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/mesh/curved_surface.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Height of the cusps that a ball of radius R leaves between two passes a distance w apart on a plane. All in mm;
/// infinite for w >= 2 R.
double scallop_on_plane(double spacing, double ball_radius);
/// The same across a convex cylinder of radius ρ, w along its arc, for w < 2 π ρ. Infinite where the balls do not meet.
double scallop_on_convex(double spacing, double ball_radius, double surface_radius);
/// The pitch of passes on a plane whose cusps have this height in the paper's approximation, sqrt(8 h R): the pitch
/// to plan with in the metric of `tool_metric`. Throws Error(bad_usage) unless 0 < height < ball_radius.
double scallop_pitch(double height, double ball_radius);

/// The top of a cusp between a pass and its neighbour on one side.
struct Cusp {
  Vec3 pass = Vec3::Zero();  ///< the point of the pass from which it was looked for
  Vec3 top = Vec3::Zero();   ///< on the surface, below the top
  double height = 0;         ///< along the surface's normal, mm
};

struct ScallopReport {
  std::vector<Cusp> cusps;  ///< evenly along all covering passes, on both sides
  double min = infinity;    ///< of the cusps; infinite when there are none
  double mean = 0;
  double p99 = 0;  ///< 99 % of the cusps are at most this high
  double max = 0;
  /// Share of the sides of passes beside which no cusp was found: along rims, where passes end, beside hollow edges
  /// that the ball does not reach into, and where it cuts into the surface.
  double open_share = 0;
  std::vector<double> vertex_height;  ///< material left over each vertex, mm; infinity where no pass comes near
};

/// What a ball that follows the covering part of the curve leaves standing: measured, not by formula. Its centre moves
/// along p + R n, and what lies in none of the balls is left. From points along every pass, heights are followed
/// straight across it to either side until they come down on the other side of a cusp.
///
/// The surface is the curved one over the mesh, so that facets do not count as cusps. Only passes within six spacings
/// of each other are seen; links and lifts count as not cutting. Throws Error(bad_usage) unless both lengths (mm) are
/// positive, Error(no_plan) when the curve covers nothing, Error(cancelled) on request.
ScallopReport measure_scallop(const TriangleMesh& mesh, const CurvedSurface& surface, const ImpactCurve& curve,
                              double ball_radius, double spacing, Progress& progress = Progress::none());
/// On the surface that is fitted to this mesh: not for meshes with split faces, whose parts are flat.
ScallopReport measure_scallop(const TriangleMesh& mesh, const ImpactCurve& curve, double ball_radius, double spacing,
                              Progress& progress = Progress::none());

}  // namespace isopath
