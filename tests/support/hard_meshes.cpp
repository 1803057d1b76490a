#include "support/hard_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

namespace isopath::test {
namespace {

/// 10 to a random power.
double power_of_ten(Rng& rng, double low, double high) { return std::pow(10.0, random_real(rng, low, high)); }

TriangleSoup flat_grid(Rng& rng) {
  const int nx = 1 + random_index(rng, 5);
  const int ny = 1 + random_index(rng, 5);
  const Diagonal diagonal = random_index(rng, 2) == 0 ? Diagonal::regular : Diagonal::union_jack;
  return planar_grid(nx, ny, nx, random_index(rng, 2) == 0 ? ny : 0.25 * ny, {.diagonal = diagonal}).soup();
}

TriangleSoup saddle(Rng& rng) { return saddle_cone(4 + 2 * random_index(rng, 15), 1, power_of_ten(rng, -1, 3)).soup(); }

TriangleSoup small_torus(Rng& rng) {
  TriangleSoup soup = torus(3 + random_index(rng, 4), 3 + random_index(rng, 3), 2, random_real(rng, 0.1, 1.5)).soup();
  if (random_index(rng, 2) == 0) return soup;
  for (Vec3& p : soup.positions) {
    p += 0.3 * Vec3(random_real(rng, -1, 1), random_real(rng, -1, 1), random_real(rng, -1, 1));
  }
  return soup;
}

TriangleSoup solid(Rng& rng) {
  switch (random_index(rng, 3)) {
    case 0:
      return box(Vec3::Zero(), Vec3(1, power_of_ten(rng, -6, 1), power_of_ten(rng, -3, 1))).soup();
    case 1:
      return cube(1 + random_index(rng, 2), 1).soup();
    default:
      return closed_pyramid(3 + random_index(rng, 12), 1, power_of_ten(rng, -6, 3)).soup();
  }
}

/// Star-shaped polygon, cut from its centre; many of its corners are seen under almost the same angle.
TriangleSoup needle_fan(Rng& rng) {
  std::vector<double> angles;
  for (int k = 0; k < 5; ++k) angles.push_back(2 * std::numbers::pi * (k + random_real(rng, 0, 0.2)) / 5);
  for (int k = random_index(rng, 12); k > 0; --k) {
    angles.push_back(angles[random_index(rng, static_cast<Index>(angles.size()))] + power_of_ten(rng, -8, -1));
  }
  std::sort(angles.begin(), angles.end());
  angles.erase(std::unique(angles.begin(), angles.end()), angles.end());
  std::vector<Vec2> polygon;
  for (const double a : angles) polygon.push_back(random_real(rng, 0.5, 1) * Vec2(std::cos(a), std::sin(a)));
  return planar_fan(Vec2::Zero(), polygon).soup();
}

TriangleSoup random_soup(Rng& rng) {
  return random_mesh(rng, {.closed = random_index(rng, 3) == 0,
                           .holes = random_index(rng, 4) == 0,
                           .slivers = random_index(rng, 4) == 0})
      .soup();
}

std::pair<TriangleSoup, std::string> shape(Rng& rng) {
  switch (random_index(rng, 10)) {
    case 0:
      return {flat_grid(rng), "flat grid"};
    case 1:
      return {saddle(rng), "saddle"};
    case 2:
      return {small_torus(rng), "torus"};
    case 3:
      return {solid(rng), "solid"};
    case 4:
      return {needle_fan(rng), "needle fan"};
    default:
      return {random_soup(rng), "random"};
  }
}

Triangle& random_triangle(Rng& rng, TriangleSoup& soup) {
  return soup.triangles[random_index(rng, static_cast<Index>(soup.triangles.size()))];
}

/// Moves a corner of some triangles close to the opposite edge, or onto it.
void flatten_triangles(Rng& rng, TriangleSoup& soup, double least_height) {
  const double lowest = std::log10(std::max(least_height, 1e-8));
  for (int k = 1 + random_index(rng, 3); k > 0; --k) {
    const Triangle t = random_triangle(rng, soup);
    const int i = random_index(rng, 3);
    const Vec3& a = soup.positions[t[(i + 1) % 3]];
    const Vec3& b = soup.positions[t[(i + 2) % 3]];
    const double share = random_index(rng, 4) == 0 ? 0.5 : random_real(rng, -0.5, 1.5);
    const Vec3 foot = (1 - share) * a + share * b;
    const Vec3 rise = soup.positions[t[i]] - foot;
    const double height = least_height == 0 && random_index(rng, 4) == 0 ? 0.0 : power_of_ten(rng, lowest, -2);
    soup.positions[t[i]] = foot + height * rise;
  }
}

/// Moves vertices close to a neighbour.
void pull_together(Rng& rng, TriangleSoup& soup, double least_distance) {
  const double size = bounding_box(soup).diagonal().norm();
  for (int k = 1 + random_index(rng, 3); k > 0; --k) {
    const Triangle t = random_triangle(rng, soup);
    const Vec3 to = soup.positions[t[1]];
    const Vec3 way = soup.positions[t[0]] - to;
    const double distance = power_of_ten(rng, std::log10(least_distance), -2) * size;
    if (distance < way.norm()) soup.positions[t[0]] = to + distance * way.normalized();
  }
}

/// Moving one corner may spoil more triangles than the one that was meant.
bool is_within(const TriangleMesh& mesh, const HardMeshOptions& options) {
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    double longest = 0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const double length = mesh.edge_length(mesh.edge_of(h));
      if (options.least_distance > 1e-15 && length < options.least_distance * mesh.size()) return false;
      longest = std::max(longest, length);
    }
    if (2 * mesh.face_area(f) < options.least_height * longest * longest) return false;
  }
  return true;
}

