#pragma once

#include <span>

#include "isopath/contour/isolines.h"
#include "isopath/core/progress.h"
#include "isopath/impact/surface_curve.h"

namespace isopath {

/// Turns nested closed contours into one spiral (paper ch. 7.1). The first and the last contour are walked whole;
/// between two consecutive ones the curve crosses the strip between them along its diagonal, at each rung on the level
/// that its share of the turn asks for, so that neighbouring turns keep the contours' distance everywhere. `contours`
/// in the order to be walked; the curve starts at the first one's point nearest to `start`.
///
/// Where no strip exists between two contours, the contour in between is inserted and both halves are tried; where that
/// fails too, the next contour is walked whole, after a link on the surface. Throws Error(cancelled) on request.
SurfaceCurve spiral(const SurfaceLinker& linker, const SurfaceFunction& function,
                    std::span<const Contour* const> contours, const Vec3& start,
                    const Progress& progress = Progress::none());

}  // namespace isopath
