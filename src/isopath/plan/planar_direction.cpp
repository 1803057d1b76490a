#include "isopath/plan/planar_direction.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace isopath {
namespace {

using Matrix3 = Eigen::Matrix3d;

/// Axes whose moments differ by less than this share are as good as each other.
constexpr double alike = 1e-3;
/// The cosine of an angle of 60 degrees.
constexpr double near_axis = 0.5;

/// Second moments of the area about its centre, by the exact formula for triangles. Lengths are taken relative to the
/// part's size, so that no product of them overflows.
Matrix3 moments(const TriangleMesh& mesh) {
  const double size = mesh.size();
  double area = 0;
  Vec3 first = Vec3::Zero();
  Matrix3 second = Matrix3::Zero();
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const double weight = mesh.face_area(f) / (size * size);
    Vec3 sum = Vec3::Zero();
    Matrix3 squares = Matrix3::Zero();
    for (const Index v : mesh.triangle(f)) {
      const Vec3 p = (mesh.position(v) - mesh.position(0)) / size;
      sum += p;
      squares += p * p.transpose();
    }
    area += weight;
    first += weight / 3 * sum;
    second += weight / 12 * (squares + sum * sum.transpose());
  }
  return second - first * first.transpose() / area;
}

}  // namespace

Vec3 planar_direction_of(const TriangleMesh& mesh) {
  Eigen::SelfAdjointEigenSolver<Matrix3> axes;
  axes.computeDirect(moments(mesh));
  const Vec3& extent = axes.eigenvalues();  // ascending
  Matrix3 onto = Matrix3::Zero();           // the axes that are like the middle one
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis = axes.eigenvectors().col(k);
    if (std::abs(extent[k] - extent[1]) <= alike * extent[2]) onto += axis * axis.transpose();
  }
  for (const Vec3& wanted : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY())}) {
    const Vec3 direction = onto * wanted;
    if (direction.norm() > near_axis) return direction.normalized();
  }
  return (onto * Vec3::UnitZ()).normalized();
}

}  // namespace isopath
