#include "isopath/mesh/surface_point.h"

#include "isopath/core/error.h"

namespace isopath {

Support support_of(const TriangleMesh& mesh, const SurfacePoint& point) {
  int zeros = 0;
  int zero = 0;
  int nonzero = 0;
  for (int i = 0; i < 3; ++i) {
    if (point.barycentric[i] == 0) {
      ++zeros;
      zero = i;
    } else {
      nonzero = i;
    }
  }
  if (zeros == 2) return {Support::Kind::vertex, mesh.triangle(point.face)[nonzero]};
  if (zeros == 1) return {Support::Kind::edge, 3 * point.face + (zero + 1) % 3};
  return {Support::Kind::face, point.face};
}

SurfacePoint point_at_vertex(const TriangleMesh& mesh, Index vertex) {
  return point_on_halfedge(mesh.outgoing(vertex), 0);
}

SurfacePoint point_on_halfedge(Index halfedge, double t) {
  SurfacePoint point{TriangleMesh::face_of(halfedge)};
  point.barycentric[halfedge % 3] = 1 - t;
  point.barycentric[TriangleMesh::next(halfedge) % 3] = t;
  return point;
}

SurfacePoint express_in(const TriangleMesh& mesh, const SurfacePoint& point, Index face) {
  if (point.face == face) return point;
  SurfacePoint out{face};
  double placed = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (mesh.triangle(face)[j] == mesh.triangle(point.face)[i]) {
        out.barycentric[j] = point.barycentric[i];
        placed += point.barycentric[i];
      }
    }
  }
  if (placed < 1 - 1e-9) throw Error(ErrorCode::internal, "surface point is not on the face it should be expressed in");
  return out;
}

Vec3 position_of(const TriangleMesh& mesh, const SurfacePoint& point) {
  const auto& [a, b, c] = mesh.triangle(point.face);
  return point.barycentric[0] * mesh.position(a) + point.barycentric[1] * mesh.position(b) +
         point.barycentric[2] * mesh.position(c);
}

Vec3 snapped(Vec3 barycentric) {
  constexpr double tiny = 1e-12;
  int largest = 0;
  barycentric.maxCoeff(&largest);
  double rest = 1;
  for (int i = 0; i < 3; ++i) {
    if (barycentric[i] < tiny) barycentric[i] = 0;
    if (i != largest) rest -= barycentric[i];
  }
  barycentric[largest] = rest;
  return barycentric;
}

}  // namespace isopath
