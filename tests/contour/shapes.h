#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/field/surface_function.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath::testing {

/// A grid of n × m cells over [0,1]², placed by `place`; either direction may wrap round. Normals towards +z for the
/// identity. Cells' diagonals alternate.
inline TriangleMesh grid(int n, int m, const std::function<Vec3(double, double)>& place, bool wrap_u = false,
                         bool wrap_v = false) {
  TriangleSoup soup;
  const int columns = wrap_u ? n : n + 1;
  const int rows = wrap_v ? m : m + 1;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) soup.positions.push_back(place(double(i) / n, double(j) / m));
  }
  const auto at = [&](int i, int j) { return Index((j % rows) * columns + i % columns); };
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < n; ++i) {
      const Index a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      if ((i + j) % 2 == 0) {
        soup.triangles.push_back({a, b, c});
        soup.triangles.push_back({a, c, d});
      } else {
        soup.triangles.push_back({a, b, d});
        soup.triangles.push_back({b, c, d});
      }
    }
  }
  return TriangleMesh(std::move(soup));
}

inline TriangleMesh square(int n, double side = 1) {
  return grid(n, n, [side](double u, double v) { return Vec3(side * u, side * v, 0); });
}

/// An octahedron, each face divided into n² triangles, blown up to the unit sphere.
inline TriangleMesh sphere(int n) {
  TriangleSoup soup;
  const std::array<Vec3, 6> tips{Vec3(1, 0, 0),  Vec3(0, 1, 0), Vec3(-1, 0, 0),
                                 Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)};
  const auto vertex = [&](const Vec3& p) {
    const Vec3 q = p.normalized();
    for (std::size_t i = 0; i < soup.positions.size(); ++i) {
      if ((soup.positions[i] - q).norm() < 1e-9) return Index(i);
    }
    soup.positions.push_back(q);
    return Index(soup.positions.size() - 1);
  };
  for (int k = 0; k < 8; ++k) {
    const Vec3 a = tips[k % 4], b = tips[(k + 1) % 4], c = tips[4 + k / 4];
    const auto at = [&](int i, int j) { return vertex((n - i - j) * a + i * b + j * c); };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        const auto add = [&](Index p, Index q, Index r) {
          if (k < 4) soup.triangles.push_back({p, q, r});
          if (k >= 4) soup.triangles.push_back({p, r, q});
        };
        add(at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < n) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
    }
  }
  return TriangleMesh(std::move(soup));
}

/// Distance in space to the nearest of some points in the plane of a flat mesh: its isolines are arcs of circles.
class PointDistance final : public SurfaceFunction {
 public:
  PointDistance(const TriangleMesh& mesh, std::vector<Vec3> centres) : mesh_(mesh), centres_(std::move(centres)) {}

  double value_at(const Vec3& p) const {
    double best = infinity;
    for (const Vec3& c : centres_) best = std::min(best, (p - c).norm());
    return best;
  }
  double value_at_vertex(Index vertex) const override { return value_at(mesh_.position(vertex)); }
  double value(const SurfacePoint& point) const override { return value_at(position_of(mesh_, point)); }
  Slope slope(const SurfacePoint& point) const override {
    const Vec3 p = position_of(mesh_, point);
    const double d = value_at(p);
    for (const Vec3& c : centres_) {
      if ((p - c).norm() == d && d > 0) return {d, (p - c) / d};
    }
    return {d};
  }
  /// Ends of the union of the stretches that lie nearer than `level` to some centre.
  void edge_crossings(Index edge, double level, std::vector<double>& parameters) const override {
    const Index h = mesh_.halfedge_of(edge);
    const Vec3 a = mesh_.position(mesh_.from(h));
    const Vec3 d = mesh_.position(mesh_.to(h)) - a;
    std::vector<std::array<double, 2>> below;
    for (const Vec3& c : centres_) {
      const double middle = (c - a).dot(d) / d.squaredNorm();
      const double rest = level * level - (a + middle * d - c).squaredNorm();
      if (rest <= 0) continue;
      const double half = std::sqrt(rest) / d.norm();
      below.push_back({middle - half, middle + half});
    }
    std::sort(below.begin(), below.end());
    std::vector<std::array<double, 2>> joined;
    for (const auto& b : below) {
      if (!joined.empty() && b[0] <= joined.back()[1]) {
        joined.back()[1] = std::max(joined.back()[1], b[1]);
      } else {
        joined.push_back(b);
      }
    }
    for (const auto& b : joined) {
      for (const double t : b) {
        if (t >= 0 && t <= 1) parameters.push_back(t);
      }
    }
  }
  bool linear_in_faces() const override { return false; }
  bool monotone_in_face(Index) const override { return false; }
  double max_slope() const override { return 1; }

 private:
  const TriangleMesh& mesh_;
  std::vector<Vec3> centres_;
};

inline std::vector<double> random_values(const TriangleMesh& mesh, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> values;
  for (Index v = 0; v < mesh.n_vertices(); ++v) values.push_back(uniform(random));
  return values;
}

}  // namespace isopath::testing
