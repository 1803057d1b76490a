#pragma once

#include <array>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/mesh/triangle_soup.h"

namespace isopath {

/// Pairs of triangles that cross or overlap, lower index first, in ascending order.
/// An edge of one must pass through the other, or both must overlap in their common plane; touching does not count, nor
/// do triangles that share an edge. Of two that share a vertex, the edges opposite to it are looked at. Every index
/// must be in range and every coordinate usable.
std::vector<std::array<Index, 2>> find_self_intersections(const TriangleSoup& soup,
                                                          Progress& progress = Progress::none());

}  // namespace isopath
