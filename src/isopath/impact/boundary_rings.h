#pragma once

#include <span>
#include <vector>

#include "isopath/contour/isolines.h"
#include "isopath/impact/ring.h"

namespace isopath {

/// Closed curves from contours. Closed contours are taken as they are. The ends of open ones follow one another along
/// the boundary loops: every second stretch of a loop between two ends is added, the shorter choice of the two, so
/// that every end has one partner. Where ends cannot be paired (an end inside the surface, an odd number on a loop),
/// the contour is walked to and back. Contours without length are left out.
std::vector<Ring> rings_of(const TriangleMesh& mesh, std::span<const Contour> contours);

}  // namespace isopath
