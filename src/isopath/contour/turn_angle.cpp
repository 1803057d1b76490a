#include "isopath/contour/turn_angle.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <deque>

#include "isopath/core/error.h"

namespace isopath {
namespace {

/// The half-edge by which a face touches the boundary, `no_index` where it does not.
Index boundary_side(const TriangleMesh& mesh, Index face) {
  for (Index h = 3 * face; h < 3 * face + 3; ++h) {
    if (mesh.twin(h) == no_index) return h;
  }
  return no_index;
}

/// The half-edges that the shortest chain of faces between two faces is left by, from each of its faces to the next.
std::vector<Index> chain_between(const TriangleMesh& mesh, Index from, Index to) {
  std::vector<Index> came_by(mesh.n_faces(), no_index);
  std::deque<Index> open{from};
  while (!open.empty() && to != from && came_by[to] == no_index) {
    const Index face = open.front();
    open.pop_front();
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      const Index twin = mesh.twin(h);
      if (twin == no_index) continue;
      const Index next = TriangleMesh::face_of(twin);
      if (next == from || came_by[next] != no_index) continue;
      came_by[next] = h;
      open.push_back(next);
    }
  }
  std::vector<Index> chain;
  for (Index face = to; face != from; face = TriangleMesh::face_of(came_by[face])) {
    if (came_by[face] == no_index) throw Error(ErrorCode::internal, "no way across the annulus");
    chain.push_back(came_by[face]);
  }
  std::reverse(chain.begin(), chain.end());
  return chain;
}

/// A form that is zero but on the edges that a chain of faces crosses: closed, and 1 on every way round.
void add_period(const TriangleMesh& mesh, Index inner, Index outer, std::vector<double>& form,
                std::vector<char>& hole) {
  const auto cross = [&](Index h) {
    form[h] = 1;
    if (mesh.twin(h) != no_index) form[mesh.twin(h)] = -1;
  };
  const Index in_side = boundary_side(mesh, inner);
  const Index out_side = boundary_side(mesh, outer);
  for (const Index h : chain_between(mesh, inner, outer)) cross(h);
  if (in_side != no_index) {
    form[in_side] = -1;  // comes in from outside
  } else {
    hole[inner] = 1;
  }
  if (out_side != no_index) {
    form[out_side] = 1;
  } else {
    hole[outer] = 1;
  }
}

}  // namespace

TurnAngle turn_angle(const TriangleMesh& mesh, const std::vector<Index>& inner_faces,
                     const std::vector<Index>& outer_faces, const Progress& progress) {
  TurnAngle result{std::vector<double>(mesh.n_vertices(), 0.0), std::vector<char>(mesh.n_faces(), 0)};
  std::vector<double> form(mesh.n_halfedges(), 0.0);
  for (std::size_t c = 0; c < inner_faces.size(); ++c) {
    if (inner_faces[c] != no_index) add_period(mesh, inner_faces[c], outer_faces[c], form, result.hole);
  }
  // least Σ w (u_j - u_i + form)²: the harmonic form of the same periods
  const int n = mesh.n_vertices();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(9 * static_cast<std::size_t>(mesh.n_faces()));
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  std::vector<double> diagonal(n, 0.0);
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    if (result.hole[TriangleMesh::face_of(h)]) continue;
    const Index i = mesh.from(h);
    const Index j = mesh.to(h);
    const Vec3& apex = mesh.position(mesh.from(TriangleMesh::prev(h)));
    const Vec3 a = mesh.position(i) - apex;
    const Vec3 b = mesh.position(j) - apex;
    const double height = a.cross(b).norm();
    // weights stay positive, so that there is no turning back; angles beyond these are those of slivers
    const double weight = height > 0 ? std::clamp(0.5 * a.dot(b) / height, 0.005, 500.0) : 500;
    diagonal[i] += weight;
    diagonal[j] += weight;
    entries.emplace_back(std::max(i, j), std::min(i, j), -weight);
    right[i] += weight * form[h];
    right[j] -= weight * form[h];
  }
  std::vector<char> held(mesh.n_components(), 0);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    if (held[mesh.component_of(f)] || result.hole[f]) continue;
    held[mesh.component_of(f)] = 1;
    diagonal[mesh.triangle(f)[0]] += 1;
  }
  for (int v = 0; v < n; ++v) entries.emplace_back(v, v, diagonal[v] > 0 ? diagonal[v] : 1);
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  progress.checkpoint();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success) throw Error(ErrorCode::internal, "the angle's matrix is not definite");
  const Eigen::VectorXd solution = solver.solve(right);
  std::copy(solution.begin(), solution.end(), result.turn.begin());
  return result;
}

}  // namespace isopath
