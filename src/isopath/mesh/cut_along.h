#pragma once

#include <span>
#include <vector>

#include "isopath/mesh/refine.h"
#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// A mesh of the same surface whose edges hold given lines.
struct CutMesh {
  RefinedMesh refined;
  std::vector<char> is_cut;  ///< for each edge of the refined mesh: whether it is part of a line
};

/// Divides the faces that lines pass through, so that every line becomes a chain of edges. Lines may cross each other
/// and themselves. A point nearer to a vertex or an edge than 1e-6 of the face's longest side goes to it, so that no
/// needles arise; else lines keep their place, and the faces that no line passes are left as they are.
/// Throws Error(internal) where consecutive points of a line share no face.
CutMesh cut_along(const TriangleMesh& mesh, std::span<const std::vector<SurfacePoint>> lines);

/// The surface cut open along some of its edges, which become boundary on both sides. Faces keep their numbers, and so
/// does one vertex of each that becomes several; the others are appended.
TriangleMesh opened_along(const TriangleMesh& mesh, std::span<const char> is_cut);

}  // namespace isopath
