#include "isopath/mesh/surface_walk.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace isopath {
namespace {

/// A longer way is no detour any more but a walk around the part.
constexpr double longest_way_over_chord = 4;
/// Below this sine of the angle between chord and mean normal (a hundredth of a degree) they span no plane to speak of.
constexpr double least_sine = 2e-4;

/// The faces that contain a point, its own first.
std::vector<Index> faces_around(const TriangleMesh& mesh, const SurfacePoint& point) {
  std::vector<Index> faces = {point.face};
  const Support support = support_of(mesh, point);
  if (support.kind == Support::Kind::edge) {
    const Index g = mesh.twin(support.index);
    if (g != no_index) faces.push_back(TriangleMesh::face_of(g));
  } else if (support.kind == Support::Kind::vertex) {
    const Index first = mesh.outgoing(support.index);
    Index h = first;
    do {
      if (TriangleMesh::face_of(h) != point.face) faces.push_back(TriangleMesh::face_of(h));
      h = mesh.next_outgoing(h);
    } while (h != no_index && h != first);
  }
  return faces;
}

/// The plane of the cut. Each vertex counts as above or below it, never as on it: one that lies on it (within the
/// tolerance) counts as above. So every face is either left alone or cut through exactly two of its edges, and the
/// cut is a set of simple chains, whatever the geometry. Chains that pass by such a vertex visit it exactly.
class Cut {
 public:
  Cut(const TriangleMesh& mesh, const Vec3& origin, const Vec3& normal)
      : mesh_(mesh), origin_(origin), normal_(normal), zero_(mesh.tolerance().length) {}

  double height(Index vertex) const {
    const double h = normal_.dot(mesh_.position(vertex) - origin_);
    return std::abs(h) <= zero_ ? 0 : h;
  }
  bool above(Index vertex) const { return height(vertex) >= 0; }
  bool crosses(Index halfedge) const { return above(mesh_.from(halfedge)) != above(mesh_.to(halfedge)); }
  SurfacePoint crossing(Index halfedge) const {
    const double a = height(mesh_.from(halfedge));
    const double b = height(mesh_.to(halfedge));
    return point_on_halfedge(halfedge, a / (a - b));
  }

 private:
  const TriangleMesh& mesh_;
  Vec3 origin_;
  Vec3 normal_;
  double zero_;
};

bool same_vertex(const TriangleMesh& mesh, const SurfacePoint& a, const SurfacePoint& b) {
  const Support sa = support_of(mesh, a);
  const Support sb = support_of(mesh, b);
  return sa.kind == Support::Kind::vertex && sb.kind == Support::Kind::vertex && sa.index == sb.index;
}

bool lies_on_edge(const TriangleMesh& mesh, const SurfacePoint& point, Index halfedge) {
  const Support support = support_of(mesh, point);
  if (support.kind == Support::Kind::edge) return mesh.edge_of(support.index) == mesh.edge_of(halfedge);
  return support.kind == Support::Kind::vertex &&
         (mesh.from(halfedge) == support.index || mesh.to(halfedge) == support.index);
}

/// Where the cut leaves the faces around `from`, the way that points most towards `goal` first.
std::vector<Index> exits(const TriangleMesh& mesh, const Cut& cut, const SurfacePoint& from, const Vec3& goal) {
  const Vec3 start = position_of(mesh, from);
  std::vector<std::pair<double, Index>> found;
  for (const Index face : faces_around(mesh, from)) {
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      if (!cut.crosses(h) || lies_on_edge(mesh, from, h)) continue;
      const Vec3 way = position_of(mesh, cut.crossing(h)) - start;
      found.emplace_back(-way.stableNormalized().dot(goal - start), h);
    }
  }
  std::sort(found.begin(), found.end());
  std::vector<Index> out;
  for (const auto& [towards, h] : found) out.push_back(h);
  return out;
}

/// Follows the cut out of a face through `exit` until a face around `to` is entered; empty when that does not happen.
std::vector<SurfacePoint> follow(const TriangleMesh& mesh, const Cut& cut, const SurfacePoint& from,
                                 const SurfacePoint& to, Index exit, const std::vector<Index>& goal_faces) {
  const Vec3 goal = position_of(mesh, to);
  Vec3 here = position_of(mesh, from);
  const double longest = longest_way_over_chord * (goal - here).norm();
  std::vector<SurfacePoint> way = {from};
  double length = 0;
  Index h = exit;
  do {
    const SurfacePoint point = cut.crossing(h);
    const Vec3 there = position_of(mesh, point);
    length += (there - here).norm();
    if (length > longest) return {};
    if (!same_vertex(mesh, way.back(), point)) way.push_back(point);
    here = there;
    const Index g = mesh.twin(h);
    if (g == no_index) return {};
    if (std::find(goal_faces.begin(), goal_faces.end(), TriangleMesh::face_of(g)) != goal_faces.end()) {
      if (same_vertex(mesh, way.back(), to)) way.pop_back();
      way.push_back(to);
      return way;
    }
    h = cut.crosses(TriangleMesh::next(g)) ? TriangleMesh::next(g) : TriangleMesh::prev(g);
  } while (h != exit);  // chains are simple: a closed one comes back to its start
  return {};
}

}  // namespace

Index common_face(const TriangleMesh& mesh, const SurfacePoint& a, const SurfacePoint& b) {
  const std::vector<Index> around_a = faces_around(mesh, a);
  const std::vector<Index> around_b = faces_around(mesh, b);
  if (std::find(around_b.begin(), around_b.end(), a.face) != around_b.end()) return a.face;
  for (const Index face : around_b) {
    if (std::find(around_a.begin(), around_a.end(), face) != around_a.end()) return face;
  }
  return no_index;
}

std::vector<SurfacePoint> surface_walk(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to) {
  if (common_face(mesh, from, to) != no_index) return {from, to};
  const std::vector<Index> goal_faces = faces_around(mesh, to);
  const Vec3 start = position_of(mesh, from);
  const Vec3 goal = position_of(mesh, to);
  const auto normal_at = [&](const SurfacePoint& point) {
    Vec3 sum = Vec3::Zero();
    for (const Index face : faces_around(mesh, point)) sum += mesh.face_normal(face);
    return Vec3(sum.stableNormalized());
  };
  const Vec3 mean = (normal_at(from) + normal_at(to)).stableNormalized();
  const Vec3 across = (goal - start).stableNormalized().cross(mean);
  if (!(across.norm() > least_sine)) return {};
  // A cut that only touches the surface at a vertex is missed by the rule that such a vertex is above; from the other
  // side it is found.
  for (const double side : {1.0, -1.0}) {
    const Cut cut(mesh, start, side * across.normalized());
    for (const Index exit : exits(mesh, cut, from, goal)) {
      std::vector<SurfacePoint> way = follow(mesh, cut, from, to, exit, goal_faces);
      if (!way.empty()) return way;
    }
  }
  return {};
}

}  // namespace isopath
