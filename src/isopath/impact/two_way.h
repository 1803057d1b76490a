#pragma once

#include <span>
#include <vector>

#include "isopath/contour/isolines.h"
#include "isopath/core/progress.h"
#include "isopath/impact/surface_curve.h"

namespace isopath {

/// Joins contours a spacing apart into closed curves, one for every connected part of the surface (paper ch. 7.3: the
/// contour graph is walked depth first and every edge is used exactly twice). Along a spanning tree of the graph of
/// neighbours, both passes are cut at facing places and two rungs lead across: every pass is walked as a whole except
/// for its cuts, every tree edge is crossed once there and once back, and the curve ends where it began. The first
/// point of each curve is repeated at its end. Throws Error(cancelled) on request.
std::vector<SurfaceCurve> two_way(const SurfaceLinker& linker, std::span<const Contour> contours, double spacing,
                                  Progress& progress = Progress::none());

/// The same for a curve from one place to another and closed contours beside it: each of these is inserted into the
/// curve by a joint, so that it keeps its ends. More than one curve comes back where a contour lies on another
/// component.
std::vector<SurfaceCurve> joined_to_curve(const SurfaceLinker& linker, const SurfaceCurve& curve,
                                          std::span<const Contour> contours, double spacing,
                                          Progress& progress = Progress::none());

}  // namespace isopath
