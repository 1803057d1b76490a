#include "isopath/field/flat_layout.h"

#include <cmath>

namespace isopath {
namespace {

/// The power of two next below the mean edge length: scaling with it rounds nothing.
double unit_of(const TriangleMesh& mesh) {
  double sum = 0;
  for (const double length : mesh.edge_lengths()) sum += length;
  const double mean = mesh.n_edges() > 0 ? sum / mesh.n_edges() : 0;
  return mean > 0 ? std::ldexp(1.0, std::ilogb(mean)) : 1;
}

}  // namespace

FlatLayout::FlatLayout(const TriangleMesh& mesh) : faces(mesh.n_faces()), unit(unit_of(mesh)) {
  const double scale = 1 / unit;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    FlatFace& face = faces[f];
    const Triangle& triangle = mesh.triangle(f);
    const std::array<Vec3, 3> along{scale * (mesh.position(triangle[1]) - mesh.position(triangle[0])),
                                    scale * (mesh.position(triangle[2]) - mesh.position(triangle[1])),
                                    scale * (mesh.position(triangle[0]) - mesh.position(triangle[2]))};
    face.twice_area = static_cast<float>(along[0].cross(along[1]).norm());
    for (int i = 0; i < 3; ++i) {
      const double length = along[i].norm();
      const Index twin = mesh.twin(3 * f + i);
      face.vertex[i] = static_cast<std::uint32_t>(triangle[i]);
      face.twin[i] = twin == no_index ? no_flat_halfedge : flat_of(twin);
      face.length[i] = static_cast<float>(length);
      face.record[i] = no_flat_record;
      face.apex_x[i] = static_cast<float>(length > 0 ? -along[i].dot(along[(i + 2) % 3]) / length : 0);
    }
  }
}

}  // namespace isopath
