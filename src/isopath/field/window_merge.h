#pragma once

#include <algorithm>

#include "isopath/field/window.h"

namespace isopath {

/// How much merging may change.
struct MergeLimits {
  double accuracy = 0;      ///< most that any distance may be off in the end
  double size = 0;          ///< of the model; rounding is relative to it
  double reach = infinity;  ///< about the distance at which the accuracy may be used up

  /// Errors add up on the way. Handing them out evenly leaves far windows as much as near ones.
  double allowed_at(double distance) const { return accuracy * std::clamp(distance / reach, 0.0, 1.0); }
};

/// One window in place of two of an edge that enter the same face; the left one begins and ends first, and no gap is
/// between them. After Surazhsky et al. 2005, with a bound. False, with `merged` untouched, where distances
/// would change by more than the limits allow, as Window::error tells. `merged` may be one of the two.
///
/// Distances behind an edge are the least of distance on the edge plus way from there, so a change on the edge changes
/// everything behind by no more, and the errors along a path add up. That holds as long as the beams leave no gap:
/// distances at the outer ends stay as they are, and the outer rays turn outwards if at all. Then the distance along
/// the edge stays continuous, and where its slope jumps it drops, as at a tie, which no shortest way passes.
///
/// Two parts of one front, cut at a vertex where the surface is flat, become one again whatever the accuracy. Roots are
/// not compared otherwise: the wider window gives the root.
bool merge_windows(const Window& left, const Window& right, const MergeLimits& limits, Window& merged);

}  // namespace isopath
