#pragma once

#include <optional>

#include "isopath/impact/cover_field.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/impact/open_spots.h"
#include "isopath/impact/surface_curve.h"
#include "isopath/mesh/normals.h"

namespace isopath {

/// A way that takes the place of a stretch of a curve.
struct Replacement {
  Index first = 0;                  ///< the last point of the curve before the stretch
  Index last = 0;                   ///< the first one behind it
  std::vector<ImpactPoint> points;  ///< what lies between them from now on
  double added = 0;                 ///< about how much longer the curve becomes, mm
};

/// What bumps and turns have to keep, in the lengths of the cover's field unless said otherwise.
struct BumpLimits {
  double reach = 0;    ///< nothing in the spot is farther than this from the bump
  double spacing = 0;  ///< of the passes
  double radius = 0;  ///< the curve's corners are rounded with this radius afterwards, mm; tips go as far as that takes
  bool slim = false;  ///< bumps take as little away from the other side of the curve as they can
  const Progress& progress = Progress::none();
};

/// A short stretch of the curve drawn out towards an open spot, so far that all of the spot is in reach: the shortest
/// one found. None where the spot is too large for one such bump.
std::optional<Replacement> bump_into(const SurfaceLinker& linker, const SmoothNormals& normals,
                                     const ImpactCurve& curve, const CoverField& cover, const OpenSpot& spot,
                                     const BumpLimits& limits);

/// A stretch of the curve shifted towards an open spot so gently that it turns with no less than the radius: the lowest
/// swell that has all of the spot in reach. None where there is no such or the surface has no room.
std::optional<Replacement> swell_into(const SurfaceLinker& linker, const SmoothNormals& normals,
                                      const ImpactCurve& curve, const CoverField& cover, const OpenSpot& spot,
                                      const BumpLimits& limits);

/// A full turn on a circle of at least the radius that touches the curve, on the side of an open spot, for curves that
/// may have no corners: the smallest one that has the spot in reach, or one that has some of it. None where the surface
/// has no room for one or the curve no direction.
std::optional<Replacement> turn_into(const SurfaceLinker& linker, const SmoothNormals& normals,
                                     const ImpactCurve& curve, const CoverField& cover, const OpenSpot& spot,
                                     const BumpLimits& limits);

}  // namespace isopath
