#include "isopath/mesh/triangle_soup.h"

namespace isopath {

Box3 bounding_box(const TriangleSoup& soup) {
  Box3 box;
  for (const Vec3& p : soup.positions) {
    if (p.allFinite()) box.extend(p);
  }
  return box;
}

}  // namespace isopath
