#include "isopath/plan/display_surface.h"

#include <tbb/parallel_for.h>

namespace isopath {
namespace {

/// Gaps rise and fall once between neighbouring passes: three values on either slope show it without beats.
constexpr double edges_over_spacing = 1.0 / 6;
/// A page with so many triangles opens within seconds and weighs about as much as the path on it.
constexpr Index most_triangles = 350000;

}  // namespace

RefinedMesh refine_for_display(const TriangleMesh& mesh, double spacing, double share) {
  return split_long_edges(mesh, edges_over_spacing * spacing, static_cast<Index>(share * most_triangles));
}

std::vector<double> values_at_vertices(const SurfaceFunction& function, const RefinedMesh& refined,
                                       std::span<const double> at_old_vertices, const Progress& progress) {
  std::vector<double> values(at_old_vertices.begin(), at_old_vertices.end());
  values.resize(refined.on_old.size());
  tbb::parallel_for(at_old_vertices.size(), values.size(), [&](std::size_t v) {
    if (v % 256 == 0) progress.checkpoint();
    values[v] = function.value(refined.on_old[v]);
  });
  return values;
}

std::vector<double> interpolated(const TriangleMesh& mesh, std::span<const double> at_old_vertices,
                                 const RefinedMesh& refined) {
  std::vector<double> values(at_old_vertices.begin(), at_old_vertices.end());
  for (std::size_t v = values.size(); v < refined.on_old.size(); ++v) {
    const SurfacePoint& point = refined.on_old[v];
    const Triangle& corners = mesh.triangle(point.face);
    double value = 0;
    for (int i = 0; i < 3; ++i) {
      if (point.barycentric[i] != 0) value += point.barycentric[i] * at_old_vertices[corners[i]];
    }
    values.push_back(value);
  }
  return values;
}

}  // namespace isopath
