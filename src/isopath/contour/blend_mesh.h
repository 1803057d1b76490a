#pragma once

#include <span>

#include "isopath/core/progress.h"
#include "isopath/field/surface_function.h"
#include "isopath/mesh/refine.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// The same surface, fine enough for `blend` to work at its vertices: edges of a third of the spacing, and where fronts
/// meet so short that a distance which is linear in between is within a hundredth of the spacing, or edges are a
/// sixteenth of it. Old vertices keep their numbers. Takes the distances that are to be blended, on the old mesh.
/// Throws Error(cancelled) on request.
RefinedMesh refine_for_blend(const TriangleMesh& mesh, const SurfaceFunction& distance, double spacing,
                             const Progress& progress = Progress::none());

/// The same surface, finer where levels a spacing apart would lie closer together than the mesh's edges can tell.
/// Throws Error(cancelled) on request.
RefinedMesh refine_for_levels(const TriangleMesh& mesh, std::span<const double> values, double spacing,
                              const Progress& progress = Progress::none());

}  // namespace isopath
