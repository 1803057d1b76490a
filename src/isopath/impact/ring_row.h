#pragma once

#include <optional>
#include <span>

#include "isopath/impact/ring_joints.h"

namespace isopath {

/// Length of a cut in spacings w where rings are joined two by two. On the edge of the part, w/2 from the ring, the
/// nearest rung's foot is √(w² + c²) / 2 away; where its corner is rounded with the radius r it is
/// √((c/2 + r)² + (w/2 + r)²) - r: this and 0.08 w keep the gap there at 1.05 w.
inline constexpr double cut_over_spacing = 0.18;

/// A place on a ring.
struct RingPlace {
  Index ring = no_index;
  double arc = 0;
};

/// The joint of rings that face each other one after the other at these places, two or more. None where the surface
/// has no straight ways between them, or rings are too short for their cuts.
std::optional<RingJoint> joint_of_row(const TriangleMesh& mesh, const std::vector<Ring>& rings,
                                      std::span<const RingPlace> row, double spacing);

/// The way along a plane section of the surface; none where that is longer than so many times the straight way.
std::optional<SurfaceCurve> straight_rung(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                          double most_detour);

}  // namespace isopath
