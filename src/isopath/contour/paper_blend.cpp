#include "isopath/contour/paper_blend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

#include "isopath/contour/medial_axis.h"
#include "isopath/core/error.h"
#include "isopath/core/quiet_progress.h"
#include "isopath/field/intrinsic_geometry.h"

namespace isopath {
namespace {

/// The axis that is left when the arcs to the boundary are taken off, as points with neighbours.
struct AxisTree {
  struct Link {
    Index to;
    double length;
  };
  std::vector<SurfacePoint> points;
  std::vector<double> clearance;
  std::vector<std::vector<Link>> links;

  Index add(const SurfacePoint& point, double distance) {
    points.push_back(point);
    clearance.push_back(distance);
    links.emplace_back();
    return static_cast<Index>(points.size()) - 1;
  }
};

AxisTree tree_of(const TriangleMesh& mesh, const BisectorGraph& axis) {
  AxisTree tree;
  const double on_boundary = 1e-6 * mesh.size();
  std::vector<Index> of_node(axis.nodes.size(), no_index);
  const auto node = [&](Index n) {
    if (of_node[n] == no_index) of_node[n] = tree.add(axis.nodes[n].point, axis.nodes[n].clearance);
    return of_node[n];
  };
  for (const BisectorGraph::Arc& arc : axis.arcs) {
    const auto touches = [&](Index n) {
      return axis.nodes[n].arcs.size() == 1 && axis.nodes[n].clearance <= on_boundary;
    };
    if (touches(arc.from) || touches(arc.to)) {
      for (const Index n : {arc.from, arc.to}) {
        if (!touches(n)) node(n);
      }
      continue;
    }
    Index last = node(arc.from);
    for (std::size_t i = 1; i < arc.points.size(); ++i) {
      const bool ends = i + 1 == arc.points.size();
      const Index here = ends ? node(arc.to) : tree.add(arc.points[i].point, arc.points[i].clearance);
      const double length =
          (position_of(mesh, arc.points[i].point) - position_of(mesh, arc.points[i - 1].point)).norm();
      tree.links[last].push_back({here, length});
      tree.links[here].push_back({last, length});
      last = here;
    }
  }
  return tree;
}

using Entry = std::pair<double, Index>;
using NearestFirst = std::priority_queue<Entry, std::vector<Entry>, std::greater<>>;

std::vector<double> distances_in(const AxisTree& tree, Index from) {
  std::vector<double> distance(tree.points.size(), infinity);
  NearestFirst open;
  distance[from] = 0;
  open.emplace(0, from);
  while (!open.empty()) {
    const auto [d, p] = open.top();
    open.pop();
    if (d > distance[p]) continue;
    for (const auto& [to, length] : tree.links[p]) {
      if (d + length < distance[to]) {
        distance[to] = d + length;
        open.emplace(distance[to], to);
      }
    }
  }
  return distance;
}

/// The point of the tree from which the farthest way to the boundary by its points is shortest: the middle of the
/// longest such way.
Index centre_of(const AxisTree& tree, Index start) {
  const auto farthest = [&](const std::vector<double>& distance) {
    Index best = no_index;
    for (std::size_t p = 0; p < distance.size(); ++p) {
      if (distance[p] == infinity) continue;
      if (best == no_index || distance[p] + tree.clearance[p] > distance[best] + tree.clearance[best])
        best = static_cast<Index>(p);
    }
    return best;
  };
  const Index one_end = farthest(distances_in(tree, start));
  const std::vector<double> from_one = distances_in(tree, one_end);
  const Index other_end = farthest(from_one);
  const std::vector<double> from_other = distances_in(tree, other_end);
  Index centre = one_end;
  double least = infinity;
  for (std::size_t p = 0; p < tree.points.size(); ++p) {
    const double height = std::max(from_one[p] + tree.clearance[one_end], from_other[p] + tree.clearance[other_end]);
    if (height < least) {
      least = height;
      centre = static_cast<Index>(p);
    }
  }
  return centre;
}

/// Distances at the vertices from points with offsets, by fast marching (Kimmel & Sethian 1998) without regard to
/// obtuse corners.
class OffsetMarching {
 public:
  explicit OffsetMarching(const TriangleMesh& mesh)
      : mesh_(mesh), geometry_(mesh), distance_(mesh.n_vertices(), infinity), settled_(mesh.n_vertices(), 0) {}

