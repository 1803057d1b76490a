#pragma once

#include <utility>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/core/progress.h"

namespace isopath {

/// Pairs of indices into two polylines, from (0, 0) to the last of both, one of them advancing at a time: the rungs of
/// a strip of triangles between the polylines.
using Strip = std::vector<std::pair<Index, Index>>;

/// The strip of least total rung length between two polylines (Fuchs, Kedem & Uselton 1977, as a path in the grid
/// graph; paper ch. 7), found by A*. `gap` is the geodesic distance between the polylines: no rung counts as shorter.
/// Rungs longer than `longest` do not exist; empty when no strip is left. Memory grows with the number of rungs that
/// exist. Throws Error(cancelled) on request.
Strip least_strip(const std::vector<Vec3>& p, const std::vector<Vec3>& q, double gap, double longest,
                  const Progress& progress = Progress::none());

}  // namespace isopath
