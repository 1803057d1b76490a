#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <set>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

using Corners = std::vector<Triangle>;

/// The face that has the directed edge a -> b, and its third corner; `no_index` twice when there is none.
std::pair<Index, Index> face_with_edge(const Corners& faces, Index a, Index b) {
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int i = 0; i < 3; ++i) {
      if (faces[f][i] == a && faces[f][(i + 1) % 3] == b) return {static_cast<Index>(f), faces[f][(i + 2) % 3]};
    }
  }
  return {no_index, no_index};
}

double signed_area(const TriangleSoup& soup, Index a, Index b, Index c) {
  const Vec2 u = (soup.positions[b] - soup.positions[a]).head<2>();
  const Vec2 v = (soup.positions[c] - soup.positions[a]).head<2>();
  return cross(u, v);
}

/// Replaces the diagonal of two neighbouring faces, unless the new one exists already (or, in the plane, a face would
/// turn over).
void flip_random_edge(Rng& rng, TriangleSoup& soup, bool planar) {
  const Index f = random_index(rng, static_cast<Index>(soup.triangles.size()));
  const int i = random_index(rng, 3);
  const Index a = soup.triangles[f][i];
  const Index b = soup.triangles[f][(i + 1) % 3];
  const Index c = soup.triangles[f][(i + 2) % 3];
  const auto [g, d] = face_with_edge(soup.triangles, b, a);
  if (g == no_index || c == d) return;
  if (face_with_edge(soup.triangles, c, d).first != no_index || face_with_edge(soup.triangles, d, c).first != no_index)
    return;
  if (planar && (signed_area(soup, a, d, c) <= 1e-3 || signed_area(soup, d, b, c) <= 1e-3)) return;
  soup.triangles[f] = {a, d, c};
  soup.triangles[g] = {d, b, c};
}

/// Cuts a random face into three, or the two faces of a random edge into four.
void split_random(Rng& rng, TriangleSoup& soup) {
  const Index f = random_index(rng, static_cast<Index>(soup.triangles.size()));
  const auto [a, b, c] = soup.triangles[f];
  const Index middle = static_cast<Index>(soup.positions.size());
  if (random_index(rng, 2) == 0) {
    const Vec3 weights(random_real(rng, 0.1, 1), random_real(rng, 0.1, 1), random_real(rng, 0.1, 1));
    soup.positions.emplace_back(
        (weights[0] * soup.positions[a] + weights[1] * soup.positions[b] + weights[2] * soup.positions[c]) /
        weights.sum());
    soup.triangles[f] = {a, b, middle};
    soup.triangles.push_back({b, c, middle});
    soup.triangles.push_back({c, a, middle});
    return;
  }
  const double t = random_real(rng, 0.15, 0.85);
  soup.positions.emplace_back((1 - t) * soup.positions[a] + t * soup.positions[b]);
  const auto [g, d] = face_with_edge(soup.triangles, b, a);
  soup.triangles[f] = {a, middle, c};
  soup.triangles.push_back({middle, b, c});
  if (g != no_index) {
    soup.triangles[g] = {b, middle, d};
    soup.triangles.push_back({middle, a, d});
  }
}

TriangleSoup random_triangulation(Rng& rng, bool closed, int n_faces) {
  TriangleSoup soup;
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  soup.triangles = {{0, 1, 2}};
  if (closed) {
    soup.positions.emplace_back(0.3, 0.3, 0.8);
    soup.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  } else if (random_index(rng, 2) == 0) {
    soup.positions.emplace_back(1, 1, 0);
    soup.triangles.push_back({1, 3, 2});
  }
  while (static_cast<int>(soup.triangles.size()) + 2 <= n_faces) {
    split_random(rng, soup);
    for (int k = 0; k < 3; ++k) flip_random_edge(rng, soup, !closed);
  }
  return soup;
}

void place_vertices(Rng& rng, TriangleSoup& soup, const RandomMeshOptions& options) {
  if (options.closed) {
    for (Vec3& p : soup.positions) {
      p = Vec3(random_real(rng, -1, 1), random_real(rng, -1, 1), random_real(rng, -1, 1));
    }
  } else {
    const double height = std::array{0.0, 0.3, 1.0}[random_index(rng, 3)];
    for (Vec3& p : soup.positions) p.z() = random_real(rng, -height, height);
  }
  if (!options.slivers) return;
  const Triangle& some = soup.triangles[random_index(rng, static_cast<Index>(soup.triangles.size()))];
  soup.positions[some[0]] = soup.positions[some[1]] + 1e-4 * (soup.positions[some[0]] - soup.positions[some[1]]);
  const double squeeze = std::array{1.0, 0.1, 0.01}[random_index(rng, 3)];
  for (Vec3& p : soup.positions) p.x() *= squeeze;
}

