#include "isopath/field/surface_laplacian.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace isopath {

SurfaceLaplacian surface_laplacian(const TriangleMesh& mesh, const Progress& progress) {
  return surface_laplacian(mesh, IntrinsicGeometry(mesh), progress);
}

SurfaceLaplacian surface_laplacian(const TriangleMesh& mesh, const IntrinsicGeometry& geometry,
                                   const Progress& progress) {
  IntrinsicTriangulation triangulation = intrinsic_delaunay(mesh, geometry, progress);
  SurfaceLaplacian laplacian;
  laplacian.area.assign(triangulation.n_vertices, 0);
  for (Index h = 0; h < triangulation.n_halfedges(); ++h) {
    const Index twin = triangulation.twin[h];
    if (twin != no_index && twin < h) continue;
    const Index a = triangulation.tail[h];
    const Index b = triangulation.tail[TriangleMesh::next(h)];
    const double cotangents = triangulation.cotangent(h) + (twin == no_index ? 0 : triangulation.cotangent(twin));
    // negative by rounding only, and on boundary edges of sharp corners that were not divided any more
    const double weight = std::max(0.0, 0.5 * cotangents);
    // the parts of the two Voronoi cells in the diamond over the edge: half its length times half the dual edge, each
    const double part = 0.25 * weight * triangulation.length[h] * triangulation.length[h];
    laplacian.area[a] += part;
    laplacian.area[b] += part;
    if (a != b && weight > 0) laplacian.edges.push_back({a, b, weight});
  }
  laplacian.added = std::move(triangulation.added);
  return laplacian;
}

double volume_under(const SurfaceLaplacian& laplacian, std::span<const double> values) {
  double sum = 0;
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (std::isfinite(values[v])) sum += laplacian.area[v] * values[v];
  }
  return sum;
}

}  // namespace isopath
