#pragma once

#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_delaunay.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// The Laplacian of functions that are given at the vertices (paper ch. 9.2), by cotangents of the intrinsic Delaunay
/// triangulation: (Δf)_i = 1 / A_i Σ_j w_ij (f_j - f_i) with w_ij = (cot α + cot β) / 2 >= 0. On a flat surface it is
/// zero for linear functions at every vertex inside. The boundary is natural: nothing flows over it.
struct SurfaceLaplacian {
  struct Edge {
    Index a = no_index;
    Index b = no_index;
    double weight = 0;  ///< >= 0
  };
  std::vector<Edge> edges;
  std::vector<double> area;  ///< Voronoi area of every vertex, mm²; 0 for one without faces
  /// Vertices beyond those of the mesh, on its boundary edges.
  std::vector<IntrinsicTriangulation::AddedVertex> added;

  Index n_vertices() const { return static_cast<Index>(area.size() - added.size()); }  ///< those of the mesh
};

/// In space or in a metric. Throws Error(cancelled) on request.
SurfaceLaplacian surface_laplacian(const TriangleMesh& mesh, const Progress& progress = Progress::none());
SurfaceLaplacian surface_laplacian(const TriangleMesh& mesh, const IntrinsicGeometry& geometry,
                                   const Progress& progress = Progress::none());

/// Σ A_i f_i over the vertices whose value is finite: the volume under the function, mm² times its unit.
double volume_under(const SurfaceLaplacian& laplacian, std::span<const double> values);

}  // namespace isopath
