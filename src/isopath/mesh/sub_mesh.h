#pragma once

#include <span>
#include <vector>

#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Some faces of a mesh as a mesh of their own. Corners keep their order, so that barycentric coordinates mean the same
/// in both.
struct SubMesh {
  TriangleMesh mesh;
  std::vector<Index> face;    ///< of the whole mesh, for each face
  std::vector<Index> vertex;  ///< of the whole mesh, for each vertex

  /// A point of this mesh on the whole one. An invalid point stays invalid.
  SurfacePoint on_whole(const SurfacePoint& point) const {
    return point.valid() ? SurfacePoint{face[point.face], point.barycentric} : point;
  }
};

/// The connected parts that a mesh falls into when it is cut along edges: a label for every face, counted from 0 in the
/// order of the parts' first faces. A cut that does not lead all round separates nothing. `is_cut` holds one value for
/// each edge.
std::vector<Index> parts_between_cuts(const TriangleMesh& mesh, std::span<const char> is_cut);

/// Some faces, in ascending order, as a mesh. Faces stay joined at all edges they share. Where they only share a vertex
/// that does not join them, it becomes several. Takes no longer than those faces ask for, however large the mesh is.
SubMesh sub_mesh(const TriangleMesh& mesh, std::span<const Index> faces);

/// One mesh for each label from 0 on; `part_of_face` holds a label for every face: the same as
/// `sub_mesh` of each label's faces.
std::vector<SubMesh> split_mesh(const TriangleMesh& mesh, std::span<const Index> part_of_face);

}  // namespace isopath
