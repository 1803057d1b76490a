#pragma once

#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/mesh/surface_locator.h"

namespace isopath {

/// A move through the air between two points of the surface. Lengths in mm.
struct LiftPath {
  std::vector<Vec3> way_points;  ///< in order, without the two points themselves
  double length = 0;             ///< of the whole move, from point to point
  bool clear = false;            ///< true when no leg of it meets the surface
};

/// A way from `p` to `q` that does not pass through the part; `np` and `nq` are the unit normals there.
///
/// Retracts along the normals and hops straight, at the shortest clear combination of 1, 2, 4 and 8 times the
/// clearance. Where the part is in the way of all of these, goes out to a sphere around the bounding box `bounds`,
/// along a great circle, and in again. The moving thing is a point; the first thousandth of the clearance above the
/// surface is not tested. When nothing clear is found, the way over the sphere along the normals is returned with
/// `clear` unset. Throws Error(bad_usage) unless the clearance is positive.
LiftPath lift_between(const SurfaceLocator& surface, const Box3& bounds, const Vec3& p, const Vec3& np, const Vec3& q,
                      const Vec3& nq, double clearance);

}  // namespace isopath
