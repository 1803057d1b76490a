#include "isopath/mesh/curvature.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

namespace isopath {
namespace {

using Matrix2 = Eigen::Matrix2d;

/// The outgoing half-edges of a vertex from `start` on through the faces of one smooth group, both ways round.
std::vector<Index> smooth_fan(const TriangleMesh& mesh, const SmoothNormals& normals, Index start) {
  Index first = start;
  while (!normals.is_crease(first)) {
    first = TriangleMesh::next(mesh.twin(first));  // clockwise
    if (first == start) break;
  }
  std::vector<Index> fan;
  Index h = first;
  do {
    fan.push_back(h);
    if (normals.is_crease(TriangleMesh::prev(h))) break;
    h = mesh.next_outgoing(h);
  } while (h != first);
  return fan;
}

double angle_of(const TriangleMesh& mesh, const std::vector<Index>& fan) {
  double sum = 0;
  for (const Index h : fan) {
    const Vec3 a = mesh.position(mesh.to(h)) - mesh.position(mesh.from(h));
    const Vec3 b = mesh.position(mesh.from(TriangleMesh::prev(h))) - mesh.position(mesh.from(h));
    sum += std::atan2(a.cross(b).norm(), a.dot(b));
  }
  return sum;
}

/// The fan of the vertex's smooth group with the largest angle.
std::vector<Index> widest_fan(const TriangleMesh& mesh, const SmoothNormals& normals, Index vertex) {
  std::vector<Index> widest;
  double angle = -1;
  const Index first = mesh.outgoing(vertex);
  Index h = first;
  do {
    // One look at each group: where it begins, or anywhere when the vertex has only one.
    if (h == first || normals.is_crease(h)) {
      std::vector<Index> fan = smooth_fan(mesh, normals, h);
      const double its_angle = angle_of(mesh, fan);
      if (its_angle > angle) {
        angle = its_angle;
        widest = std::move(fan);
      }
    }
    h = mesh.next_outgoing(h);
  } while (h != no_index && h != first);
  return widest;
}

/// The vertices within two rings that are reached without crossing a crease, in ascending order.
std::vector<Index> neighbours(const TriangleMesh& mesh, const SmoothNormals& normals, const std::vector<Index>& fan) {
  std::vector<Index> found;
  for (const Index spoke : fan) {
    for (const Index h : {TriangleMesh::next(spoke), TriangleMesh::prev(spoke)}) {
      for (const Index g : smooth_fan(mesh, normals, h)) {
        found.push_back(mesh.to(g));
        found.push_back(mesh.from(TriangleMesh::prev(g)));
      }
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::erase(found, mesh.from(fan.front()));
  return found;
}

/// The quadratic z = g·x + ½ xᵀ h x in the frame of `axes`.
struct Quadratic {
  Vec2 gradient;
  Matrix2 hessian;
};

/// Fits the points (x, y, z) by weighted least squares, weight 1 / distance. The axes of x and y are those of the
/// points' spread; dividing by it makes the problem well conditioned for any aspect ratio, so that the normal equations
/// serve. Terms that the points leave open vanish.
Quadratic fit(const std::vector<Vec3>& points, const Vec2& spread) {
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Vector5 right = Vector5::Zero();
  for (const Vec3& p : points) {
    const double x = p.x() / spread.x();
    const double y = p.y() / spread.y();
    const double distance = std::max(std::hypot(x, y), 1e-3);
    const Vector5 terms{x, y, 0.5 * x * x, x * y, 0.5 * y * y};
    const Vector5 weighted = terms / (distance * distance);
    normal += terms * weighted.transpose();
    right += p.z() * weighted;
  }
  // A trace of regularisation keeps the terms small that the points leave open.
  normal.diagonal().array() += 1e-11 * normal.trace();
  const Vector5 c = normal.ldlt().solve(right);
  Quadratic q;
  q.gradient = {c[0] / spread.x(), c[1] / spread.y()};
  q.hessian(0, 0) = c[2] / (spread.x() * spread.x());
  q.hessian(0, 1) = q.hessian(1, 0) = c[3] / (spread.x() * spread.y());
  q.hessian(1, 1) = c[4] / (spread.y() * spread.y());
  return q;
}

PrincipalCurvatures curvatures_at(const TriangleMesh& mesh, const SmoothNormals& normals, Index vertex) {
  const std::vector<Index> fan = widest_fan(mesh, normals, vertex);
  const Vec3& n = normals.at_corner(TriangleMesh::face_of(fan.front()), fan.front() % 3);
  const Vec3 ex = n.unitOrthogonal();
  const Vec3 ey = n.cross(ex);
  std::vector<Vec3> points;
  Matrix2 spread = Matrix2::Zero();
  for (const Index v : neighbours(mesh, normals, fan)) {
    const Vec3 d = mesh.position(v) - mesh.position(vertex);
    points.emplace_back(d.dot(ex), d.dot(ey), d.dot(n));
    spread += points.back().head<2>() * points.back().head<2>().transpose();
  }
  Eigen::SelfAdjointEigenSolver<Matrix2> axes;
  axes.computeDirect(spread);
  const double wide = std::sqrt(std::max(0.0, axes.eigenvalues()[1]));
  if (!(wide > 0)) return {0, 0, ex, ey};
  // The spread is a sum and not a mean: only the ratio of its axes matters to the fit. Points on one line leave the
  // other axis open; it is scaled as if they were a sliver, and stays flat.
  const double narrow = std::max(std::sqrt(std::max(0.0, axes.eigenvalues()[0])), 1e-6 * wide);
  for (Vec3& p : points) p.head<2>() = Vec2(axes.eigenvectors().transpose() * p.head<2>());
  const Quadratic q = fit(points, {narrow, wide});

  // The shape operator of the graph, from its two fundamental forms, in an orthonormal basis of the tangent plane: the
  // direction of the gradient and the one across it. Its columns are their coordinates in the axes.
  const double slope = q.gradient.norm();
  const Vec2 uphill = slope > 0 ? Vec2(q.gradient / slope) : Vec2(1, 0);
  const double stretch = std::sqrt(1 + slope * slope);
  Matrix2 tangent;
  tangent << uphill.x() / stretch, -uphill.y(), uphill.y() / stretch, uphill.x();
  const Matrix2 second = tangent.transpose() * q.hessian * tangent / stretch;
  Eigen::SelfAdjointEigenSolver<Matrix2> shape;
  shape.computeDirect(second);
  const auto direction = [&](int i) {
    const Vec2 in_axes = tangent * shape.eigenvectors().col(i);
    const Vec2 plane = axes.eigenvectors() * in_axes;
    return Vec3((plane.x() * ex + plane.y() * ey + q.gradient.dot(in_axes) * n).normalized());
  };
  return {shape.eigenvalues()[1], shape.eigenvalues()[0], direction(1), direction(0)};
}

}  // namespace

double PrincipalCurvatures::along(const Vec3& direction) const {
  const double a = direction.dot(max_direction);
  const double b = direction.dot(min_direction);
  const double length2 = a * a + b * b;
  return length2 > 0 ? (max * a * a + min * b * b) / length2 : 0;
}

std::vector<PrincipalCurvatures> principal_curvatures(const TriangleMesh& mesh, const SmoothNormals& normals) {
  std::vector<PrincipalCurvatures> out(mesh.n_vertices());
  tbb::parallel_for(tbb::blocked_range<Index>(0, mesh.n_vertices(), 256), [&](const auto& range) {
    for (Index v = range.begin(); v < range.end(); ++v) {
      if (mesh.outgoing(v) != no_index) out[v] = curvatures_at(mesh, normals, v);
    }
  });
  return out;
}

}  // namespace isopath
