#pragma once

#include <utility>
#include <vector>

#include "isopath/impact/surface_curve.h"

namespace isopath {

/// Pairs of indices into two polylines, from (0, 0) to the last of both, one of them advancing at a time: the rungs of
/// a strip of triangles between the polylines.
using Strip = std::vector<std::pair<Index, Index>>;

/// The strip of least total rung length between two polylines (Fuchs, Kedem & Uselton 1977, as a path in the grid
/// graph; paper ch. 7), found by A*. `gap` is the geodesic distance between the polylines, so that no rung is shorter
/// and gap × remaining steps never overestimates. Rungs longer than `longest` do not exist; empty when no strip is
/// left.
Strip least_strip(const std::vector<Vec3>& p, const std::vector<Vec3>& q, double gap, double longest);

}  // namespace isopath