  void start(const SurfacePoint& point, double offset) {
    const Vec3 place = position_of(mesh_, point);
    const auto offer_corners = [&](Index face) {
      for (const Index v : mesh_.triangle(face)) offer(v, offset + (mesh_.position(v) - place).norm());
    };
    offer_corners(point.face);
    for (Index h = 3 * point.face; h < 3 * point.face + 3; ++h) {
      if (mesh_.twin(h) != no_index) offer_corners(TriangleMesh::face_of(mesh_.twin(h)));
    }
  }

  std::vector<double> run(const Progress& progress) {
    for (std::size_t n = 0; !open_.empty(); ++n) {
      if (n % 4096 == 0) progress.checkpoint();
      const Index v = open_.top().second;
      open_.pop();
      if (settled_[v]) continue;
      settled_[v] = 1;
      for (Index h = mesh_.outgoing(v); h != no_index;) {
        spread(h);
        h = mesh_.next_outgoing(h);
        if (h == mesh_.outgoing(v)) break;
      }
    }
    return std::move(distance_);
  }

 private:
  void offer(Index v, double distance) {
    if (!(distance < distance_[v])) return;
    distance_[v] = distance;
    open_.emplace(distance, v);
  }

  /// From the tail of a half-edge, which is settled, to the two other corners of its face.
  void spread(Index h) {
    const Index v = mesh_.from(h);
    const Index prev = TriangleMesh::prev(h);
    const Index b = mesh_.to(h);
    const Index c = mesh_.from(prev);
    offer(b, distance_[v] + geometry_.length(h));
    offer(c, distance_[v] + geometry_.length(prev));
    if (settled_[b]) offer(c, front(geometry_.apex(h), geometry_.length(h), distance_[v], distance_[b]));
    if (settled_[c]) offer(b, front(geometry_.apex(prev), geometry_.length(prev), distance_[c], distance_[v]));
  }

  /// What a straight front with these distances at (0, 0) and (length, 0) brings to a point above them; infinity where
  /// it does not come through between them.
  static double front(const Vec2& to, double length, double at_start, double at_end) {
    const double slope = (at_end - at_start) / length;
    if (!(std::abs(slope) < 1)) return infinity;
    const double cosine = std::sqrt(1 - slope * slope);
    const double place = to.x() - slope * to.y() / cosine;
    if (place < 0 || place > length) return infinity;
    return at_start + slope * to.x() + to.y() * cosine;
  }

  const TriangleMesh& mesh_;
  IntrinsicGeometry geometry_;
  std::vector<double> distance_;
  std::vector<char> settled_;
  NearestFirst open_;
};

}  // namespace

BlendedField paper_blend(const TriangleMesh& mesh, double spacing, const Progress& progress) {
  if (mesh.boundary_loops().empty())
    throw Error(ErrorCode::no_plan, "the paper's blend needs a boundary", {.advice = "take the form least"});
  QuietProgress quiet(progress);
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh), {}, quiet);
  AxisTree tree = tree_of(mesh, medial_axis(field, {.chord_tolerance = 0.01 * spacing}, quiet));
  if (tree.points.empty()) {  // a disc's axis is a point, which no arc leads to when its polygon's corners do not count
    const auto distances = field.vertex_distances();
    const auto top = std::max_element(distances.begin(), distances.end()) - distances.begin();
    tree.add(point_at_vertex(mesh, static_cast<Index>(top)), distances[top]);
  }
  const auto widest = std::max_element(tree.clearance.begin(), tree.clearance.end()) - tree.clearance.begin();
  const Index root = centre_of(tree, static_cast<Index>(widest));
  const std::vector<double> way = distances_in(tree, root);
  double longest = 0;
  for (std::size_t p = 0; p < way.size(); ++p) {
    if (way[p] < infinity) longest = std::max(longest, way[p] + tree.clearance[p]);
  }
  OffsetMarching marching(mesh);
  for (std::size_t p = 0; p < way.size(); ++p) {
    if (way[p] < infinity) marching.start(tree.points[p], tree.clearance[p] * way[p] / (longest - way[p]));
  }
  const std::vector<double> from_axis = marching.run(progress);
  BlendedField result;
  result.spacing = spacing;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const double from_source = field.vertex_distances()[v];
    const double sum = from_source + from_axis[v];
    result.values.push_back(sum < infinity ? (sum > 0 ? from_source / sum : 0.0) : infinity);
  }
  result.n_levels = levels_to_keep(mesh, result.values, spacing);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (result.values[v] == infinity) continue;
    result.values[v] *= result.n_levels * spacing;
    if (result.root == no_index || result.values[v] > result.values[result.root]) result.root = v;
  }
  result.root_of_component.assign(mesh.n_components(), no_index);
  result.root_of_component[mesh.component_of(tree.points[root].face)] = result.root;
  return result;
}

}  // namespace isopath
