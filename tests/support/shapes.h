#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "isopath/mesh/triangle_mesh.h"

/// Analytic shapes as meshes, for the tests of every layer. Lengths in mm.
namespace isopath::shapes {

/// The graph z = height(x, y) over [0, width] × [0, depth], nx × ny squares of two triangles, normals towards +z.
inline TriangleMesh graph(int nx, int ny, double width, double depth,
                          const std::function<double(double, double)>& height) {
  TriangleSoup soup;
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      const double x = width * i / nx;
      const double y = depth * j / ny;
      soup.positions.emplace_back(x, y, height(x, y));
    }
  }
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const Index a = j * (nx + 1) + i;
      const Index d = a + nx + 1;
      soup.triangles.push_back({a, a + 1, d + 1});
      soup.triangles.push_back({a, d + 1, d});
    }
  }
  return TriangleMesh(std::move(soup));
}

inline TriangleMesh plane(int nx, int ny, double width, double depth) {
  return graph(nx, ny, width, depth, [](double, double) { return 0.0; });
}

/// A periodic parameter grid (u across, v up) of nu × nv squares: closed in u, and in v when `close_v` holds.
inline TriangleMesh tube(int nu, int nv, bool close_v, const std::function<Vec3(double, double)>& point) {
  TriangleSoup soup;
  const int rows = close_v ? nv : nv + 1;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < nu; ++i) soup.positions.push_back(point(double(i) / nu, double(j) / nv));
  }
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nu; ++i) {
      const auto at = [&](int p, int q) { return static_cast<Index>((q % rows) * nu + p % nu); };
      soup.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return TriangleMesh(std::move(soup));
}

/// Open cylinder about the z axis from z = 0, normals outward.
inline TriangleMesh cylinder(int around, int along, double radius, double height) {
  return tube(around, along, false, [=](double u, double v) {
    const double phi = 2 * std::numbers::pi * u;
    return Vec3(radius * std::cos(phi), radius * std::sin(phi), height * v);
  });
}

/// Torus about the z axis, normals outward.
inline TriangleMesh torus(int around, int across, double major, double minor) {
  return tube(around, across, true, [=](double u, double v) {
    const double phi = 2 * std::numbers::pi * u;
    const double psi = 2 * std::numbers::pi * v;
    const double r = major + minor * std::cos(psi);
    return Vec3(r * std::cos(phi), r * std::sin(phi), minor * std::sin(psi));
  });
}

/// Axis-parallel box of 12 triangles, normals outward.
inline TriangleMesh box(const Vec3& low, const Vec3& high) {
  TriangleSoup soup;
  for (int i = 0; i < 8; ++i) {
    soup.positions.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
  }
  soup.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return TriangleMesh(std::move(soup));
}

/// Sphere about the origin: the octahedron split 1-to-4 `level` times and pushed out, normals outward.
inline TriangleMesh sphere(int level, double radius) {
  TriangleSoup soup;
  for (const double sign : {1.0, -1.0}) {
    for (int axis = 0; axis < 3; ++axis) soup.positions.push_back(sign * Vec3::Unit(axis));
  }
  soup.triangles = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2}, {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  for (int k = 0; k < level; ++k) {
    std::map<std::pair<Index, Index>, Index> middle;
    const auto mid = [&](Index a, Index b) {
      const auto [it, fresh] = middle.try_emplace(std::minmax(a, b), static_cast<Index>(soup.positions.size()));
      if (fresh) soup.positions.push_back((soup.positions[a] + soup.positions[b]).normalized());
      return it->second;
    };
    std::vector<Triangle> fine;
    for (const auto& [a, b, c] : soup.triangles) {
      const std::array<Index, 3> m = {mid(a, b), mid(b, c), mid(c, a)};
      fine.insert(fine.end(), {{a, m[0], m[2]}, {b, m[1], m[0]}, {c, m[2], m[1]}, {m[0], m[1], m[2]}});
    }
    soup.triangles = std::move(fine);
  }
  for (Vec3& p : soup.positions) p *= radius;
  return TriangleMesh(std::move(soup));
}

}  // namespace isopath::shapes
