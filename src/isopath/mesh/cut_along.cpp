#include "isopath/mesh/cut_along.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/mesh/disjoint_sets.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

/// Distances below this, relative to the face's longest side, count as none.
constexpr double snap = 1e-6;

/// One face being divided, in coordinates that scale its longest side to about one. Vertices have the numbers of the
/// whole mesh.
class FaceDivision {
 public:
  FaceDivision(const TriangleMesh& mesh, Index face, std::vector<Vec3>& positions, std::vector<SurfacePoint>& on_old)
      : mesh_(mesh), face_(face), positions_(positions), on_old_(on_old) {
    const Triangle& t = mesh.triangle(face);
    const Vec3 ab = mesh.position(t[1]) - mesh.position(t[0]);
    const Vec3 ac = mesh.position(t[2]) - mesh.position(t[0]);
    const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    const Vec3 x = ab.normalized();
    corner_ = {Vec2::Zero(), Vec2(ab.norm(), 0) / longest, Vec2(x.dot(ac), x.cross(ac).norm()) / longest};
    triangles_.push_back(t);
    for (int i = 0; i < 3; ++i) add_place(t[i], Vec3::Unit(i));
  }

  /// A vertex on side i of the face; those of a side in ascending order from its start.
  void add_on_side(int i, Index vertex, double parameter) {
    Vec3 share = Vec3::Zero();
    share[i] = 1 - parameter;
    share[(i + 1) % 3] = parameter;
    add_place(vertex, share);
    const Index after = mesh_.triangle(face_)[(i + 1) % 3];
    const Index before = last_on_side_[i] == no_index ? mesh_.triangle(face_)[i] : last_on_side_[i];
    split_edge(before, after, vertex);
    last_on_side_[i] = vertex;
  }

