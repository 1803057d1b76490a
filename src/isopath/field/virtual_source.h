#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/fan_layout.h"
#include "isopath/field/source.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// `virtual_source_distances` with what depends on the mesh alone prepared once, for many sources. The mesh must
/// outlive it.
class VirtualSourceSolver {
 public:
  explicit VirtualSourceSolver(const TriangleMesh& mesh) : mesh_(mesh), fans_(mesh) {}

  /// As `virtual_source_distances`; takes a twentieth to a tenth less time.
  std::vector<double> distances(const SourceSet& sources, Progress& progress = Progress::none()) const;

 private:
  const TriangleMesh& mesh_;
  FanLayout fans_;
};

/// Distances in mm at every vertex by virtual source propagation (after P. Trettner, D. Bommes, L. Kobbelt: Geodesic
/// distance computation via virtual source propagation, Computer Graphics Forum 40, 2021); infinity where no source
/// reaches. A vertex keeps one number beside its distance: the part of the way that lies behind the centre of the front
/// that came. Through an edge whose ends are reached goes the front that fits both distances: a circle about a virtual
/// source, or a straight line where it began at segments, so that boundaries and polylines are true lines.
///
/// Never longer than the way along edges, up to rounding. Almost always exact up to rounding from a point on a convex
/// flat part, or one that unfolds into it, as long as fronts do not meet. Elsewhere distances err to either side, and
/// there is no bound: the mean relative error is 0.002 % to 0.2 % on scans and smooth sheets, the largest a few
/// percent, where fronts meet and in the shadow of reflex corners; more on parts of few long triangles: see
/// docs/distance-fields.md. `checked_distances` asks for a
/// bound.
///
/// Works in single precision on lengths relative to the mean edge: expect relative rounding errors of 1e-6, on meshes
/// whose edges are of very different lengths of 1e-5. Takes O(n) time for n vertices at edges of about one length.
/// Throws Error(bad_usage) for an empty source set, Error(cancelled) on request.
std::vector<double> virtual_source_distances(const TriangleMesh& mesh, const SourceSet& sources,
                                             Progress& progress = Progress::none());

}  // namespace isopath
