#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// A coordinate that counts turns around a hole: harmonic, growing by 1 on every way once round it. What level sets of
/// nested closed curves are to a surface's first coordinate, this is to its second.
struct TurnAngle {
  std::vector<double> turn;  ///< at every vertex; known up to whole turns, and up to one constant for each component
  std::vector<char> hole;    ///< faces that are left out, as the holes that turns are counted around
};

/// For every component, around the hole that `inner_faces` and `outer_faces` lie at: two faces of each component, or
/// `no_index` for a component to leave out. A face without an edge on the boundary becomes a hole itself, another one
/// lies beside the boundary loop that bounds the annulus on this side. Every component must become an annulus so.
/// Throws Error(internal) when there is no way between the two faces of a component, Error(cancelled) on request.
TurnAngle turn_angle(const TriangleMesh& mesh, const std::vector<Index>& inner_faces,
                     const std::vector<Index>& outer_faces, const Progress& progress = Progress::none());

}  // namespace isopath