  /// The vertex at a place inside the face, a new one where there is none.
  Index vertex_at(const Vec3& share) {
    const Vec2 place = plane(share);
    for (const auto& [vertex, known] : place_) {
      if ((known - place).norm() <= snap) return vertex;
    }
    const Index vertex = new_vertex(share);
    // By the largest of the three: a place on an edge lies in both triangles beside it, or by rounding in none.
    std::size_t best = 0;
    double best_depth = -infinity;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      double depth = infinity;
      for (int i = 0; i < 3; ++i) depth = std::min(depth, height(triangles_[t][i], triangles_[t][(i + 1) % 3], place));
      if (depth <= best_depth) continue;
      best_depth = depth;
      best = t;
    }
    const Triangle t = triangles_[best];
    for (int i = 0; i < 3; ++i) {
      const Index a = t[i];
      const Index b = t[(i + 1) % 3];
      if (height(a, b, place) > snap || is_on_border(a, b)) continue;
      split_edge(a, b, vertex);
      return vertex;
    }
    triangles_[best] = {t[0], t[1], vertex};
    triangles_.push_back({t[1], t[2], vertex});
    triangles_.push_back({t[2], t[0], vertex});
    return vertex;
  }

  /// Makes the straight way from a to b one of edges. Edges that are in the way are divided where it crosses them.
  void connect(Index a, Index b) {
    const std::size_t most = 4 * (place_.size() + triangles_.size()) + 16;
    for (std::size_t steps = 0; a != b; ++steps) {
      if (steps > most) throw Error(ErrorCode::internal, fmt::format("no way to cut face {}", face_));
      const Index next = step_towards(a, b);
      cuts_.emplace_back(a, next);
      a = next;
    }
  }

  const std::vector<Triangle>& triangles() const { return triangles_; }
  /// Pairs of vertices whose edges are parts of ways.
  const std::vector<std::pair<Index, Index>>& cuts() const { return cuts_; }

 private:
  Vec2 plane(const Vec3& share) const { return share[0] * corner_[0] + share[1] * corner_[1] + share[2] * corner_[2]; }
  void add_place(Index vertex, const Vec3& share) {
    place_.emplace_back(vertex, plane(share));
    share_.emplace(vertex, share);
  }
  const Vec2& place(Index vertex) const {
    return std::find_if(place_.begin(), place_.end(), [&](const auto& p) { return p.first == vertex; })->second;
  }
  /// How far a place lies to the left of the line from a to b.
  double height(Index a, Index b, const Vec2& at) const {
    const Vec2 along = place(b) - place(a);
    return cross(along, at - place(a)) / along.norm();
  }
  Index new_vertex(const Vec3& share) {
    const auto vertex = static_cast<Index>(positions_.size());
    const SurfacePoint point{face_, share};
    positions_.push_back(position_of(mesh_, point));
    on_old_.push_back(point);
    add_place(vertex, share);
    return vertex;
  }
  bool is_on_border(Index a, Index b) const {
    int n = 0;
    for (const Triangle& t : triangles_) {
      for (int i = 0; i < 3; ++i) n += (t[i] == a && t[(i + 1) % 3] == b) || (t[i] == b && t[(i + 1) % 3] == a);
    }
    return n < 2;
  }
  void split_edge(Index a, Index b, Index middle) {
    for (std::size_t c = 0, n = cuts_.size(); c < n; ++c) {
      auto& [from, to] = cuts_[c];
      if (!((from == a && to == b) || (from == b && to == a))) continue;
      const Index end = std::exchange(to, middle);
      cuts_.emplace_back(middle, end);
    }
    for (std::size_t t = 0, n = triangles_.size(); t < n; ++t) {
      for (int i = 0; i < 3; ++i) {
        const Index from = triangles_[t][i];
        const Index to = triangles_[t][(i + 1) % 3];
        if (!((from == a && to == b) || (from == b && to == a))) continue;
        const Index apex = triangles_[t][(i + 2) % 3];
        triangles_[t] = {from, middle, apex};
        triangles_.push_back({middle, to, apex});
        break;
      }
    }
  }

  /// The next vertex on the way from a to b: a neighbour that lies on it, or where it crosses the edge opposite of a.
  Index step_towards(Index a, Index b) {
    const Vec2 way = (place(b) - place(a)).normalized();
    Index beside = no_index;  // the neighbour nearest to the way
    double least_off = infinity;
    std::array<Index, 2> ahead{no_index, no_index};  // the ends of the edge that is crossed
    double right = 0;
    double left = 0;
    for (const Triangle& t : triangles_) {
      const auto at = std::find(t.begin(), t.end(), a);
      if (at == t.end()) continue;
      const Index p = t[(at - t.begin() + 1) % 3];
      const Index q = t[(at - t.begin() + 2) % 3];
      if (p == b || q == b) return b;
      for (const Index v : {p, q}) {
        const Vec2 side = place(v) - place(a);
        const double off = way.dot(side) > 0 ? std::abs(cross(way, side)) : infinity;
        if (off < least_off) {
          least_off = off;
          beside = v;
        }
      }
      const double p_right = -cross(way, Vec2(place(p) - place(a)));
      const double q_left = cross(way, Vec2(place(q) - place(a)));
      if (p_right <= 0 || q_left <= 0 || is_on_border(p, q)) continue;
      ahead = {p, q};
      right = p_right;
      left = q_left;
    }
    const bool crosses = least_off > snap && ahead[0] != no_index;
    if (!crosses && beside == no_index) throw Error(ErrorCode::internal, fmt::format("no way to cut face {}", face_));
    if (!crosses) return beside;
    const double t = right / (right + left);
    const Index crossing = new_vertex((1 - t) * share_.at(ahead[0]) + t * share_.at(ahead[1]));
    split_edge(ahead[0], ahead[1], crossing);
    return crossing;
  }

  const TriangleMesh& mesh_;
  Index face_;
  std::vector<Vec3>& positions_;
  std::vector<SurfacePoint>& on_old_;
  std::array<Vec2, 3> corner_;
  std::array<Index, 3> last_on_side_{no_index, no_index, no_index};
  std::vector<std::pair<Index, Vec2>> place_;
  std::unordered_map<Index, Vec3> share_;
  std::vector<Triangle> triangles_;
  std::vector<std::pair<Index, Index>> cuts_;
};

