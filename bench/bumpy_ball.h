#pragma once

#include <cmath>

#include "isopath/mesh/triangle_mesh.h"
#include "support/test_meshes.h"

namespace isopath {

/// A ball with waves of many lengths and noise, as a scan has: no two vertices are alike.
inline TriangleMesh bumpy_ball(int level) {
  TriangleSoup soup = test::icosphere(level, 1).soup();
  test::Rng rng(3);
  const double edge = std::sqrt(16 * std::acos(-1.0) / static_cast<double>(soup.triangles.size()) / std::sqrt(3.0));
  for (Vec3& p : soup.positions) {
    double radius = 1;
    for (int k = 2; k < 16; ++k) radius += 0.1 / k * std::sin(k * p.x() + 2 * k) * std::cos(k * p.y() - p.z());
    p *= radius;
    for (int i = 0; i < 3; ++i) p[i] += 0.1 * edge * test::random_real(rng, -1, 1);
  }
  return TriangleMesh(std::move(soup));
}

}  // namespace isopath
