#pragma once

#include <vector>

#include "isopath/field/source.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// The faces in which an element of a source lies: one, or the two beside the edge that carries it. Of a vertex, the
/// face it is given in and those across that face's edges at it.
std::vector<Index> faces_of(const TriangleMesh& mesh, const SourceElement& element);

/// Straight distance in space from an element to a point of a face that holds it: the distance in that face, in mm.
double distance_in_face(const TriangleMesh& mesh, const SourceElement& element, const Vec3& point);

}  // namespace isopath
