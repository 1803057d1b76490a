#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "isopath/contour/blend.h"
#include "isopath/core/geometry.h"
#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/surface_function.h"
#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"
#include "isopath/plan/job.h"
#include "isopath/plan/make_sources.h"
#include "isopath/plan/plan_result.h"
#include "isopath/plan/smooth_part.h"

namespace isopath {

/// Bound on the error of distances, as a part of the part's size: half of what isolines are promised to keep, and
/// far below any machine's; it saves most of the windows that fans of nearly flat vertices would cost.
inline constexpr double field_accuracy = 5e-7;

/// The function whose isolines the passes on a part follow.
struct PartField {
  std::unique_ptr<SurfaceFunction> function;  ///< on the part's mesh, or a finer one; these must stay where they are
  std::vector<double> at_vertices;            ///< of the function's mesh, mm; infinity where unreached
  double spacing = 0;                         ///< of nested levels; 0 where the function is not made for such
  std::unique_ptr<FineSurface> fine = {};     ///< null where the function's mesh is the part's
  std::vector<std::vector<SurfacePoint>> ridges = {};  ///< see FieldSamples, on the part's mesh

  /// The mesh of the function, on this part.
  const TriangleMesh& mesh_of(const Part& part) const { return fine ? fine->mesh : part.mesh; }
};

/// The direction that the job names for planes, or the one that suits the part.
Vec3 direction_of_planes(const Job& job, const TriangleMesh& mesh);

/// Distances from the job's sources on the part as it is. Null metric: in space. Throws what `make_sources` does, and
/// Error(cancelled) on request.
PartField exact_field_of(const PlanResult& result, const IntrinsicGeometry* metric, AutoLoops loops,
                         Progress& progress);

/// What the job asks for: distances, smoothed ones, or the height for planes. Throws as `exact_field_of`.
PartField field_of(const PlanResult& result, const IntrinsicGeometry* metric, Progress& progress);

/// The function whose levels are nested closed curves (contour/blend.h), in the place of the part's exact field, on a
/// mesh made fine enough for it. A part with holes is cut open; one with handles has no such levels: it keeps the
/// field, and `result.pattern` becomes the two-way curve. Both are told in the warnings. Throws what `nested_field`
/// does.
PartField nested_field_of(PlanResult& result, PartField field, Progress& progress);

/// The same on the given mesh, which is fine enough for the distances and is made finer where its levels need it; it
/// takes the place of the part's.
PartField nested_field_on(RefinedMesh fine, BlendForm form, PlanResult& result, Progress& progress);

}  // namespace isopath
