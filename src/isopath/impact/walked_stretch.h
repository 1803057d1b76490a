#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/impact/surface_curve.h"
#include "isopath/mesh/normals.h"

namespace isopath {

/// A point of a curve on the surface that is being redrawn.
struct CurveNode {
  SurfacePoint at;
  Vec3 position = Vec3::Zero();
  MoveKind kind = MoveKind::cover;  ///< of the move that arrives
};

/// A stretch of a curve on the surface with arc length as parameter.
class WalkedStretch {
 public:
  WalkedStretch(const TriangleMesh& mesh, std::vector<CurveNode> nodes);

  std::size_t size() const { return nodes_.size(); }
  double length() const { return arc_.back(); }
  double arc(std::size_t i) const { return arc_[i]; }
  const CurveNode& node(std::size_t i) const { return nodes_[i]; }
  /// The first node behind an arc.
  std::size_t behind(double arc) const;
  CurveNode at(double arc) const;
  /// The nodes between two arcs, and one at each of these.
  std::vector<CurveNode> part(double from, double to) const;
  /// Nodes at most `step` apart, at least six of them, both ends included.
  std::vector<CurveNode> sampled(double step) const;

 private:
  const TriangleMesh& mesh_;
  std::vector<CurveNode> nodes_;
  std::vector<double> arc_;
};

/// Turn of the way from a over b to c in the tangent plane, and the mean length of its two parts.
struct Turn {
  Vec3 before = Vec3::Zero();
  Vec3 behind = Vec3::Zero();
  double angle = 0;
  double step = 0;
  double radius() const;
};
Turn turn_at(const TriangleMesh& mesh, const CurveNode& a, const CurveNode& b, const CurveNode& c);

/// The curve through nodes, by way of the surface.
std::vector<CurveNode> joined(const SurfaceLinker& linker, const std::vector<CurveNode>& band);
/// Without the nodes that legs and arcs do not need: each that is left out lies within the tolerance of the chord in
/// its face.
std::vector<CurveNode> thinned(const TriangleMesh& mesh, const std::vector<CurveNode>& nodes, double tolerance);

/// Maximal runs of points on the surface: from the first index to before the second.
std::vector<std::pair<std::size_t, std::size_t>> runs_on_surface(const ImpactCurve& curve);
/// A run without points that come twice in a row: the turn there is that between their neighbours.
std::vector<CurveNode> nodes_of(const ImpactCurve& curve, std::size_t first, std::size_t end);
/// Puts new nodes, which start and end where the old ones do, in the place of each run.
void replace_runs(const SmoothNormals& normals, ImpactCurve& curve, const std::vector<std::vector<CurveNode>>& runs);

}  // namespace isopath
