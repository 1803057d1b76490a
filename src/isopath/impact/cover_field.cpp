#include "isopath/impact/cover_field.h"

#include "isopath/core/error.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {

namespace {

struct CoverSource {
  SourceSet elements;
  std::vector<Index> curve_point;  // where the element, or the segment before it, starts
};

/// The covering moves between points that `take` accepts.
template <class Take>
CoverSource cover_source(const TriangleMesh& mesh, const ImpactCurve& curve, const Take& take) {
  CoverSource source;
  std::vector<SurfacePoint> stretch;
  Index first = 0;  // of the stretch, in the curve
  const auto flush = [&] {
    if (stretch.size() > 1) {
      source.elements.add_polyline(mesh, stretch, false);
      // elements alternate: point, segment, point, …
      for (Index k = 0; source.curve_point.size() < source.elements.elements().size(); ++k)
        source.curve_point.push_back(first + k / 2);
    }
    stretch.clear();
  };
  for (Index i = 0; i < static_cast<Index>(curve.points.size()); ++i) {
    const ImpactPoint& point = curve.points[i];
    if (point.kind != MoveKind::cover || (!stretch.empty() && common_face(mesh, stretch.back(), point.at) == no_index))
      flush();
    if (!point.at.valid() || !take(i)) {
      flush();
      continue;
    }
    if (stretch.empty()) first = i;
    stretch.push_back(point.at);
  }
  flush();
  if (source.elements.empty()) throw Error(ErrorCode::no_plan, "the curve covers nothing");
  return source;
}

/// Most of the surface is within half a spacing, and questions are asked all over it.
ExactFieldOptions cover_options(double spacing) {
  return {.accuracy = cover_accuracy * spacing, .expected_reach = 0.5 * spacing, .many_questions = true};
}

}  // namespace

SourceSet cover_elements(const TriangleMesh& mesh, const ImpactCurve& curve) {
  return cover_source(mesh, curve, [](Index) { return true; }).elements;
}

CoverField distance_from_cover(const TriangleMesh& mesh, const ImpactCurve& curve, double spacing, Progress& progress,
                               const IntrinsicGeometry* metric) {
  CoverSource source = cover_source(mesh, curve, [](Index) { return true; });
  const ExactFieldOptions options = cover_options(spacing);
  return {metric ? ExactField::compute(mesh, *metric, source.elements, options, progress)
                 : ExactField::compute(mesh, source.elements, options, progress),
          std::move(source.curve_point)};
}

CoverField distance_from_part_of_cover(const TriangleMesh& mesh, const ImpactCurve& curve,
                                       const std::vector<char>& marked, double stop_distance, double spacing,
                                       Progress& progress) {
  CoverSource source = cover_source(mesh, curve, [&](Index i) { return marked[i] != 0; });
  ExactFieldOptions options = cover_options(spacing);
  options.stop_distance = stop_distance;
  return {ExactField::compute(mesh, source.elements, options, progress), std::move(source.curve_point)};
}

}  // namespace isopath
