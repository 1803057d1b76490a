#include "isopath/mesh/curvature.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "isopath/core/angle.h"

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
    sum += angle_between(a, b);
  }
  return sum;
}

/// Fits of the third degree take this many points; of fewer, one of the second is made.
constexpr std::size_t points_of_cubic = 12;
/// So few points, as at the corners of a boundary, make a further ring worth its distance.
constexpr std::size_t fewest_points = 8;
/// Points beyond two rings that a fit looks at, at most.
constexpr std::size_t most_points = 80;
/// A fit that leans farther from the mean of the faces' normals than this has too little to go by.
constexpr double most_slope = 0.6;

/// The vertices around one that are reached without crossing a crease: two rings, or three
/// at a boundary or a crease, then all within the radius, and further rings while they are too few.
class Surroundings {
 public:
  Surroundings(const TriangleMesh& mesh, const SmoothNormals& normals, const std::vector<Index>& fan, double radius)
      : mesh_(mesh), centre_(mesh.from(fan.front())) {
    // on a boundary all lies on one side, and a cubic takes three rows of it
    const int wanted = normals.is_crease(fan.front()) ? 3 : 2;
    std::vector<Index> ring;
    for (const Index h : fan) look_along(h, infinity, ring);
    for (int rings = 1; !ring.empty(); ++rings) {
      const bool few = rings < wanted || found_.size() < fewest_points;
      if (!few && found_.size() >= most_points) break;
      const std::vector<Index> last = std::move(ring);
      ring.clear();
      for (const Index h : last) {
        for (const Index g : smooth_fan(mesh, normals, h)) look_along(g, few ? infinity : radius, ring);
      }
    }
  }
  const std::vector<Index>& vertices() const { return found_; }

 private:
  /// Takes the two other corners of a half-edge's face; each is kept with a half-edge that leaves it in that face.
  void look_along(Index h, double radius, std::vector<Index>& ring) {
    for (const Index leaving : {TriangleMesh::next(h), TriangleMesh::prev(h)}) {
      const Index v = mesh_.from(leaving);
      if (v == centre_ || std::find(found_.begin(), found_.end(), v) != found_.end()) continue;
      if ((mesh_.position(v) - mesh_.position(centre_)).norm() > radius) continue;
      found_.push_back(v);
      ring.push_back(leaving);
    }
  }

  const TriangleMesh& mesh_;
  Index centre_;
  std::vector<Index> found_;
};

/// The height z = g·x + ½ xᵀ h x + cubic terms in the frame of `axes`.
struct Quadratic {
  Vec2 gradient;
  Matrix2 hessian;
};

/// Fits the points (x, y, z) by weighted least squares, weight 1 / distance; with cubic terms or without. A distance is
/// at least `blunt`, in spreads, so that not only the nearest points are heard where noise is to be evened out. The
/// axes of x and y are those of the points' spread; dividing by it makes the problem well conditioned for any aspect
/// ratio, so that the normal equations serve. Terms that the points leave open vanish, those of the highest degree
/// first.
template <int terms>
Quadratic fit(const std::vector<Vec3>& points, const Vec2& spread, double blunt) {
  using Vector = Eigen::Matrix<double, terms, 1>;
  Eigen::Matrix<double, terms, terms> normal = Eigen::Matrix<double, terms, terms>::Zero();
  Vector right = Vector::Zero();
  for (const Vec3& p : points) {
    const double x = p.x() / spread.x();
    const double y = p.y() / spread.y();
    const double distance = std::max(std::hypot(x, y), std::max(blunt, 1e-3));
    Vector term;
    term.template head<5>() << x, y, 0.5 * x * x, x * y, 0.5 * y * y;
    if constexpr (terms == 9) term.template tail<4>() << x * x * x, x * x * y, x * y * y, y * y * y;
    const Vector weighted = term / (distance * distance);
    normal += term * weighted.transpose();
    right += p.z() * weighted;
  }
  // A trace of regularisation keeps the terms small that the points leave open.
  const double trace = normal.trace();
  normal.diagonal().template head<2>().array() += 1e-12 * trace;
  normal.diagonal().template tail<terms - 2>().array() += 1e-11 * trace;
  if constexpr (terms == 9) normal.diagonal().template tail<4>().array() += 1e-8 * trace;
  const Vector c = normal.ldlt().solve(right);
  Quadratic q;
  q.gradient = {c[0] / spread.x(), c[1] / spread.y()};
  q.hessian(0, 0) = c[2] / (spread.x() * spread.x());
  q.hessian(0, 1) = q.hessian(1, 0) = c[3] / (spread.x() * spread.y());
  q.hessian(1, 1) = c[4] / (spread.y() * spread.y());
  return q;
}

