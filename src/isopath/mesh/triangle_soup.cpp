#include "isopath/mesh/triangle_soup.h"

#include <fmt/format.h>

#include "isopath/core/error.h"

namespace isopath {

Box3 bounding_box(const TriangleSoup& soup) {
  Box3 box;
  for (const Vec3& p : soup.positions) {
    if (p.allFinite()) box.extend(p);
  }
  return box;
}

void require_usable_size(const Box3& bounds) {
  const double size = bounds.isEmpty() ? 0 : bounds.diagonal().stableNorm();
  if (size == 0 || size >= smallest_size) return;
  throw Error(ErrorCode::bad_input, "the mesh is too small to compute with",
              {.value = fmt::format("{} mm across", size), .advice = "scale it up, or name the unit of the file"});
}

}  // namespace isopath
