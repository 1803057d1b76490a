#include "isopath/plan/scallop_metric.h"

#include <fmt/format.h>

#include <utility>

#include "isopath/field/warp.h"
#include "isopath/mesh/normals.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

/// Shares of less than this are single vertices at a rough edge.
constexpr double least_share_to_tell = 1e-4;

/// An error of a fifth in such a length moves no pass by more than a twentieth of the pitch.
constexpr double smallest_in_pitches = 0.25;

/// A vertex stands for a third of the area of its faces.
double share_of(const TriangleMesh& mesh, const std::vector<Index>& vertices) {
  std::vector<char> named(mesh.n_vertices(), 0);
  for (const Index v : vertices) named[v] = 1;
  double part = 0;
  double whole = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const double area = mesh.face_area(f);
    whole += area;
    for (const Index v : mesh.triangle(f)) part += named[v] ? area / 3 : 0;
  }
  return whole > 0 ? part / whole : 0;
}

}  // namespace

ScallopMetric scallop_metric(const TriangleMesh& mesh, std::span<const PrincipalCurvatures> curvatures,
                             double ball_radius, double pitch, Progress& progress) {
  progress.stage("metric");
  const ToolMetric tool = tool_metric(curvatures, ball_radius);
  WarpedSurface surface = warp_surface(mesh, tool.tensors, {.shortest_edge = smallest_in_pitches * pitch}, progress);
  ScallopMetric metric;
  metric.clamped_fraction = share_of(mesh, tool.clamped);
  metric.gouged_fraction = share_of(mesh, tool.gouged);
  metric.mesh = std::move(surface.refined.mesh);
  metric.old_face = std::move(surface.refined.old_face);
  metric.edge_lengths = std::move(surface.edge_lengths);
  if (metric.gouged_fraction > least_share_to_tell) {
    metric.warnings.push_back(fmt::format(
        "the ball does not fit on {:.2g} % of the area, where the part is hollower than its radius of {} mm: "
        "it gouges there; take a smaller ball",
        100 * metric.gouged_fraction, ball_radius));
  } else if (metric.clamped_fraction > least_share_to_tell) {
    metric.warnings.push_back(fmt::format(
        "on {:.2g} % of the area the part is almost as hollow as the ball; passes are closer there than the "
        "scallop asks for",
        100 * metric.clamped_fraction));
  }
  if (surface.added_length > 0) {
    metric.warnings.push_back(fmt::format(
        "the curvature changes too fast for the mesh at {} triangles: {:.2g} mm was added to all lengths, so "
        "that scallops are smaller than asked for",
        surface.broken_faces, surface.added_length));
  }
  return metric;
}

FittedPart::FittedPart(const TriangleMesh& part, double pitch)
    : mesh(part), fit(fit_surface(mesh, SmoothNormals(mesh), pitch)) {}

CurvedSurface surface_over(const FittedPart& part, const TriangleMesh& finer) {
  return CurvedSurface(part.mesh, part.fit).over(part.mesh, finer);
}

void take_normals(const CurvedSurface& surface, ImpactCurve& curve) {
  for (ImpactPoint& point : curve.points) {
    if (point.at.valid()) point.normal = surface.at(point.at).normal;
  }
}

double cover_length(const TriangleMesh& mesh, const ImpactCurve& curve, const IntrinsicGeometry& metric) {
  double sum = 0;
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    const ImpactPoint& a = curve.points[i - 1];
    const ImpactPoint& b = curve.points[i];
    if (b.kind != MoveKind::cover || !a.at.valid() || !b.at.valid()) continue;
    const Index face = common_face(mesh, a.at, b.at);
    if (face == no_index) continue;
    const auto place = [&](const SurfacePoint& point) {
      return metric.in_frame(3 * face, express_in(mesh, point, face).barycentric);
    };
    sum += (place(b.at) - place(a.at)).norm();
  }
  return sum;
}

double area_in(const TriangleMesh& mesh, const IntrinsicGeometry& metric) {
  double sum = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) sum += metric.face_area(f);
  return sum;
}

}  // namespace isopath
