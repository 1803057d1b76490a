#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/field/surface_function.h"
#include "isopath/mesh/triangle_mesh.h"
#include "support/test_meshes.h"

namespace isopath::test {

/// The square [0, side]² in the plane z = 0, of n × n cells whose diagonals alternate.
inline TriangleMesh square(int n, double side = 1) {
  return test::planar_grid(n, n, side, side, {.diagonal = test::Diagonal::union_jack});
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

}  // namespace isopath::test
