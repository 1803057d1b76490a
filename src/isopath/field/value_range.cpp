#include "isopath/field/value_range.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace isopath {
namespace {

/// A part of a face, by the barycentric coordinates of its corners.
struct Part {
  Index face;
  Vec3 corner[3];
  int depth = 0;

  static Part whole(Index face) { return {face, {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}}; }
  Vec3 centre() const { return (corner[0] + corner[1] + corner[2]) / 3; }
};

constexpr int deepest = 24;

/// Distance from the centre to the farthest corner.
double radius_of(const TriangleMesh& mesh, const Part& part) {
  const Vec3 place = position_of(mesh, {part.face, part.centre()});
  double radius = 0;
  for (const Vec3& c : part.corner) radius = std::max(radius, (position_of(mesh, {part.face, c}) - place).norm());
  return radius;
}

/// In two across the longest side: thin parts become round.
void divide(const TriangleMesh& mesh, const Part& part, std::vector<Part>& parts) {
  int longest = 0;
  double most = -1;
  for (int i = 0; i < 3; ++i) {
    const double side =
        (position_of(mesh, {part.face, part.corner[i]}) - position_of(mesh, {part.face, part.corner[(i + 1) % 3]}))
            .norm();
    if (side > most) {
      most = side;
      longest = i;
    }
  }
  const Vec3 a = part.corner[longest];
  const Vec3 b = part.corner[(longest + 1) % 3];
  const Vec3 c = part.corner[(longest + 2) % 3];
  const Vec3 middle = 0.5 * (a + b);
  parts.push_back({part.face, {a, middle, c}, part.depth + 1});
  parts.push_back({part.face, {middle, b, c}, part.depth + 1});
}

bool is_reached(const TriangleMesh& mesh, const SurfaceFunction& function, Index face) {
  const auto& corners = mesh.triangle(face);
  return std::all_of(corners.begin(), corners.end(),
                     [&](Index v) { return std::isfinite(function.value_at_vertex(v)); });
}

/// Widens the range by what the face holds inside; finer only where the slope allows values beyond it.
void search(const TriangleMesh& mesh, const SurfaceFunction& function, Index face, double tolerance,
            ValueRange& range) {
  std::vector<Part> parts{Part::whole(face)};
  while (!parts.empty()) {
    const Part part = parts.back();
    parts.pop_back();
    const double value = function.value({face, part.centre()});
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
    const double reach = radius_of(mesh, part) * function.max_slope();
    const bool beyond = value + reach > range.high + tolerance ||
                        std::max(value - reach, function.lower_bound()) < range.low - tolerance;
    if (beyond && part.depth < deepest) divide(mesh, part, parts);
  }
}

bool may_reach(const TriangleMesh& mesh, const SurfaceFunction& function, Index face, double level) {
  std::vector<Part> parts{Part::whole(face)};
  while (!parts.empty()) {
    const Part part = parts.back();
    parts.pop_back();
    const double value = function.value({face, part.centre()});
    if (value >= level) return true;
    if (value + radius_of(mesh, part) * function.max_slope() < level) continue;
    if (part.depth >= deepest) return true;
    divide(mesh, part, parts);
  }
  return false;
}

}  // namespace

ValueRange value_range(const TriangleMesh& mesh, const SurfaceFunction& function, double tolerance,
                       const Progress& progress) {
  ValueRange range;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const double value = function.value_at_vertex(v);
    if (mesh.outgoing(v) == no_index || !std::isfinite(value)) continue;
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  }
  if (function.linear_in_faces()) return range;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    progress.checkpoint();
    if (is_reached(mesh, function, f)) search(mesh, function, f, tolerance, range);
  }
  return range;
}

std::vector<char> faces_that_may_reach(const TriangleMesh& mesh, const SurfaceFunction& function, double level,
                                       const Progress& progress) {
  std::vector<char> may(mesh.n_faces(), 0);
  tbb::parallel_for(Index{0}, mesh.n_faces(), [&](Index f) {
    progress.checkpoint();
    may[f] = is_reached(mesh, function, f) && may_reach(mesh, function, f, level);
  });
  return may;
}

}  // namespace isopath
