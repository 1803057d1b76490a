#pragma once

#include <optional>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/mesh/refine.h"
#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Corners rounded by less than that are corners to the tool, and a mesh fine enough for it would be huge.
inline constexpr double least_smoothing_over_spacing = 0.25;

/// The part with triangles small enough to smooth a field on by `width` and to plan passes on, mm: the longest edges
/// are halved until they are half as long as the smaller of the two, and no shorter than an eighth of the spacing.
RefinedMesh refine_for_smoothing(const TriangleMesh& mesh, double spacing, double width);

/// The lengths of a finer mesh's edges in a metric of the old mesh, for IntrinsicGeometry.
std::vector<double> lengths_in(const TriangleMesh& mesh, const IntrinsicGeometry& metric, const RefinedMesh& refined);

/// A finer mesh of a part, for functions that are given at vertices.
struct FineSurface {
  TriangleMesh mesh;
  std::optional<IntrinsicGeometry> metric = {};  ///< none: lengths in space
  RefinementTrail trail = {};                    ///< to the part's own mesh

  /// Makes it finer still, and the metric with it.
  void refine(RefinedMesh refined);
  const IntrinsicGeometry* geometry() const { return metric ? &*metric : nullptr; }
};

/// A mesh that a field's values at the vertices represent well, and these values.
struct FieldSamples {
  RefinedMesh refined;
  std::vector<double> distances;  ///< at its vertices, mm; infinity where unreached
  /// The medial axis of the field's sources, its arcs as curves on the field's mesh: where smoothing opens gaps.
  std::vector<std::vector<SurfacePoint>> ridges;
};

/// Refines where linear interpolation of the field is worse than a twentieth of the spacing. The field must be exact
/// (accuracy 0). Throws Error(cancelled) on request.
FieldSamples sample_for_smoothing(const ExactField& field, double spacing, Progress& progress = Progress::none());

/// Distances smoothed by diffusion (paper ch. 9.2) of the given width, mm: see DiffusionOptions. Where the distance is
/// less than twice the width, less is smoothed, over half the distance, so that the first passes keep to the sources;
/// at the sources nothing is, and the function is zero where it was. Null metric: lengths in space. Throws
/// Error(cancelled) on request.
std::vector<double> smoothed_distances(const TriangleMesh& mesh, const IntrinsicGeometry* metric,
                                       const std::vector<double>& distances, double width,
                                       Progress& progress = Progress::none());

}  // namespace isopath
