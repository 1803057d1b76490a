#include "isopath/field/intrinsic_geometry.h"

#include <cmath>

namespace isopath {

IntrinsicGeometry::IntrinsicGeometry(const TriangleMesh& mesh)
    : length_(mesh.n_halfedges()), apex_(mesh.n_halfedges()) {
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    const Vec3& a = mesh.position(mesh.from(h));
    const Vec3 along = mesh.position(mesh.to(h)) - a;
    const Vec3 towards = mesh.position(mesh.from(TriangleMesh::prev(h))) - a;
    // Half-edges of one edge must agree to the last bit, so that both sides see the same interval.
    length_[h] = mesh.edge_length(mesh.edge_of(h));
    apex_[h] = length_[h] > 0 ? Vec2(along.dot(towards) / length_[h], along.cross(towards).norm() / length_[h])
                              : Vec2(0, towards.norm());
  }
}

double IntrinsicGeometry::angle_at_tail(Index halfedge) const {
  return std::atan2(apex_[halfedge].y(), apex_[halfedge].x());
}

Vec2 IntrinsicGeometry::in_frame(Index halfedge, const Vec3& barycentric) const {
  const double head = barycentric[TriangleMesh::next(halfedge) % 3];
  const double top = barycentric[TriangleMesh::prev(halfedge) % 3];
  return head * Vec2(length_[halfedge], 0) + top * apex_[halfedge];
}

}  // namespace isopath
