#pragma once

#include "isopath/contour/blend.h"

namespace isopath {

/// The paper's own form of `blend` (ch. 11), in closed form: with τ the distance along the axis from its root and h_R
/// the largest τ + D_S of its leaves, D* = 1 - τ / h_R on the axis, D_MA = D_S τ / (h_R - τ) there, and
/// D* = D_S / (D_S + D_MA) everywhere. The root is where h_R is least; arcs of the axis that end on the boundary are
/// left out. Values are D* times so many spacings as its levels have to be for the spacing to be kept.
/// Throws Error(no_plan) for a part without boundary, Error(cancelled) on request.
BlendedField paper_blend(const TriangleMesh& mesh, double spacing, const Progress& progress);

}  // namespace isopath
