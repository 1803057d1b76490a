#include "isopath/field/source_faces.h"

#include "isopath/core/segment.h"

namespace isopath {

std::vector<Index> faces_of(const TriangleMesh& mesh, const SourceElement& element) {
  std::vector<Index> faces{element.a.face};
  for (int i = 0; i < 3; ++i) {
    const bool on_edge =
        element.a.barycentric[i] == 0 && (element.kind == SourceElement::Kind::point || element.b.barycentric[i] == 0);
    const Index twin = mesh.twin(3 * element.a.face + (i + 1) % 3);
    if (on_edge && twin != no_index) faces.push_back(TriangleMesh::face_of(twin));
  }
  return faces;
}

double distance_in_face(const TriangleMesh& mesh, const SourceElement& element, const Vec3& point) {
  const Vec3 a = position_of(mesh, element.a);
  const Vec3 b = element.kind == SourceElement::Kind::segment ? position_of(mesh, element.b) : a;
  return distance_to_segment(a, b, point);
}

}  // namespace isopath
