#pragma once

#include "isopath/contour/bisector_graph.h"
#include "isopath/core/progress.h"
#include "isopath/field/exact_field.h"

namespace isopath {

struct VoronoiOptions {
  double chord_tolerance = 0;  ///< largest distance of a chord from its bisector; 0 takes 1e-4 of the model's size
  void validate() const;       ///< throws Error(bad_usage)
};

/// The Voronoi diagram of a field's source elements (paper ch. 8): the points that two roots are equally far from, and
/// no third is nearer. |d(p, root 0) - d(p, root 1)| <= 1e-9 × model size at every point of every arc. Elements of a
/// polyline are roots of their own. Where two of them share a point, ways to it are ways to both: nothing divides them
/// there.
/// The field must be exact (accuracy 0). Throws Error(bad_usage) for invalid options, Error(cancelled) on request.
BisectorGraph voronoi_diagram(const ExactField& field, const VoronoiOptions& options = {},
                              Progress& progress = Progress::none());

struct MedialAxisOptions {
  /// Least angle, radians, between the directions that two shortest paths arrive from. Every vertex that is convex,
  /// of a boundary or of the surface itself, starts a branch along which they differ by about its own turn; on finely
  /// divided round shapes these say nothing. In (0, π].
  double min_angle = 0.2;
  double prune = 0;            ///< see `pruned`: leaf arcs shorter than this times the clearance go; 0 keeps all
  double chord_tolerance = 0;  ///< largest distance of a chord from the axis; 0 takes 1e-4 of the model's size
  void validate() const;       ///< throws Error(bad_usage)
};

/// The medial axis of a field's sources (paper ch. 8): the points that two shortest paths reach from different
/// directions, be they of two roots or of one whose front meets itself behind a bump. Bisectors between a segment and
/// its own end point are no part of it, as both paths are the same there.
/// Points are as exact as those of voronoi_diagram. The field must be exact (accuracy 0). Throws Error(bad_usage) for
/// invalid options, Error(cancelled) on request.
BisectorGraph medial_axis(const ExactField& field, const MedialAxisOptions& options = {},
                          Progress& progress = Progress::none());

}  // namespace isopath
