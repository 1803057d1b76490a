#include "isopath/impact/cover_field.h"

#include "isopath/core/error.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {

CoverField distance_from_cover(const TriangleMesh& mesh, const ImpactCurve& curve, double spacing, Progress& progress,
                               const IntrinsicGeometry* metric) {
  SourceSet source;
  std::vector<Index> curve_point;
  std::vector<SurfacePoint> stretch;
  Index first = 0;  // of the stretch, in the curve
  const auto flush = [&] {
    if (stretch.size() > 1) {
      source.add_polyline(mesh, stretch, false);
      // elements alternate: point, segment, point, …
      for (Index k = 0; curve_point.size() < source.elements().size(); ++k) curve_point.push_back(first + k / 2);
    }
    stretch.clear();
  };
  for (Index i = 0; i < static_cast<Index>(curve.points.size()); ++i) {
    const ImpactPoint& point = curve.points[i];
    if (point.kind != MoveKind::cover || (!stretch.empty() && common_face(mesh, stretch.back(), point.at) == no_index))
      flush();
    if (!point.at.valid()) continue;
    if (stretch.empty()) first = i;
    stretch.push_back(point.at);
  }
  flush();
  if (source.empty()) throw Error(ErrorCode::no_plan, "the curve covers nothing");
  const ExactFieldOptions options{.accuracy = cover_accuracy * spacing};
  return {metric ? ExactField::compute(mesh, *metric, source, options, progress)
                 : ExactField::compute(mesh, source, options, progress),
          std::move(curve_point)};
}

}  // namespace isopath
