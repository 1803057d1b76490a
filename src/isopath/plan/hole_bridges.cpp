#include "isopath/plan/hole_bridges.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "isopath/field/exact_field.h"
#include "isopath/mesh/cut_along.h"
#include "isopath/mesh/disjoint_sets.h"
#include "isopath/mesh/refine.h"
#include "isopath/plan/nested_plan.h"

namespace isopath {
namespace {

constexpr Index most_faces = 1000000;
/// Bound on the error of the distances that bridges are chosen by, as a part of the mesh's size.
constexpr double bridge_accuracy = 1e-6;

/// The boundary loop that each vertex is nearest to, and how far it is; `no_index` and infinity where there is none.
struct NearestLoops {
  std::vector<Index> loop;
  std::vector<double> distance;
};

NearestLoops nearest_loops(const TriangleMesh& mesh, Progress& progress) {
  SourceSet sources;
  std::vector<Index> loop_of_root;
  for (const auto& loop : mesh.boundary_loops()) {
    sources.add_halfedges(mesh, loop, true);
    loop_of_root.resize(sources.elements().size(), static_cast<Index>(&loop - mesh.boundary_loops().data()));
  }
  const ExactField field =
      ExactField::compute(mesh, sources, {.accuracy = bridge_accuracy * mesh.size(), .many_questions = true}, progress);
  NearestLoops nearest{std::vector<Index>(mesh.n_vertices(), no_index),
                       {field.vertex_distances().begin(), field.vertex_distances().end()}};
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (!(nearest.distance[v] < infinity)) continue;
    const Index root = field.nearest(point_at_vertex(mesh, v)).root;
    if (root != no_index) nearest.loop[v] = loop_of_root[root];
  }
  return nearest;
}

/// For every loop those with a higher number whose regions touch its own, and at most how far they are away.
std::vector<std::map<Index, double>> neighbours_of(const TriangleMesh& mesh, const NearestLoops& nearest) {
  std::vector<std::map<Index, double>> neighbours(mesh.boundary_loops().size());
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    const Index h = mesh.halfedge_of(e);
    const Index u = mesh.from(h);
    const Index v = mesh.to(h);
    const auto [low, high] = std::minmax(nearest.loop[u], nearest.loop[v]);
    if (low == no_index || high == no_index || low == high) continue;
    const double length = nearest.distance[u] + mesh.edge_length(e) + nearest.distance[v];
    const auto [place, is_new] = neighbours[low].try_emplace(high, length);
    if (!is_new) place->second = std::min(place->second, length);
  }
  return neighbours;
}

struct Bridge {
  double length = 0;
  Index from = no_index;
  Index to = no_index;
  std::vector<SurfacePoint> path;
};

/// The shortest paths to a loop from the vertices, one of each neighbour, that are nearest to it.
void add_bridges(const TriangleMesh& mesh, Index loop, const std::map<Index, double>& neighbours,
                 std::vector<Bridge>& bridges, Progress& progress) {
  double reach = 0;
  for (const auto& [other, length] : neighbours) {
    // a vertex lies within an edge of any point
    for (const Index h : mesh.boundary_loops()[other])
      reach = std::max(reach, 1.01 * length + mesh.edge_length(mesh.edge_of(h)));
  }
  const ExactField field = ExactField::compute(
      mesh, boundary_source(mesh, loop), {.stop_distance = reach, .accuracy = bridge_accuracy * mesh.size()}, progress);
  const auto distance = field.vertex_distances();
  for (const auto& [other, length] : neighbours) {
    Index nearest = no_index;
    for (const Index h : mesh.boundary_loops()[other]) {
      const Index v = mesh.from(h);
      if (nearest == no_index || distance[v] < distance[nearest]) nearest = v;
    }
    bridges.push_back({distance[nearest], loop, other, field.shortest_path(point_at_vertex(mesh, nearest))});
  }
}

}  // namespace

std::vector<std::vector<SurfacePoint>> hole_bridges(const TriangleMesh& mesh, Progress& progress) {
  const auto n_loops = static_cast<Index>(mesh.boundary_loops().size());
  if (n_loops < 2) return {};
  const auto neighbours = neighbours_of(mesh, nearest_loops(mesh, progress));
  std::vector<Bridge> bridges;
  for (Index loop = 0; loop < n_loops; ++loop) {
    if (!neighbours[loop].empty()) add_bridges(mesh, loop, neighbours[loop], bridges, progress);
  }
  std::sort(bridges.begin(), bridges.end(), [](const Bridge& a, const Bridge& b) {
    return std::tie(a.length, a.from, a.to) < std::tie(b.length, b.from, b.to);
  });
  // Kruskal
  DisjointSets joined(static_cast<std::size_t>(n_loops));
  std::vector<std::vector<SurfacePoint>> tree;
  for (Bridge& bridge : bridges) {
    if (joined.join(bridge.from, bridge.to)) tree.push_back(std::move(bridge.path));
  }
  return tree;
}

std::optional<RefinedMesh> opened_holes(const TriangleMesh& mesh, double spacing, Progress& progress) {
  const RefinedMesh even = split_long_edges(mesh, spacing, most_faces);
  const std::vector<std::vector<SurfacePoint>> bridges = hole_bridges(even.mesh, progress);
  CutMesh cut = cut_along(even.mesh, bridges);
  RefinedMesh opened{opened_along(cut.refined.mesh, cut.is_cut), {}, std::move(cut.refined.old_face)};
  if (nested_shape_of(opened.mesh) != NestedShape::disc) return std::nullopt;
  opened.on_old.resize(opened.mesh.n_vertices());
  for (Index f = 0; f < opened.mesh.n_faces(); ++f) {
    for (int i = 0; i < 3; ++i)
      opened.on_old[opened.mesh.triangle(f)[i]] = cut.refined.on_old[cut.refined.mesh.triangle(f)[i]];
  }
  return composed(mesh, even, std::move(opened));
}

}  // namespace isopath
