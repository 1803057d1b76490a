#pragma once

#include <vector>

#include "isopath/field/exact_field.h"
#include "isopath/impact/impact_curve.h"

namespace isopath {

/// The distance from the covering part of a curve: half the gap between passes.
struct CoverField {
  ExactField field;
  /// For every source element of the field, the point of the curve that its segment, or its point, starts at.
  std::vector<Index> curve_point;
};

/// Bound on the error of these distances, in spacings: no gap is off by more than twice this.
inline constexpr double cover_accuracy = 1e-4;

/// The covering moves of a curve as source: true segments. `curve_point`, where it is not null, becomes what it is in
/// CoverField. Throws Error(no_plan) when the curve covers nothing.
SourceSet cover_source(const TriangleMesh& mesh, const ImpactCurve& curve, std::vector<Index>* curve_point = nullptr);

/// The covering moves of a curve, as true segments. Throws Error(no_plan) when it covers nothing.
SourceSet cover_elements(const TriangleMesh& mesh, const ImpactCurve& curve);

/// The distance with `cover_accuracy`, in space or in a metric. Throws Error(no_plan) when the curve covers nothing,
/// Error(cancelled) on request.
CoverField distance_from_cover(const TriangleMesh& mesh, const ImpactCurve& curve, double spacing, Progress& progress,
                               const IntrinsicGeometry* metric = nullptr);
/// The distance in space from the moves between marked points alone, as far as `stop_distance`.
CoverField distance_from_part_of_cover(const TriangleMesh& mesh, const ImpactCurve& curve,
                                       const std::vector<char>& marked, double stop_distance, double spacing,
                                       Progress& progress);

}  // namespace isopath
