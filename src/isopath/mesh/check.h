#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/mesh/triangle_soup.h"

namespace isopath {

/// What can be wrong with triangles. The comment says what one element of Defect::first is.
enum class DefectKind {
  index_out_of_range,        ///< triangle
  non_finite_coordinate,     ///< vertex with a NaN or infinite coordinate
  overflowing_coordinate,    ///< vertex with a coordinate beyond largest_coordinate
  repeated_vertex,           ///< triangle that uses a vertex twice
  zero_area,                 ///< triangle whose height is within the tolerance
  duplicate_triangle,        ///< triangle, and the earlier one with the same vertices (either way round)
  non_manifold_edge,         ///< the two vertices of an edge with more than two triangles
  inconsistent_orientation,  ///< the two vertices of an edge whose two triangles are oriented oppositely
  non_manifold_vertex,       ///< vertex whose triangles form more than one fan
  self_intersection,         ///< two triangles that cross; looked for on request
  sliver,                    ///< triangle with an aspect beyond the limit
  duplicate_position,        ///< vertex, and the earlier one at the same position
  unreferenced_vertex,       ///< vertex that no triangle uses
};

/// The kind as it stands in reports: "non_manifold_edge".
std::string_view name_of(DefectKind kind);

enum class Severity {
  error,    ///< TriangleMesh refuses it, or it is not a surface: repair first
  warning,  ///< results suffer
  note,     ///< harmless
};

std::string_view name_of(Severity severity);

struct Defect {
  DefectKind kind = DefectKind::index_out_of_range;
  Severity severity = Severity::error;
  Index count = 0;
  std::vector<std::vector<Index>> first;  ///< the first few, in the order of the input
};

struct BoundaryLoop {
  double length = 0;  ///< edges with unusable coordinates count nothing
  Index edges = 0;
  Index first_vertex = no_index;
  bool closed = true;  ///< false when it ends at a non-manifold edge
};

struct CheckOptions {
  Index listed = 5;                 ///< so many first elements of each kind, ≥ 0
  double sliver_aspect = 1000;      ///< a sliver's longest edge is at least so many times its height, > 1
  bool self_intersections = false;  ///< look for triangles that cross, too

  /// Throws Error(bad_usage) when a value is out of its range.
  void validate() const;
};

struct MeshReport {
  Index triangles = 0;
  Index vertices = 0;
  Index edges = 0;
  double area = 0;          ///< mm², of the triangles with usable coordinates
  Box3 bounds;              ///< of the usable positions
  Index components = 0;     ///< pieces of triangles joined by edges
  double largest_area = 0;  ///< mm², of the component with the most
  bool closed = false;      ///< every edge has two triangles or more
  bool manifold = false;
  bool orientable = false;                   ///< its manifold edges allow a consistent orientation
  Index euler_characteristic = 0;            ///< referenced vertices − edges + triangles
  std::optional<Index> genus;                ///< sum over the components; only for a manifold, orientable surface
  std::vector<BoundaryLoop> boundary_loops;  ///< longest first
  std::vector<Defect> defects;               ///< in the order of DefectKind; kinds that do not occur are absent

  /// The defect of this kind, or nullptr.
  const Defect* find(DefectKind kind) const;
  /// How often the kind occurs.
  Index count(DefectKind kind) const;
  /// True when no defect is an error: TriangleMesh accepts the soup, if it is not below smallest_size as a whole.
  bool sound() const;
};

/// Describes triangles and everything that is wrong with them. It accepts any soup.
/// A triangle has no area when its height is within Tolerance::of_size() of the bounding box's diagonal.
MeshReport check_mesh(const TriangleSoup& soup, const CheckOptions& options = {},
                      Progress& progress = Progress::none());

}  // namespace isopath
