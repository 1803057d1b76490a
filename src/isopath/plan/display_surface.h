#pragma once

#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/surface_function.h"
#include "isopath/mesh/refine.h"

namespace isopath {

/// The surface as a report shows it: fine enough that values which are linear between its vertices look like the
/// functions they stand for, whatever the size of the part's own triangles.
struct DisplaySurface {
  RefinedMesh refined;
  std::vector<double> distances;  ///< at its vertices, mm
  std::vector<double> gap;        ///< at its vertices, mm
};

/// The part with its edges halved to a fraction of the spacing that shows every pass, or as near to it as some 350000
/// triangles allow, or a share of so many.
RefinedMesh refine_for_display(const TriangleMesh& mesh, double spacing, double share = 1);

/// The function at the vertices of a refined mesh; `at_old_vertices` are its values at those of the old one. Throws
/// Error(cancelled) on request.
std::vector<double> values_at_vertices(const SurfaceFunction& function, const RefinedMesh& refined,
                                       std::span<const double> at_old_vertices, const Progress& progress);

/// Values that are known at the old vertices only, linear inside the old faces.
std::vector<double> interpolated(const TriangleMesh& mesh, std::span<const double> at_old_vertices,
                                 const RefinedMesh& refined);

}  // namespace isopath
