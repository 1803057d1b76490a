#pragma once

#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// The curve of a patch as it lies on the whole mesh.
struct PatchCurve {
  Index patch = 0;
  /// What lies between its lifts, in order; none is empty.
  std::vector<std::vector<ImpactPoint>> stretches;
  /// One stretch whose last point is its first.
  bool closed = false;
};

/// The curves of all patches as one.
struct PatchChain {
  ImpactCurve curve;
  std::vector<Index> order;  ///< of `curves`, as the chain first comes to them
  int blocked_lifts = 0;     ///< for which no clear way was found
};

struct PatchLinkOptions {
  double spacing = 0;    ///< mm, > 0
  double clearance = 0;  ///< of lifts, mm; 0 takes the spacing
};

/// Strings the curves of patches together. A closed curve is an excursion from a curve of a neighbouring patch, where
/// the two run side by side: out by a short link, once round, and back; so closed curves need no lifts among each
/// other. What is left is put in an order with short ways, each curve entered at either end, and connected by links on
/// the surface up to 8 spacings long or else by lifts. `patch_of_face` tells which patches are neighbours.
/// Throws Error(cancelled) on request.
PatchChain chain_patches(const TriangleMesh& mesh, std::span<const Index> patch_of_face, std::vector<PatchCurve> curves,
                         const PatchLinkOptions& options, Progress& progress = Progress::none());

}  // namespace isopath
