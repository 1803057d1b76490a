#pragma once

#include "isopath/field/exact_field.h"

namespace isopath::test {

/// The exact distances from one point.
inline ExactField field_from(const TriangleMesh& mesh, const SurfacePoint& point) {
  SourceSet sources;
  sources.add_point(point);
  return ExactField::compute(mesh, sources);
}

}  // namespace isopath::test
