#pragma once

#include <array>
#include <vector>

#include "isopath/impact/ring.h"

namespace isopath {

/// Two rings become one: on each the stretch from `low` to `high` is left out, and two rungs lead across.
struct RingJoint {
  struct Cut {
    Index ring = no_index;
    double low = 0;   ///< arc where the ring is left, mm
    double high = 0;  ///< arc where it is taken up again
  };
  std::array<Cut, 2> cuts;
  /// True when the rungs lead from low to high and from high to low, else from low to low and from high to high.
  bool crosswise = false;
  /// From the first cut's ring to the second one's; the first rung starts at the first cut's `low`.
  std::array<SurfaceCurve, 2> rungs;
};

/// Joints that make one tree of all rings that can be joined on the surface: neighbours about one spacing apart first,
/// at places where both run straight and side by side, away from other joints. Throws Error(cancelled) on request.
std::vector<RingJoint> choose_joints(const SurfaceLinker& linker, const std::vector<Ring>& rings, double spacing,
                                     Progress& progress);

}  // namespace isopath