TriangleSoup together(const TriangleSoup& a, const TriangleSoup& b) {
  TriangleSoup both = a;
  const auto shift = static_cast<Index>(a.positions.size());
  for (const Vec3& p : b.positions) both.positions.emplace_back(p + Vec3(3, 0, 0));
  for (const auto& [x, y, z] : b.triangles) both.triangles.push_back({x + shift, y + shift, z + shift});
  return both;
}

HardMesh attempt(Rng& rng, const HardMeshOptions& options) {
  auto [soup, kind] = shape(rng);
  if (random_index(rng, 8) == 0) {
    soup = together(soup, shape(rng).first);
    kind += " + another";
  }
  if (random_index(rng, 8) == 0) {
    const double squeeze = power_of_ten(rng, std::log10(options.strongest_squeeze), -1);
    for (Vec3& p : soup.positions) p.x() *= squeeze;
    kind += ", squeezed";
  }
  if (random_index(rng, 3) == 0) {
    flatten_triangles(rng, soup, options.least_height);
    kind += ", slivers";
  }
  if (random_index(rng, 4) == 0) {
    pull_together(rng, soup, options.least_distance);
    kind += ", close vertices";
  }
  const double scale = std::array{1.0, 1.0, 1e-9, 1e12}[random_index(rng, 4)];
  for (Vec3& p : soup.positions) p *= scale;
  return {TriangleMesh(std::move(soup)), kind};
}

}  // namespace

Renumbered renumbered(Rng& rng, const TriangleMesh& mesh) {
  Renumbered result;
  result.vertex.resize(mesh.n_vertices());
  result.face.resize(mesh.n_faces());
  std::iota(result.vertex.begin(), result.vertex.end(), 0);
  std::iota(result.face.begin(), result.face.end(), 0);
  std::shuffle(result.vertex.begin(), result.vertex.end(), rng);
  std::shuffle(result.face.begin(), result.face.end(), rng);
  TriangleSoup soup = mesh.soup();
  for (Index v = 0; v < mesh.n_vertices(); ++v) soup.positions[result.vertex[v]] = mesh.position(v);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    for (int i = 0; i < 3; ++i) soup.triangles[result.face[f]][i] = result.vertex[mesh.triangle(f)[i]];
  }
  result.mesh = TriangleMesh(std::move(soup));
  return result;
}

HardMesh hard_mesh(Rng& rng, const HardMeshOptions& options) {
  for (;;) {
    HardMesh result = attempt(rng, options);
    if (is_within(result.mesh, options)) return {renumbered(rng, result.mesh).mesh, result.kind};
  }
}

}  // namespace isopath::test
