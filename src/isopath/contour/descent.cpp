#include "isopath/contour/descent.h"

#include <algorithm>
#include <vector>

#include "isopath/core/segment.h"

namespace isopath {

namespace {

// A way down meets a face once or, where it bends over a ridge of the mesh, a few times; this only bounds what rounding
// could keep going.
constexpr int most_steps = 100000;

}  // namespace

Index Descent::piece_below(SurfacePoint start, Index level) const {
  const double goal = cut_.levels[level];
  SurfacePoint point = start;
  for (int i = 0; i < most_steps; ++i) {
    const Step step = steepest(point);
    if (!(step.rate > 0)) return no_index;
    if (function_.value(step.to) >= goal) {
      point = step.to;
      continue;
    }
    double high = 0;
    double low = 1;
    SurfacePoint met = step.to;
    for (int k = 0; k < 50; ++k) {
      const double middle = (high + low) / 2;
      met.barycentric = (1 - middle) * step.from.barycentric + middle * step.to.barycentric;
      (function_.value(met) >= goal ? high : low) = middle;
    }
    return nearest_piece(met, level);
  }
  return no_index;
}

/// The steepest of: down each face around the point, and along each edge from it.
Descent::Step Descent::steepest(const SurfacePoint& point) const {
  Step best;
  const Support support = support_of(mesh_, point);
  if (support.kind == Support::Kind::face) {
    try_down_the_face(point, best);
  } else if (support.kind == Support::Kind::edge) {
    for (const Index h : {support.index, mesh_.twin(support.index)}) {
      if (h == no_index) continue;
      try_down_the_face(express_in(mesh_, point, TriangleMesh::face_of(h)), best);
      try_along(h, point, best);
    }
  } else {
    const Index first = mesh_.outgoing(support.index);
    Index h = first;
    do {
      try_down_the_face(point_on_halfedge(h, 0), best);
      try_along(h, point, best);
      // The last edge of a boundary vertex has no outgoing half-edge.
      if (mesh_.next_outgoing(h) == no_index) {
        consider(point_on_halfedge(TriangleMesh::prev(h), 1), point_on_halfedge(TriangleMesh::prev(h), 0), best);
      }
      h = mesh_.next_outgoing(h);
    } while (h != no_index && h != first);
  }
  return best;
}

void Descent::consider(const SurfacePoint& from, const SurfacePoint& to, Step& best) const {
  const double length = (position_of(mesh_, to) - position_of(mesh_, from)).norm();
  if (length <= mesh_.tolerance().length) return;
  const double rate = (function_.value(from) - function_.value(to)) / length;
  if (rate > best.rate) best = {from, to, rate};
}

void Descent::try_along(Index halfedge, const SurfacePoint& point, Step& best) const {
  consider(express_in(mesh_, point, TriangleMesh::face_of(halfedge)), point_on_halfedge(halfedge, 1), best);
}

/// Straight down to the face's boundary: for linear functions and distances the way down inside a face is straight.
void Descent::try_down_the_face(const SurfacePoint& point, Step& best) const {
  if (LevelCut::is_unreached(mesh_, function_, point.face)) return;
  const Vec3 down = -function_.slope(point).ascent;
  const Vec3 normal = mesh_.face_normal(point.face);
  const double twice_area = 2 * mesh_.face_area(point.face);
  if (!(twice_area > 0) || down.isZero()) return;
  const Triangle& corners = mesh_.triangle(point.face);
  Vec3 rate;
  double limit = infinity;
  int leaves = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 opposite = mesh_.position(corners[(i + 2) % 3]) - mesh_.position(corners[(i + 1) % 3]);
    rate[i] = down.dot(normal.cross(opposite)) / twice_area;
    if (rate[i] < 0 && point.barycentric[i] / -rate[i] < limit) {
      limit = point.barycentric[i] / -rate[i];
      leaves = i;
    }
  }
  if (!(limit > 0) || limit == infinity) return;
  SurfacePoint exit{point.face, (point.barycentric + limit * rate).cwiseMax(0)};
  exit.barycentric[leaves] = 0;
  exit.barycentric /= exit.barycentric.sum();
  consider(point, exit, best);
}

Index Descent::nearest_piece(const SurfacePoint& point, Index level) const {
  const auto range = std::equal_range(
      cut_.pieces.begin(), cut_.pieces.end(), LevelCut::Piece{point.face, level, no_index, no_index, 0, 0},
      [](const auto& a, const auto& b) { return std::pair(a.face, a.level) < std::pair(b.face, b.level); });
  const Vec3 position = position_of(mesh_, point);
  Index nearest = no_index;
  double best = infinity;
  for (auto piece = range.first; piece != range.second; ++piece) {
    const double distance = distance_to_piece(position, *piece);
    if (distance < best) {
      best = distance;
      nearest = static_cast<Index>(piece - cut_.pieces.begin());
    }
  }
  return nearest;
}

double Descent::distance_to_piece(const Vec3& point, const LevelCut::Piece& piece) const {
  std::vector<Vec3> line;
  if (!piece.is_loop()) line.push_back(position_of(mesh_, cut_.point_of(mesh_, piece.from)));
  for (const SurfacePoint& p : cut_.points_of(piece)) line.push_back(position_of(mesh_, p));
  line.push_back(piece.is_loop() ? line.front() : position_of(mesh_, cut_.point_of(mesh_, piece.to)));
  double best = infinity;
  for (std::size_t i = 1; i < line.size(); ++i) {
    best = std::min(best, distance_to_segment(line[i - 1], line[i], point));
  }
  return best;
}

}  // namespace isopath
