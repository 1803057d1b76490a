#include "isopath/plan/smooth_part.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "isopath/contour/medial_axis.h"
#include "isopath/field/refine_for_field.h"
#include "isopath/field/smooth_field.h"
#include "isopath/field/surface_laplacian.h"

namespace isopath {
namespace {

constexpr double edges_over_length = 0.5;
/// As many triangles as a large part has anyway.
constexpr Index most_smoothed_triangles = 600000;
constexpr double interpolation_over_spacing = 0.05;
/// Most levels of refinement where the field has a kink: the triangles are half a spacing wide before it.
constexpr int most_levels = 3;
constexpr double width_over_distance = 0.5;
/// Twigs of the medial axis shorter than this times the clearance are no ridges.
constexpr double shortest_twig = 0.5;

}  // namespace

RefinedMesh refine_for_smoothing(const TriangleMesh& mesh, double spacing, double width) {
  const double length = std::clamp(width, least_smoothing_over_spacing * spacing, spacing);
  return split_long_edges(mesh, edges_over_length * length, std::max(most_smoothed_triangles, mesh.n_faces()));
}

std::vector<double> lengths_in(const TriangleMesh& mesh, const IntrinsicGeometry& metric, const RefinedMesh& refined) {
  const TriangleMesh& finer = refined.mesh;
  std::vector<double> lengths(finer.n_edges());
  for (Index e = 0; e < finer.n_edges(); ++e) {
    const Index h = finer.halfedge_of(e);
    const Index old = refined.old_face[h / 3];
    const auto place = [&](Index vertex) {
      return metric.in_frame(3 * old, express_in(mesh, refined.on_old[vertex], old).barycentric);
    };
    lengths[e] = (place(finer.to(h)) - place(finer.from(h))).norm();
  }
  return lengths;
}

void FineSurface::refine(RefinedMesh refined) {
  trail.add(mesh, refined);
  std::vector<double> lengths;
  if (metric) lengths = lengths_in(mesh, *metric, refined);
  mesh = std::move(refined.mesh);
  if (metric) metric.emplace(mesh, lengths);
}

FieldSamples sample_for_smoothing(const ExactField& field, double spacing, Progress& progress) {
  FieldSamples samples;
  RefinedField refined = refine_for_field(
      field.mesh(), field, {.tolerance = interpolation_over_spacing * spacing, .max_levels = most_levels}, progress);
  samples.refined = std::move(refined.refined);
  samples.distances = std::move(refined.value);
  progress.stage("medial axis");
  const BisectorGraph axis = medial_axis(field, {.prune = shortest_twig, .chord_tolerance = 0.01 * spacing}, progress);
  for (const BisectorGraph::Arc& arc : axis.arcs) {
    std::vector<SurfacePoint>& ridge = samples.ridges.emplace_back();
    for (const BisectorPoint& point : arc.points) ridge.push_back(point.point);
  }
  return samples;
}

std::vector<double> smoothed_distances(const TriangleMesh& mesh, const IntrinsicGeometry* metric,
                                       const std::vector<double>& distances, double width, Progress& progress) {
  progress.stage("smoothing");
  double farthest = 0;
  for (const double distance : distances) {
    if (std::isfinite(distance)) farthest = std::max(farthest, distance);
  }
  if (!(farthest > 0)) return distances;
  width = std::min(width, width_over_distance * farthest);  // more has no effect
  std::vector<double> local;
  local.reserve(distances.size());
  for (const double distance : distances) {
    const double share = std::min(1.0, width_over_distance * distance / width);
    local.push_back(share * share);
  }
  const SurfaceLaplacian laplacian =
      metric ? surface_laplacian(mesh, *metric, progress) : surface_laplacian(mesh, progress);
  return diffused(laplacian, distances, {.width = width, .local = local}, progress);
}

}  // namespace isopath
