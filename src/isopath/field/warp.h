#pragma once

#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/metric_tensor.h"
#include "isopath/mesh/curvature.h"
#include "isopath/mesh/normals.h"
#include "isopath/mesh/refine.h"

namespace isopath {

/// The metric of a ball tool on a surface: where the surface has normal curvature κ across the passes, passes a
/// distance w apart leave cusps of height w² (κt - κ) / 8 with κt = 1 / R, so that lengths are to be stretched by
/// sqrt(1 - R κ) (paper ch. 10). In it, passes at a pitch of sqrt(8 h0 R) leave cusps of height h0 everywhere.
struct ToolMetric {
  std::vector<MetricTensor> tensors;  ///< at every vertex
  std::vector<Index> clamped;         ///< vertices where a stretch was raised to the least one, ascending
  std::vector<Index> gouged;          ///< those of them where the ball does not fit: a curvature reaches 1 / R
};

/// `curvatures` at every vertex, concave positive (see principal_curvatures). Stretches below `least_stretch` are
/// raised to it: the ball is then almost as hollow as the surface, and the pitch would grow without bound. Throws
/// Error(bad_usage) unless the radius (mm) is positive and the least stretch in (0, 1].
ToolMetric tool_metric(std::span<const PrincipalCurvatures> curvatures, double tool_radius,
                       double least_stretch = 0.25);

struct WarpOptions {
  TensorBlend blend = TensorBlend::linear;
  /// Triangles are split while the two halves of an edge differ by more than this from half of its length in the
  /// metric, as a share of it: the paper's test. Above 0, below 0.5. 0.02 lets stretches differ by a fifth along an
  /// edge.
  double midpoint_shift = 0.02;
  double length_excess = 0.005;  ///< or their sum differs by more than this share from the edge's length; above 0
  double shortest_edge = 0;      ///< an edge no longer than this in the metric, mm, passes both tests; 0 or more
  int max_levels = 3;            ///< times that a triangle may be split, 0 … 20; 0 keeps the mesh

  void validate() const;  ///< throws Error(bad_usage) naming the field, its value and its limit
};

/// A mesh with lengths of its edges in a metric that its triangles can have.
struct WarpedSurface {
  RefinedMesh refined;                ///< the same surface; old vertices keep their numbers
  std::vector<MetricTensor> tensors;  ///< at its vertices, normals outward
  std::vector<double> edge_lengths;   ///< for IntrinsicGeometry
  Index broken_faces = 0;             ///< faces whose lengths broke the triangle inequality, after splitting
  double added_length = 0;            ///< what was added to all lengths to mend them, mm: the least that does
};

/// Edge lengths from a tensor at every vertex of the mesh (paper ch. 10). Triangles over which the metric changes
/// much, or whose lengths break the triangle inequality, are split at the midpoints of their edges in space; what stays
/// broken at the last level is mended by adding one length to all edges (Sharp & Crane 2020).
/// Throws Error(bad_usage) for invalid options or a number of tensors that is not that of the vertices,
/// Error(bad_input) that names the vertex for a stretch that is not finite and positive or directions that are not
/// orthonormal, Error(cancelled) on request.
WarpedSurface warp_surface(const TriangleMesh& mesh, std::span<const MetricTensor> tensors,
                           const WarpOptions& options = {}, Progress& progress = Progress::none());

/// The ball's metric from the change of the normals along each edge, without any curvature: l² = |e|² + R Δn·Δp.
/// Inside each face this is one tensor, so that lengths fit where the ball does. Normals at the boundary, and those of
/// irregular meshes, are too rough for it; it serves to compare. Squared lengths are clamped to the square of
/// `least_stretch` times the edge's length in space. Throws as tool_metric.
std::vector<double> edge_lengths_by_normals(const TriangleMesh& mesh, const SmoothNormals& normals, double tool_radius,
                                            double least_stretch = 0.25);

}  // namespace isopath
