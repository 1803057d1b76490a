#include "isopath/field/fast_marching.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/source_faces.h"

namespace isopath {
namespace {

/// Whether two directions enclose no more than a right angle. On a grid many do exactly, and rounding must not decide
/// which vertex splits a corner.
bool at_most_right(const Vec2& a, const Vec2& b) { return a.dot(b) >= -1e-9 * a.norm() * b.norm(); }

/// A triangle that carries fronts to one of its corners, laid out with that corner at the origin. One of `a` and `b`
/// may be a vertex that is not a neighbour on the mesh.
struct Stencil {
  Index target;
  Index a;
  Index b;
  Vec2 at_a;
  Vec2 at_b;
};

/// The least of (interpolated distance at p) + |p| over the points p of the segment from a to b: the function is convex
/// along the segment, so that its stationary point, clamped, is the place.
double front_through(const Stencil& stencil, double distance_a, double distance_b) {
  const double at_ends = std::min(distance_a + stencil.at_a.norm(), distance_b + stencil.at_b.norm());
  const Vec2 edge = stencil.at_b - stencil.at_a;
  const double length = edge.norm();
  if (!(length > 0)) return at_ends;
  const double slope = (distance_b - distance_a) / length;
  if (!(std::abs(slope) < 1)) return at_ends;
  const double foot = -stencil.at_a.dot(edge) / length;
  const double height = std::abs(cross(stencil.at_a, edge)) / length;
  const double cosine = std::sqrt(1 - slope * slope);
  const double place = foot - slope * height / cosine;
  if (place <= 0 || place >= length) return at_ends;
  return std::min(at_ends, distance_a + slope * foot + height * cosine);
}

class FastMarching {
 public:
  explicit FastMarching(const TriangleMesh& mesh)
      : mesh_(mesh), geometry_(mesh), distance_(mesh.n_vertices(), infinity) {
    for (Index h = 0; h < mesh.n_halfedges(); ++h) add_corner(h);
    list_by_vertex();
  }

  void start(const SourceElement& element) {
    for (const Index face : faces_of(mesh_, element)) {
      for (const Index v : mesh_.triangle(face)) offer(v, distance_in_face(mesh_, element, mesh_.position(v)));
    }
  }
  std::vector<double> run(Progress& progress);

 private:
  void add_corner(Index h);
  void list_by_vertex();
  void offer(Index vertex, double distance);
  void spread(Index vertex);

  const TriangleMesh& mesh_;
  IntrinsicGeometry geometry_;
  std::vector<Stencil> stencils_;
  std::vector<Index> first_of_vertex_;  ///< into `stencil_of_vertex_`, one more than there are vertices
  std::vector<Index> stencil_of_vertex_;
  std::vector<double> distance_;
  std::vector<char> settled_;
  std::priority_queue<std::pair<double, Index>, std::vector<std::pair<double, Index>>, std::greater<>> queue_;
};

/// The corner at the tail of a half-edge. A front may reach an obtuse corner before both other corners are known: it is
/// split by the first vertex that unfolding finds at no more than a right angle from both sides.
void FastMarching::add_corner(Index h) {
  const Index target = mesh_.from(h);
  Stencil whole{target, mesh_.to(h), mesh_.from(TriangleMesh::prev(h)), Vec2(geometry_.length(h), 0),
                geometry_.apex(h)};
  const Vec2 side_a = whole.at_a;
  const Vec2 side_b = whole.at_b;
  if (at_most_right(side_a, side_b) || !(side_b.y() > 0)) {
    stencils_.push_back(whole);
    return;
  }
  const Vec2 middle = side_a.normalized() + side_b.normalized();
  Vec2 a = side_a;
  Vec2 b = side_b;
  Index across = TriangleMesh::next(h);  // from a to b
  // The splitting section is widest at the corner; fans of more faces than this are slivers that gain nothing.
  constexpr int most_unfolded = 32;
  for (int n = 0; n < most_unfolded; ++n) {
    const Index twin = mesh_.twin(across);
    if (twin == no_index || !(geometry_.length(twin) > 0)) break;
    const Vec2 along = (a - b) / geometry_.length(twin);
    const Vec2 apex = geometry_.apex(twin);
    const Vec2 p = b + along * apex.x() + Vec2(-along.y(), along.x()) * apex.y();
    if (at_most_right(p, side_a) && at_most_right(p, side_b)) {
      const Index v = mesh_.from(TriangleMesh::prev(twin));
      stencils_.push_back({target, whole.a, v, side_a, p});
      stencils_.push_back({target, v, whole.b, p, side_b});
      return;
    }
    if (cross(middle, p) < 0) {
      a = p;
      across = TriangleMesh::prev(twin);
    } else {
      b = p;
      across = TriangleMesh::next(twin);
    }
  }
  stencils_.push_back(whole);
}

void FastMarching::list_by_vertex() {
  first_of_vertex_.assign(mesh_.n_vertices() + 1, 0);
  for (const Stencil& s : stencils_) {
    ++first_of_vertex_[s.a + 1];
    ++first_of_vertex_[s.b + 1];
  }
  for (Index v = 0; v < mesh_.n_vertices(); ++v) first_of_vertex_[v + 1] += first_of_vertex_[v];
  stencil_of_vertex_.resize(2 * stencils_.size());
  std::vector<Index> next(first_of_vertex_.begin(), first_of_vertex_.end() - 1);
  for (Index k = 0; k < static_cast<Index>(stencils_.size()); ++k) {
    stencil_of_vertex_[next[stencils_[k].a]++] = k;
    stencil_of_vertex_[next[stencils_[k].b]++] = k;
  }
}

void FastMarching::offer(Index vertex, double distance) {
  if (distance >= distance_[vertex]) return;
  distance_[vertex] = distance;
  queue_.emplace(distance, vertex);
}

/// Brings the front on from a vertex whose distance is now final.
void FastMarching::spread(Index vertex) {
  for (Index i = first_of_vertex_[vertex]; i < first_of_vertex_[vertex + 1]; ++i) {
    const Stencil& s = stencils_[stencil_of_vertex_[i]];
    if (settled_[s.target]) continue;
    const Index other = s.a == vertex ? s.b : s.a;
    if (settled_[other]) {
      offer(s.target, front_through(s, distance_[s.a], distance_[s.b]));
    } else {
      offer(s.target, distance_[vertex] + (s.a == vertex ? s.at_a : s.at_b).norm());
    }
  }
}

std::vector<double> FastMarching::run(Progress& progress) {
  settled_.assign(mesh_.n_vertices(), 0);
  for (std::size_t settled = 0; !queue_.empty();) {
    const auto [distance, vertex] = queue_.top();
    queue_.pop();
    if (settled_[vertex]) continue;
    settled_[vertex] = 1;
    if (++settled % 1024 == 0) {
      progress.checkpoint();
      progress.at(static_cast<double>(settled) / static_cast<double>(mesh_.n_vertices()));
    }
    spread(vertex);
  }
  return std::move(distance_);
}

}  // namespace

std::vector<double> fast_marching_distances(const TriangleMesh& mesh, const SourceSet& sources, Progress& progress) {
  if (sources.empty()) throw Error(ErrorCode::bad_usage, "the source set is empty", {.advice = "name a source"});
  FastMarching marching(mesh);
  for (const SourceElement& element : sources.elements()) marching.start(element);
  return marching.run(progress);
}

}  // namespace isopath
