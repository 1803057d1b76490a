#include "isopath/impact/moved_levels.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace isopath {
namespace {

/// True when the function may take a value between `low` and `high` in the face: by its slope no value there is farther
/// from that of any corner than the longest side allows.
bool may_take(const TriangleMesh& mesh, const SurfaceFunction& function, Index face, double low, double high) {
  double longest = 0;
  for (Index h = 3 * face; h < 3 * face + 3; ++h) longest = std::max(longest, mesh.edge_length(mesh.edge_of(h)));
  const double reach = longest * function.max_slope();
  return std::all_of(mesh.triangle(face).begin(), mesh.triangle(face).end(), [&](Index v) {
    const double value = function.value_at_vertex(v);
    return std::isfinite(value) && value - reach <= high && value + reach >= low;
  });
}

}  // namespace

MovedLevels::MovedLevels(const TriangleMesh& mesh, const SurfaceFunction& function, std::vector<double> level_of_vertex)
    : mesh_(mesh), function_(function), level_(std::move(level_of_vertex)) {}

double MovedLevels::level_in(Index face) const {
  double level = -infinity;
  for (const Index v : mesh_.triangle(face)) level = std::max(level, level_[v]);
  return level;
}

double MovedLevels::value_at_vertex(Index vertex) const {
  return level_[vertex] < infinity ? function_.value_at_vertex(vertex) - level_[vertex] : infinity;
}

double MovedLevels::value(const SurfacePoint& point) const {
  const double level = level_in(point.face);
  return level < infinity ? function_.value(point) - level : infinity;
}

SurfaceFunction::Slope MovedLevels::slope(const SurfacePoint& point) const {
  const double level = level_in(point.face);
  if (!(level < infinity)) return {.value = infinity};
  Slope slope = function_.slope(point);
  slope.value -= level;
  return slope;
}

void MovedLevels::edge_crossings(Index edge, double level, std::vector<double>& parameters) const {
  const Index h = mesh_.halfedge_of(edge);
  const double base = std::max(level_[mesh_.from(h)], level_[mesh_.to(h)]);
  if (base < infinity) function_.edge_crossings(edge, base + level, parameters);
}

std::vector<Contour> contours_beside(const TriangleMesh& mesh, const SurfaceFunction& function, const Contour& from,
                                     double level, Progress& progress) {
  const auto [low, high] = std::minmax(from.level, level);
  std::vector<double> level_of_vertex(mesh.n_vertices(), infinity);
  std::vector<char> seen(mesh.n_faces(), 0);
  std::vector<Index> open;
  const auto visit = [&](Index face) {
    if (seen[face] || !may_take(mesh, function, face, low, high)) return;
    seen[face] = 1;
    open.push_back(face);
  };
  for (const SurfacePoint& point : from.points) visit(point.face);
  while (!open.empty()) {
    progress.checkpoint();
    const Index face = open.back();
    open.pop_back();
    for (const Index v : mesh.triangle(face)) level_of_vertex[v] = level;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      if (mesh.twin(h) != no_index) visit(TriangleMesh::face_of(mesh.twin(h)));
    }
  }
  const double zero = 0;
  std::vector<Contour> contours =
      isolines(mesh, MovedLevels(mesh, function, std::move(level_of_vertex)), std::span(&zero, 1), {}, progress);
  for (Contour& contour : contours) contour.level = level;
  return contours;
}

}  // namespace isopath
