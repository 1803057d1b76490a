#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/surface_function.h"

namespace isopath {

/// The least and the greatest finite value of a function on the whole surface, insides of faces included.
struct ValueRange {
  double low = infinity;
  double high = -infinity;
  bool empty() const { return low > high; }
};

/// Both ends are values the function takes, within `tolerance` of the true extremes: faces are divided as long as the
/// function's slope allows more than was found (branch and bound). Faces with a corner that is not reached are left
/// out. Throws Error(cancelled) on request.
ValueRange value_range(const TriangleMesh& mesh, const SurfaceFunction& function, double tolerance,
                       const Progress& progress = Progress::none());

/// For each face whether the function may come up to `level` somewhere in it; where it says no, that is proven by the
/// function's slope. Never for faces with a corner that is not reached. Throws Error(cancelled) on request.
std::vector<char> faces_that_may_reach(const TriangleMesh& mesh, const SurfaceFunction& function, double level,
                                       const Progress& progress = Progress::none());

}  // namespace isopath
