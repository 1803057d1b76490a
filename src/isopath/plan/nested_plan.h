#pragma once

#include <optional>
#include <string>
#include <vector>

#include "isopath/contour/blend.h"
#include "isopath/core/progress.h"
#include "isopath/field/vertex_field.h"
#include "isopath/mesh/refine.h"

namespace isopath {

/// How the components of a part are bounded: what blended levels need to know.
enum class NestedShape {
  disc,     ///< every component is a disc, or closed and without handles
  annulus,  ///< one component with two boundary loops
  holes,    ///< no handles, and some component with more loops: discs once they are cut open, see hole_bridges.h
  handles,  ///< no level is one closed curve around all of them
};
NestedShape nested_shape_of(const TriangleMesh& mesh);

/// An annulus whose levels from loop to loop would be wasteful, as its width is uneven: cut open along the shortest way
/// between its loops where it is narrowest, so that it is a disc. None where the levels of an annulus serve, which have
/// no ends. `spacing` is that of the levels, mm. Throws Error(cancelled) on request.
std::optional<RefinedMesh> opened_annulus(const TriangleMesh& mesh, double spacing, Progress& progress);

/// A function whose levels (k - ½) × spacing are to be nested closed curves.
struct NestedField {
  std::vector<double> values;  ///< at the vertices, mm
  double spacing = 0;          ///< that the levels are to have, mm
};

/// The function with levels for a spiral, from the distances on a mesh that is fine enough (contour/blend_mesh.h).
/// `spacing` is the one to keep, `radius` what corners will be rounded with, see BlendOptions. Throws Error(no_plan)
/// for a part with more holes or handles, and what `blend` throws.
NestedField nested_field(BlendForm form, const ExactField& distance, double spacing, double radius, Progress& progress);

}  // namespace isopath
