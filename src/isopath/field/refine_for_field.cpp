#include "isopath/field/refine_for_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "isopath/core/error.h"

namespace isopath {
namespace {

/// Difference between the function and its linear interpolation in a triangle, at the sampled places. Zero where a
/// corner is unreached.
double sampled_error(const SurfaceFunction& function, const RefineTriangle& triangle) {
  const auto& corner = triangle.barycentric;
  const auto value_at = [&](const Vec3& barycentric) { return function.value({triangle.face, barycentric}); };
  Vec3 at_corner;
  for (int i = 0; i < 3; ++i) at_corner[i] = value_at(corner[i]);
  if (!at_corner.allFinite()) return 0;
  double error = 0;
  const auto sample = [&](const Vec3& weights) {
    const Vec3 place = weights[0] * corner[0] + weights[1] * corner[1] + weights[2] * corner[2];
    error = std::max(error, std::abs(value_at(place) - weights.dot(at_corner)));
  };
  sample(Vec3::Constant(1.0 / 3));
  for (int i = 0; i < 3; ++i) {
    sample(0.5 * (Vec3::Ones() - Vec3::Unit(i)));
    sample(0.5 * (Vec3::Constant(1.0 / 3) + Vec3::Unit(i)));
  }
  return error;
}

}  // namespace

void FieldRefinementOptions::validate() const {
  if (!(tolerance > 0 && tolerance < infinity)) {
    throw Error(ErrorCode::bad_usage, "the tolerance of a refinement is not a positive length",
                {.element = "tolerance",
                 .value = fmt::format("{} mm", tolerance),
                 .advice = "give for example 1e-3 of the model's size"});
  }
  if (max_levels < 0 || max_levels > 20) {
    throw Error(ErrorCode::bad_usage, "number of refinement levels out of range",
                {.element = "max_levels", .value = fmt::format("{}, allowed are 0 to 20", max_levels)});
  }
}

RefinedField refine_for_field(const TriangleMesh& mesh, const SurfaceFunction& function,
                              const FieldRefinementOptions& options, const Progress& progress) {
  options.validate();
  std::size_t asked = 0;
  const auto wants_split = [&](const RefineTriangle& triangle) {
    if (++asked % 256 == 0) progress.checkpoint();
    return sampled_error(function, triangle) > options.tolerance / 3;
  };
  RefinedField result;
  result.refined = refine(mesh, wants_split, options.max_levels);
  const TriangleMesh& finer = result.refined.mesh;
  result.value.assign(finer.n_vertices(), infinity);
  for (Index v = 0; v < finer.n_vertices(); ++v) {
    if (result.refined.on_old[v].valid()) result.value[v] = function.value(result.refined.on_old[v]);
  }
  for (Index f = 0; f < finer.n_faces(); ++f) {
    if (f % 256 == 0) progress.checkpoint();
    RefineTriangle triangle{.face = result.refined.old_face[f]};
    for (int i = 0; i < 3; ++i) {
      const SurfacePoint& corner = result.refined.on_old[finer.triangle(f)[i]];
      triangle.barycentric[i] = express_in(mesh, corner, triangle.face).barycentric;
    }
    result.largest_error = std::max(result.largest_error, sampled_error(function, triangle));
  }
  return result;
}

}  // namespace isopath
