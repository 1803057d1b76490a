#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "isopath/core/tolerance.h"
#include "isopath/mesh/disjoint_sets.h"
#include "isopath/mesh/repair.h"
#include "isopath/mesh/weld.h"

namespace isopath {

/// What the steps of repair_mesh() work on. Vertices are only added, and merged through `merged`, until the end.
struct RepairState {
  explicit RepairState(TriangleSoup input);

  TriangleSoup soup;
  DisjointSets merged;  ///< vertices that became one; triangles use the roots
  Tolerance tolerance;
  double largest_extent = 0;  ///< largest absolute value of a usable coordinate
  std::vector<RepairChange> changes;
  std::optional<PointWelder> taken;         ///< positions in use, made when the first vertex is added
  std::optional<PointWelder> taken_single;  ///< the same in single precision

  /// Records a change; counts of the same kind add up.
  void note(std::string_view what, std::size_t count);
  /// Adds a vertex at the first of `position`, `position + move`, `position + 2 move`, … where no other is, in single
  /// precision if that can be had. With `move` zero it is added where it is.
  Index add_vertex(const Vec3& position, const Vec3& move);
  /// Removes triangles that are marked.
  void drop(const std::vector<char>& marked, std::string_view what);
};

void drop_unusable_triangles(RepairState& state);
void weld_vertices(RepairState& state);
void drop_repeated_vertices(RepairState& state);
void drop_duplicate_triangles(RepairState& state);

/// `force`: drop what is left instead of collapsing or splitting, so that the passes come to an end.
void remove_zero_area(RepairState& state, bool force);

/// Orients, cuts one-sided surfaces, and splits edges and vertices that are not manifold.
void make_manifold(RepairState& state, double separation, bool force);

void keep_largest_component(RepairState& state);
void fill_holes(RepairState& state, double longest, Index most_edges, Progress& progress);

}  // namespace isopath
