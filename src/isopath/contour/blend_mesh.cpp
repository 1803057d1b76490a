#include "isopath/contour/blend_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "isopath/mesh/refine.h"

namespace isopath {
namespace {

constexpr double longest_in_spacings = 0.4;
constexpr double shortest_in_spacings = 1.0 / 12;
constexpr double error_in_spacings = 0.012;
/// Beyond this a finer mesh costs more than it brings.
constexpr Index most_faces = 2000000;
constexpr int most_levels = 3;
/// Edges along which the levels change by more are split.
constexpr double most_levels_over_edge = 0.8;

}  // namespace

RefinedMesh refine_for_blend(const TriangleMesh& mesh, const SurfaceFunction& distance, double spacing,
                             const Progress& progress) {
  RefinedMesh even = split_long_edges(mesh, longest_in_spacings * spacing, most_faces);
  if (even.mesh.n_faces() >= most_faces / 2) return even;
  const auto value = [&](Index face, const Vec3& b) {
    const Triangle& corners = even.mesh.triangle(face);
    Vec3 on_old = Vec3::Zero();
    for (int i = 0; i < 3; ++i)
      on_old += b[i] * express_in(mesh, even.on_old[corners[i]], even.old_face[face]).barycentric;
    return distance.value({even.old_face[face], on_old});
  };
  int asked = 0;
  const auto is_kinked = [&](const RefineTriangle& triangle) {
    if (++asked % 1024 == 0) progress.checkpoint();
    double longest = 0;
    for (int i = 0; i < 3; ++i)
      longest = std::max(longest, (triangle.position[i] - triangle.position[(i + 1) % 3]).norm());
    if (longest < shortest_in_spacings * spacing) return false;
    std::array<double, 3> corner;
    for (int i = 0; i < 3; ++i) corner[i] = value(triangle.face, triangle.barycentric[i]);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      if (!(corner[i] + corner[j] < infinity)) return false;
      const double middle = value(triangle.face, 0.5 * (triangle.barycentric[i] + triangle.barycentric[j]));
      if (std::abs(middle - 0.5 * (corner[i] + corner[j])) > error_in_spacings * spacing) return true;
    }
    const Vec3 centre = (triangle.barycentric[0] + triangle.barycentric[1] + triangle.barycentric[2]) / 3;
    return std::abs(value(triangle.face, centre) - (corner[0] + corner[1] + corner[2]) / 3) >
           error_in_spacings * spacing;
  };
  return composed(mesh, even, refine(even.mesh, is_kinked, most_levels));
}

RefinedMesh refine_for_levels(const TriangleMesh& mesh, std::span<const double> values, double spacing,
                              const Progress& progress) {
  int asked = 0;
  const auto is_steep = [&](const RefineTriangle& triangle) {
    if (++asked % 4096 == 0) progress.checkpoint();
    const Triangle& t = mesh.triangle(triangle.face);
    const Vec3 at_corners(values[t[0]], values[t[1]], values[t[2]]);
    std::array<double, 3> value;
    for (int i = 0; i < 3; ++i) value[i] = triangle.barycentric[i].dot(at_corners);
    const auto [low, high] = std::minmax_element(value.begin(), value.end());
    return *high<infinity&& * high - *low> most_levels_over_edge * spacing;
  };
  return refine(mesh, is_steep, most_levels);
}

}  // namespace isopath