/// A point of a line: a vertex, old or new, or a place inside a face.
struct Stop {
  Index vertex = no_index;
  SurfacePoint inside = {};  // without a vertex yet
};

class Cutter {
 public:
  explicit Cutter(const TriangleMesh& mesh) : mesh_(mesh), positions_(mesh.soup().positions) {
    on_old_.resize(mesh.n_vertices());
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      if (mesh.outgoing(v) != no_index) on_old_[v] = point_at_vertex(mesh, v);
    }
  }

  void add_line(const std::vector<SurfacePoint>& line) {
    std::vector<Stop> stops;
    for (const SurfacePoint& point : line) stops.push_back(stop_at(point));
    for (std::size_t i = 1; i < line.size(); ++i) {
      const Index face = common_face(mesh_, line[i - 1], line[i]);
      if (face == no_index) {
        throw Error(ErrorCode::internal, fmt::format("points {} and {} of a cut share no face", i - 1, i));
      }
      ways_[face].emplace_back(stops[i - 1], stops[i]);
    }
  }

  CutMesh run() {
    for (auto& [edge, marks] : on_edge_) std::sort(marks.begin(), marks.end());
    CutMesh out;
    TriangleSoup soup;
    std::vector<std::pair<Index, Index>> cut_edges;
    for (Index f = 0; f < mesh_.n_faces(); ++f) {
      FaceDivision division(mesh_, f, positions_, on_old_);
      if (is_touched(f)) divide(f, division);
      cut_edges.insert(cut_edges.end(), division.cuts().begin(), division.cuts().end());
      for (const Triangle& t : division.triangles()) {
        soup.triangles.push_back(t);
        out.refined.old_face.push_back(f);
      }
    }
    soup.positions = std::move(positions_);
    out.refined.mesh = TriangleMesh(std::move(soup));
    out.refined.on_old = std::move(on_old_);
    mark(cut_edges, out);
    return out;
  }

 private:
  using Mark = std::pair<double, Index>;  // parameter along the edge and vertex

  Stop stop_at(const SurfacePoint& point) {
    const Triangle& t = mesh_.triangle(point.face);
    double longest = 0;
    for (int i = 0; i < 3; ++i) longest = std::max(longest, mesh_.edge_length(mesh_.edge_of(3 * point.face + i)));
    const Vec3 place = position_of(mesh_, point);
    for (int i = 0; i < 3; ++i) {
      if ((mesh_.position(t[i]) - place).norm() <= snap * longest) return {.vertex = t[i]};
    }
    const Support support = support_of(mesh_, point);
    for (Index h = 3 * point.face; h < 3 * point.face + 3; ++h) {
      // A point on an edge stays on it, so that it stays in both faces.
      if (support.kind == Support::Kind::edge && support.index != h) continue;
      const Vec3 along = mesh_.position(mesh_.to(h)) - mesh_.position(mesh_.from(h));
      const double length = along.norm();
      const double at = along.dot(place - mesh_.position(mesh_.from(h))) / length;
      const double off = along.cross(place - mesh_.position(mesh_.from(h))).norm() / length;
      if (off <= snap * longest && at > 0 && at < length) return on_edge(h, at / length, snap * longest / length);
    }
    return {.inside = point};
  }

  Stop on_edge(Index halfedge, double t, double near) {
    const Index edge = mesh_.edge_of(halfedge);
    if (mesh_.halfedge_of(edge) != halfedge) t = 1 - t;
    std::vector<Mark>& marks = on_edge_[edge];
    for (const Mark& mark : marks) {
      if (std::abs(mark.first - t) <= near) return {.vertex = mark.second};
    }
    const auto vertex = static_cast<Index>(positions_.size());
    const SurfacePoint point = point_on_halfedge(mesh_.halfedge_of(edge), t);
    positions_.push_back(position_of(mesh_, point));
    on_old_.push_back(point);
    marks.emplace_back(t, vertex);
    return {.vertex = vertex};
  }

  bool is_touched(Index face) const {
    if (ways_.count(face) > 0) return true;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      if (on_edge_.count(mesh_.edge_of(h)) > 0) return true;
    }
    return false;
  }

  void divide(Index face, FaceDivision& division) {
    for (int i = 0; i < 3; ++i) {
      const Index h = 3 * face + i;
      const auto found = on_edge_.find(mesh_.edge_of(h));
      if (found == on_edge_.end()) continue;
      std::vector<Mark> marks = found->second;
      if (mesh_.halfedge_of(mesh_.edge_of(h)) != h) {
        std::reverse(marks.begin(), marks.end());
        for (Mark& mark : marks) mark.first = 1 - mark.first;
      }
      for (const auto& [t, vertex] : marks) division.add_on_side(i, vertex, t);
    }
    const auto ways = ways_.find(face);
    if (ways == ways_.end()) return;
    const auto vertex_of = [&](const Stop& stop) {
      return stop.vertex != no_index ? stop.vertex
                                     : division.vertex_at(express_in(mesh_, stop.inside, face).barycentric);
    };
    for (const auto& [from, to] : ways->second) {
      const Index a = vertex_of(from);
      division.connect(a, vertex_of(to));
    }
  }

  static void mark(const std::vector<std::pair<Index, Index>>& cut_edges, CutMesh& out) {
    const TriangleMesh& mesh = out.refined.mesh;
    out.is_cut.assign(mesh.n_edges(), 0);
    for (const auto& [a, b] : cut_edges) {
      const Index first = mesh.outgoing(a);
      Index h = first;
      do {
        if (mesh.to(h) == b) out.is_cut[mesh.edge_of(h)] = 1;
        const Index last = TriangleMesh::prev(h);
        if (mesh.from(last) == b) out.is_cut[mesh.edge_of(last)] = 1;  // at the end of an open fan
        h = mesh.next_outgoing(h);
      } while (h != no_index && h != first);
    }
  }

  const TriangleMesh& mesh_;
  std::vector<Vec3> positions_;
  std::vector<SurfacePoint> on_old_;
  std::unordered_map<Index, std::vector<Mark>> on_edge_;
  std::unordered_map<Index, std::vector<std::pair<Stop, Stop>>> ways_;
};

}  // namespace