struct VertexFit {
  Vec3 normal;
  PrincipalCurvatures curvature;
};

/// The fit around a vertex to the smooth group of this fan.
VertexFit fit_at(const TriangleMesh& mesh, const SmoothNormals& normals, const std::vector<Index>& fan, double radius) {
  const Index vertex = mesh.from(fan.front());
  const Vec3& n = normals.at_corner(TriangleMesh::face_of(fan.front()), fan.front() % 3);
  const Vec3 ex = n.unitOrthogonal();
  const Vec3 ey = n.cross(ex);
  std::vector<Vec3> points;
  double reach = 0;
  Matrix2 spread = Matrix2::Zero();
  const Surroundings around(mesh, normals, fan, radius);
  for (const Index v : around.vertices()) {
    const Vec3 d = mesh.position(v) - mesh.position(vertex);
    points.emplace_back(d.dot(ex), d.dot(ey), d.dot(n));
    spread += points.back().head<2>() * points.back().head<2>().transpose();
    reach = std::max(reach, d.norm());
  }
  Eigen::SelfAdjointEigenSolver<Matrix2> axes;
  axes.computeDirect(spread);
  const double wide = std::sqrt(std::max(0.0, axes.eigenvalues()[1]));
  if (!(wide > 0)) return {n, {0, 0, ex, ey}};
  // The spread is a sum and not a mean: only the ratio of its axes matters to the fit. Points on one line leave the
  // other axis open; it is scaled as if they were a sliver, and stays flat.
  const double narrow = std::max(std::sqrt(std::max(0.0, axes.eigenvalues()[0])), 1e-6 * wide);
  for (Vec3& p : points) p.head<2>() = Vec2(axes.eigenvectors().transpose() * p.head<2>());
  const Vec2 scale = Vec2(narrow, wide) / std::sqrt(static_cast<double>(points.size()));
  const double blunt = reach > 0 ? 1.5 * std::min(1.0, radius / reach) : 0;
  const Quadratic q = points.size() < points_of_cubic ? fit<5>(points, scale, blunt) : fit<9>(points, scale, blunt);

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
  const auto in_space = [&](const Vec2& in_axes) {
    const Vec2 plane = axes.eigenvectors() * in_axes;
    return Vec3(plane.x() * ex + plane.y() * ey);
  };
  const auto direction = [&](int i) {
    const Vec2 in_axes = tangent * shape.eigenvectors().col(i);
    return Vec3((in_space(in_axes) + q.gradient.dot(in_axes) * n).normalized());
  };
  const Vec3 normal = slope < most_slope ? Vec3((n - in_space(q.gradient)).normalized()) : n;
  return {normal, {shape.eigenvalues()[1], shape.eigenvalues()[0], direction(1), direction(0)}};
}

/// Fits each smooth group around a vertex; the curvature is that of the group with the largest angle.
void fit_vertex(const TriangleMesh& mesh, const SmoothNormals& normals, Index vertex, double radius, SurfaceFit& out) {
  double widest = -1;
  const Index first = mesh.outgoing(vertex);
  Index h = first;
  do {
    // One look at each group: where it begins, or anywhere when the vertex has only one.
    if (h == first || normals.is_crease(h)) {
      const std::vector<Index> fan = smooth_fan(mesh, normals, h);
      const VertexFit found = fit_at(mesh, normals, fan, radius);
      for (const Index corner : fan) out.corner_normals[corner] = found.normal;
      const double angle = angle_of(mesh, fan);
      if (angle > widest) {
        widest = angle;
        out.curvatures[vertex] = found.curvature;
      }
    }
    h = mesh.next_outgoing(h);
  } while (h != no_index && h != first);
}

}  // namespace

double PrincipalCurvatures::along(const Vec3& direction) const {
  const double a = direction.dot(max_direction);
  const double b = direction.dot(min_direction);
  const double length2 = a * a + b * b;
  return length2 > 0 ? (max * a * a + min * b * b) / length2 : 0;
}

SurfaceFit fit_surface(const TriangleMesh& mesh, const SmoothNormals& normals, double radius) {
  SurfaceFit out;
  out.curvatures.resize(mesh.n_vertices());
  out.corner_normals.resize(mesh.n_halfedges());
  tbb::parallel_for(tbb::blocked_range<Index>(0, mesh.n_vertices(), 256), [&](const auto& range) {
    for (Index v = range.begin(); v < range.end(); ++v) {
      if (mesh.outgoing(v) != no_index) fit_vertex(mesh, normals, v, radius, out);
    }
  });
  return out;
}

std::vector<PrincipalCurvatures> principal_curvatures(const TriangleMesh& mesh, const SmoothNormals& normals) {
  return fit_surface(mesh, normals).curvatures;
}

}  // namespace isopath
