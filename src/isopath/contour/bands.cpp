#include "isopath/contour/bands.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace isopath {

Bands::Bands(const TriangleMesh& mesh, const SurfaceFunction& function, const LevelCut& cut) : mesh_(mesh), cut_(cut) {
  const auto n_pieces = static_cast<Index>(cut.pieces.size());
  const auto n_intervals = static_cast<Index>(cut.crossings.size()) + mesh.n_edges();
  const auto n_loops = std::count_if(cut.pieces.begin(), cut.pieces.end(), [](const auto& p) { return p.is_loop(); });
  parent_.resize(static_cast<std::size_t>(n_intervals) + 2 * static_cast<std::size_t>(n_loops));
  std::iota(parent_.begin(), parent_.end(), Index{0});
  above_.resize(cut.pieces.size());
  below_.resize(cut.pieces.size());
  Index free_node = n_intervals;
  for (Index piece = 0; piece < n_pieces; ++piece) {
    if (cut.pieces[piece].is_loop()) {
      above_[piece] = free_node++;
      below_[piece] = free_node++;
    } else {
      join_along(piece);
    }
  }
  join_at_corners(function);
  for (Index first = 0; first < n_pieces;) {
    Index last = first;
    while (last < n_pieces && cut.pieces[last].face == cut.pieces[first].face) ++last;
    for (Index piece = first; piece < last; ++piece) {
      if (cut.pieces[piece].is_loop()) place_loop(piece, first, last);
    }
    first = last;
  }
}

Index Bands::at_start(Index halfedge) const {
  const Index edge = mesh_.edge_of(halfedge);
  if (mesh_.halfedge_of(edge) == halfedge) return interval(edge, 0);
  return interval(edge, cut_.first_of_edge[edge + 1] - cut_.first_of_edge[edge]);
}

Index Bands::at_end(Index halfedge) const {
  const Index edge = mesh_.edge_of(halfedge);
  if (mesh_.halfedge_of(edge) != halfedge) return interval(edge, 0);
  return interval(edge, cut_.first_of_edge[edge + 1] - cut_.first_of_edge[edge]);
}

/// The interval that holds the point at fraction t of a half-edge.
Index Bands::interval_at(Index halfedge, double t) const {
  const Index edge = mesh_.edge_of(halfedge);
  if (mesh_.halfedge_of(edge) != halfedge) t = 1 - t;
  Index k = cut_.first_of_edge[edge];
  while (k < cut_.first_of_edge[edge + 1] && cut_.crossings[k].parameter < t) ++k;
  return interval(edge, k - cut_.first_of_edge[edge]);
}

/// Around a vertex nothing is crossed, so what meets there in a reached face is one component.
void Bands::join_at_corners(const SurfaceFunction& function) {
  for (Index face = 0; face < mesh_.n_faces(); ++face) {
    if (LevelCut::is_unreached(mesh_, function, face)) continue;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) unite(at_end(h), at_start(TriangleMesh::next(h)));
  }
}

/// A piece runs from where the walk around the face falls to where it rises: after the rise and before the fall the
/// walk is on the piece's left.
void Bands::join_along(Index piece) {
  const LevelCut::Piece& p = cut_.pieces[piece];
  const auto sides = [&](Index crossing) {
    const Index edge = cut_.crossings[crossing].edge;
    const Index k = crossing - cut_.first_of_edge[edge];
    const bool canonical = TriangleMesh::face_of(mesh_.halfedge_of(edge)) == p.face;
    const std::pair along{interval(edge, k), interval(edge, k + 1)};
    return canonical ? along : std::pair{along.second, along.first};  // before and after it on the walk
  };
  const auto [before_fall, after_fall] = sides(p.from);
  const auto [before_rise, after_rise] = sides(p.to);
  unite(before_fall, after_rise);
  unite(after_fall, before_rise);
  above_[piece] = after_rise;
  below_[piece] = before_rise;
}

/// A piece in the plane of barycentric coordinates 1 and 2, which keeps orientation; loops repeat their first point.
std::vector<Vec2> Bands::outline(Index piece) const {
  const LevelCut::Piece& p = cut_.pieces[piece];
  std::vector<Vec2> points;
  const auto add = [&](const SurfacePoint& point) { points.emplace_back(point.barycentric[1], point.barycentric[2]); };
  if (!p.is_loop()) add(express_in(mesh_, cut_.point_of(mesh_, p.from), p.face));
  for (const SurfacePoint& point : cut_.points_of(p)) add(point);
  if (!p.is_loop()) add(express_in(mesh_, cut_.point_of(mesh_, p.to), p.face));
  if (p.is_loop()) points.push_back(points.front());
  return points;
}

/// Joins the outside of a loop with what a ray from its rightmost point meets first: another piece of its face, or the
/// face's boundary.
void Bands::place_loop(Index piece, Index first_of_face, Index last_of_face) {
  const std::vector<Vec2> loop = outline(piece);
  double twice_area = 0;
  Vec2 start = loop.front();
  for (std::size_t i = 1; i < loop.size(); ++i) {
    twice_area += cross(loop[i - 1], loop[i]);
    if (loop[i].x() > start.x()) start = loop[i];
  }
  const Index outside = twice_area > 0 ? below_[piece] : above_[piece];
  double nearest = infinity;
  Index met = interval_at(3 * cut_.pieces[piece].face + 1, start.y());
  for (Index other = first_of_face; other < last_of_face; ++other) {
    if (other == piece) continue;
    const std::vector<Vec2> line = outline(other);
    for (std::size_t i = 1; i < line.size(); ++i) {
      const Vec2& a = line[i - 1];
      const Vec2& b = line[i];
      if ((a.y() <= start.y()) == (b.y() <= start.y())) continue;
      const double x = a.x() + (b.x() - a.x()) * ((start.y() - a.y()) / (b.y() - a.y()));
      if (x <= start.x() || x >= nearest) continue;
      nearest = x;
      met = b.y() < a.y() ? below_[other] : above_[other];  // a line that goes down has its right side towards us
    }
  }
  unite(outside, met);
}

Index Bands::find(Index node) {
  while (parent_[node] != node) {
    parent_[node] = parent_[parent_[node]];
    node = parent_[node];
  }
  return node;
}

void Bands::unite(Index a, Index b) {
  a = find(a);
  b = find(b);
  if (a != b) parent_[std::max(a, b)] = std::min(a, b);
}

}  // namespace isopath