CutMesh cut_along(const TriangleMesh& mesh, std::span<const std::vector<SurfacePoint>> lines) {
  Cutter cutter(mesh);
  for (const auto& line : lines) cutter.add_line(line);
  return cutter.run();
}

TriangleMesh opened_along(const TriangleMesh& mesh, std::span<const char> is_cut) {
  // corners are numbered as the half-edges that leave them; those beside an edge that stays are one vertex
  DisjointSets corners(static_cast<std::size_t>(mesh.n_halfedges()));
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    const Index twin = mesh.twin(h);
    if (twin != no_index && !is_cut[mesh.edge_of(h)]) corners.join(h, TriangleMesh::next(twin));
  }
  TriangleSoup soup = mesh.soup();
  std::vector<Index> vertex_of(mesh.n_halfedges(), no_index);
  std::vector<char> taken(mesh.n_vertices(), 0);
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    Index& vertex = vertex_of[corners.root(h)];
    const Index old = mesh.from(h);
    if (vertex == no_index) {
      vertex = taken[old] ? static_cast<Index>(soup.positions.size()) : old;
      if (taken[old]) soup.positions.push_back(mesh.position(old));
      taken[old] = 1;
    }
    soup.triangles[h / 3][h % 3] = vertex;
  }
  return TriangleMesh(std::move(soup));
}

}  // namespace isopath
