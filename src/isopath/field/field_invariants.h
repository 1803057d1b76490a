#pragma once

#include <span>

#include "isopath/field/window.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

struct ExactFieldData;

/// What the windows of an edge have to agree with.
struct EdgeOfField {
  Index edge = no_index;
  Index halfedge = no_index;  ///< canonical
  Index twin = no_index;      ///< of the canonical half-edge; none on the boundary
  double length = 0;
  double distance_at_start = infinity;  ///< of the vertex that the canonical half-edge leaves
  double distance_at_end = infinity;
  double size = 0;    ///< of the model
  Index n_roots = 0;  ///< number of source elements
};

/// Throws Error(internal), with the edge and the window in it, unless
/// - the windows tile the edge from end to end, without gap or overlap, or there are none and both ends are unreached;
/// - each window has finite distances, none below zero, and the root of a source element;
/// - a window that goes on into a face comes from the other side of the edge, so that its rays lie in that face's cone;
/// - two windows agree on the distance where they meet, and those at the ends with the vertices.
///
/// Positions are compared within two snap widths, distances within these, 1e-9 relative and 1e-11 of the model
/// (and what merging windows may have changed): see docs/robustness.md.
void verify_edge_windows(const EdgeOfField& edge, std::span<const Window> windows);

/// The same for all edges that lie within the stop distance of the field.
void verify_windows(const ExactFieldData& data);

}  // namespace isopath
