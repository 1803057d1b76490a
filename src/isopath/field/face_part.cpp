#include "isopath/field/face_part.h"

#include <algorithm>

namespace isopath {

namespace {

Vec3 place_of(const FaceCorners& corners, const Vec3& barycentric) {
  return barycentric[0] * corners[0] + barycentric[1] * corners[1] + barycentric[2] * corners[2];
}

}  // namespace

FaceCorners corners_of(const TriangleMesh& mesh, Index face) {
  const Triangle& triangle = mesh.triangle(face);
  return {mesh.position(triangle[0]), mesh.position(triangle[1]), mesh.position(triangle[2])};
}

double radius_of(const FaceCorners& corners, const FacePart& part) {
  const Vec3 centre = place_of(corners, part.centre());
  double radius = 0;
  for (const Vec3& c : part.corner) radius = std::max(radius, (place_of(corners, c) - centre).norm());
  return radius;
}

void halve(const FaceCorners& corners, const FacePart& part, std::vector<FacePart>& parts) {
  int longest = 0;
  double most = -1;
  for (int i = 0; i < 3; ++i) {
    const double side = (place_of(corners, part.corner[i]) - place_of(corners, part.corner[(i + 1) % 3])).norm();
    if (side > most) {
      most = side;
      longest = i;
    }
  }
  const Vec3 a = part.corner[longest];
  const Vec3 b = part.corner[(longest + 1) % 3];
  const Vec3 c = part.corner[(longest + 2) % 3];
  const Vec3 middle = 0.5 * (a + b);
  parts.push_back({part.face, {a, middle, c}, part.depth + 1});
  parts.push_back({part.face, {middle, b, c}, part.depth + 1});
}

}  // namespace isopath