/// Whether d lies well inside the circle through a face's corners, which run counter-clockwise.
bool in_circle(const TriangleSoup& soup, const Triangle& face, const Vec2& d) {
  std::array<Vec2, 3> to;
  for (int i = 0; i < 3; ++i) to[i] = soup.positions[face[i]].head<2>() - d;
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += to[i].squaredNorm() * cross(to[(i + 1) % 3], to[(i + 2) % 3]);
  return sum > 1e-9 * (to[0] - to[1]).squaredNorm() * (to[1] - to[2]).squaredNorm();
}

/// Takes the last point into a Delaunay triangulation (Bowyer 1981, Watson 1981).
void insert_last_point(TriangleSoup& soup) {
  const auto v = static_cast<Index>(soup.positions.size()) - 1;
  std::set<std::pair<Index, Index>> rim;
  std::erase_if(soup.triangles, [&](const Triangle& face) {
    if (!in_circle(soup, face, soup.positions[v].head<2>())) return false;
    for (int i = 0; i < 3; ++i) {
      if (rim.erase({face[(i + 1) % 3], face[i]}) == 0) rim.insert({face[i], face[(i + 1) % 3]});
    }
    return true;
  });
  for (const auto& [a, b] : rim) {
    if (signed_area(soup, a, b, v) > 1e-12) soup.triangles.push_back({a, b, v});
  }
}

}  // namespace

double random_real(Rng& rng, double low, double high) { return std::uniform_real_distribution<>(low, high)(rng); }

Index random_index(Rng& rng, Index n) { return std::uniform_int_distribution<Index>(0, n - 1)(rng); }

TriangleMesh random_mesh(Rng& rng, const RandomMeshOptions& options) {
  const int n_faces = options.min_faces + random_index(rng, options.max_faces - options.min_faces + 1);
  TriangleSoup soup = random_triangulation(rng, options.closed, n_faces);
  place_vertices(rng, soup, options);
  if (options.holes) {
    // A removed face may leave a vertex that is not manifold: such a removal is not made.
    for (int k = 0; k < n_faces / 5; ++k) {
      TriangleSoup fewer = soup;
      if (fewer.triangles.size() < 3) break;
      fewer.triangles.erase(fewer.triangles.begin() + random_index(rng, static_cast<Index>(soup.triangles.size())));
      try {
        TriangleMesh attempt(fewer);
        std::swap(soup, fewer);
      } catch (const Error&) {
        continue;
      }
    }
  }
  return TriangleMesh(std::move(soup));
}

TriangleMesh scattered_square(int n, double side, std::uint64_t seed) {
  Rng rng(seed);
  const double cell = side / n;
  TriangleSoup soup;
  soup.positions = {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (int k = 0; k < 4; ++k) {
    for (int i = 1; i < n; ++i) {
      const double along = cell * (i + random_real(rng, -0.3, 0.3));
      const double x = k % 2 == 0 ? along : (k == 1 ? side : 0);
      const double y = k % 2 == 1 ? along : (k == 2 ? side : 0);
      soup.positions.emplace_back(x, y, 0);
      insert_last_point(soup);
    }
  }
  for (int i = 0; i < n * n; ++i) {
    const Vec3 p(random_real(rng, 0.2 * cell, side - 0.2 * cell), random_real(rng, 0.2 * cell, side - 0.2 * cell), 0);
    const bool near = std::any_of(soup.positions.begin(), soup.positions.end(),
                                  [&](const Vec3& q) { return (p - q).norm() < 0.2 * cell; });
    if (near) continue;
    soup.positions.push_back(p);
    insert_last_point(soup);
  }
  return TriangleMesh(std::move(soup));
}

SurfacePoint random_surface_point(Rng& rng, const TriangleMesh& mesh) {
  double left = random_real(rng, 0, mesh.area());
  Index face = 0;
  while (face + 1 < mesh.n_faces() && left >= mesh.face_area(face)) left -= mesh.face_area(face++);
  const double root = std::sqrt(random_real(rng, 0, 1));
  const double v = random_real(rng, 0, 1);
  return {face, Vec3(1 - root, root * (1 - v), root * v)};
}

SurfacePoint random_supported_point(Rng& rng, const TriangleMesh& mesh) {
  const Index kind = random_index(rng, 3);
  if (kind == 0) return random_surface_point(rng, mesh);
  const Index halfedge = random_index(rng, mesh.n_halfedges());
  return point_on_halfedge(halfedge, kind == 1 ? random_real(rng, 0, 1) : 0.0);
}

void write_off(const TriangleMesh& mesh, const std::filesystem::path& path) {
  std::ofstream out(path);
  out.precision(17);
  out << "OFF\n" << mesh.n_vertices() << ' ' << mesh.n_faces() << " 0\n";
  for (Index v = 0; v < mesh.n_vertices(); ++v) out << mesh.position(v).transpose() << '\n';
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const auto& [a, b, c] = mesh.triangle(f);
    out << "3 " << a << ' ' << b << ' ' << c << '\n';
  }
}

}  // namespace isopath::test
