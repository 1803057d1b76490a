#include "isopath/field/value_range.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "isopath/field/face_part.h"

namespace isopath {
namespace {

constexpr int deepest = 24;

bool is_reached(const TriangleMesh& mesh, const SurfaceFunction& function, Index face) {
  const auto& corners = mesh.triangle(face);
  return std::all_of(corners.begin(), corners.end(),
                     [&](Index v) { return std::isfinite(function.value_at_vertex(v)); });
}

enum class Look { closer, away, enough };

/// Shows the judge the value in the middle of the face, and how far others may be off it, and then of its halves where
/// the judge wants to look closer.
template <class Judge>
void look_at(const TriangleMesh& mesh, const SurfaceFunction& function, Index face, const Judge& judge) {
  const FaceCorners corners = corners_of(mesh, face);
  std::vector<FacePart> parts{FacePart::whole(face)};
  while (!parts.empty()) {
    const FacePart part = parts.back();
    parts.pop_back();
    const double value = function.value({face, part.centre()});
    const Look next = judge(value, radius_of(corners, part) * function.max_slope(), part.depth < deepest);
    if (next == Look::enough) return;
    if (next == Look::closer) halve(corners, part, parts);
  }
}

/// Widens the range by what the face holds inside; finer only where the slope allows values beyond it.
void search(const TriangleMesh& mesh, const SurfaceFunction& function, Index face, double tolerance,
            ValueRange& range) {
  look_at(mesh, function, face, [&](double value, double reach, bool may_halve) {
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
    const bool beyond = value + reach > range.high + tolerance ||
                        std::max(value - reach, function.lower_bound()) < range.low - tolerance;
    return beyond && may_halve ? Look::closer : Look::away;
  });
}

bool may_reach(const TriangleMesh& mesh, const SurfaceFunction& function, Index face, double level) {
  bool may = false;
  look_at(mesh, function, face, [&](double value, double reach, bool may_halve) {
    if (value + reach < level) return Look::away;
    may = value >= level || !may_halve;
    return may ? Look::enough : Look::closer;
  });
  return may;
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
