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
};

/// A short stretch of the curve drawn out towards an open spot, so far that nothing in the spot is farther than
/// `limit` from it: the shortest one found. None where the spot is too large for one such bump. Limit and spacing are
/// in the lengths of the cover's field.
std::optional<Replacement> bump_into(const SurfaceLinker& linker, const SmoothNormals& normals,
                                     const ImpactCurve& curve, const CoverField& cover, const OpenSpot& spot,
                                     double limit, double spacing);

}  // namespace isopath
