#pragma once

#include <vector>

#include "isopath/impact/ring.h"

namespace isopath {

/// Rings become one where they lie side by side: on each a stretch from `low` to `high` is left out, and rungs lead
/// from end to end. Between two rings these are two rungs side by side. Of more rings in a row, every ring is joined to
/// the next one on one side and on the other by turns, so that they become one long meander, and between both sides the
/// last rung, the lane, leads back from the last ring to the first one.
struct RingJoint {
  struct Cut {
    Index ring = no_index;
    double low = 0;   ///< arc where the ring is left, mm
    double high = 0;  ///< arc where it is taken up again
  };
  struct End {
    Index cut = no_index;
    bool high = false;
    bool operator==(const End&) const = default;
  };
  struct Rung {
    End from;
    End to;
    SurfaceCurve curve;
  };
  std::vector<Cut> cuts;    ///< two or more, all of different rings
  std::vector<Rung> rungs;  ///< as many; each end of a cut belongs to one of them
};

/// Joints that make one tree of all rings that can be joined on the surface: first as many in a row as lie side by side
/// a spacing apart, then neighbours two by two; at places where they run straight, away from other joints. Throws
/// Error(cancelled) on request.
std::vector<RingJoint> choose_joints(const SurfaceLinker& linker, const std::vector<Ring>& rings, double spacing,
                                     Progress& progress);

}  // namespace isopath
