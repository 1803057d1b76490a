#include "isopath/field/graph_field.h"

#include <fmt/format.h>

#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/source_faces.h"

namespace isopath {
namespace {

/// Throws Error(bad_usage) when an Index cannot number the nodes.
std::size_t node_count(const TriangleMesh& mesh, const GraphOptions& options) {
  const auto on_edges = static_cast<std::size_t>(mesh.n_edges()) * static_cast<std::size_t>(options.virtual_vertices);
  const std::size_t count = static_cast<std::size_t>(mesh.n_vertices()) + on_edges;
  constexpr std::size_t most = std::numeric_limits<Index>::max();
  if (count <= most) return count;
  throw Error(ErrorCode::bad_usage, "too many virtual vertices for this mesh",
              {.element = "virtual_vertices", .value = fmt::format("{} nodes, limit {}", count, most)});
}

/// Nodes are the vertices, then `k` points on every edge. Arcs join the nodes of a face; they are not stored.
class SurfaceGraph {
 public:
  SurfaceGraph(const TriangleMesh& mesh, const GraphOptions& options)
      : mesh_(mesh), options_(options), distance_(node_count(mesh, options), infinity) {
    if (options.across_pairs) join_across_pairs();
  }

  void start(const SourceElement& element);
  std::vector<double> run(Progress& progress);

 private:
  void join_across_pairs();
  Vec3 position(Index node) const;
  void relax(Index node, double distance);
  void visit_face(Index node, Index face);
  void visit(Index node);

  const TriangleMesh& mesh_;
  GraphOptions options_;
  std::vector<double> distance_;
  std::vector<std::vector<std::pair<Index, double>>> across_;  ///< per vertex: the far vertex and its distance
  std::priority_queue<std::pair<double, Index>, std::vector<std::pair<double, Index>>, std::greater<>> queue_;
};

void SurfaceGraph::join_across_pairs() {
  across_.resize(mesh_.n_vertices());
  const IntrinsicGeometry geometry(mesh_);
  for (Index e = 0; e < mesh_.n_edges(); ++e) {
    const Index h = mesh_.halfedge_of(e);
    const Index twin = mesh_.twin(h);
    if (twin == no_index) continue;
    const Vec2& up = geometry.apex(h);
    const Vec2 down = Vec2(geometry.length(h), 0) - geometry.apex(twin);
    if (up.y() - down.y() <= 0) continue;
    const double x = up.x() + (down.x() - up.x()) * up.y() / (up.y() - down.y());
    if (x < 0 || x > geometry.length(h)) continue;
    const Index a = mesh_.from(TriangleMesh::prev(h));
    const Index b = mesh_.from(TriangleMesh::prev(twin));
    across_[a].emplace_back(b, (up - down).norm());
    across_[b].emplace_back(a, (up - down).norm());
  }
}

Vec3 SurfaceGraph::position(Index node) const {
  if (node < mesh_.n_vertices()) return mesh_.position(node);
  const int k = options_.virtual_vertices;
  const Index h = mesh_.halfedge_of((node - mesh_.n_vertices()) / k);
  const double t = ((node - mesh_.n_vertices()) % k + 1.0) / (k + 1);
  return (1 - t) * mesh_.position(mesh_.from(h)) + t * mesh_.position(mesh_.to(h));
}

void SurfaceGraph::relax(Index node, double distance) {
  if (distance >= distance_[node]) return;
  distance_[node] = distance;
  queue_.emplace(distance, node);
}

void SurfaceGraph::start(const SourceElement& element) {
  for (const Index face : faces_of(mesh_, element)) {
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      relax(mesh_.from(h), distance_in_face(mesh_, element, mesh_.position(mesh_.from(h))));
      const Index first = mesh_.n_vertices() + mesh_.edge_of(h) * options_.virtual_vertices;
      for (Index node = first; node < first + options_.virtual_vertices; ++node) {
        relax(node, distance_in_face(mesh_, element, position(node)));
      }
    }
  }
}

void SurfaceGraph::visit_face(Index node, Index face) {
  const Vec3 at = position(node);
  for (Index h = 3 * face; h < 3 * face + 3; ++h) {
    relax(mesh_.from(h), distance_[node] + (mesh_.position(mesh_.from(h)) - at).norm());
    const Index first = mesh_.n_vertices() + mesh_.edge_of(h) * options_.virtual_vertices;
    for (Index other = first; other < first + options_.virtual_vertices; ++other) {
      relax(other, distance_[node] + (position(other) - at).norm());
    }
  }
}

void SurfaceGraph::visit(Index node) {
  if (node >= mesh_.n_vertices()) {
    const Index h = mesh_.halfedge_of((node - mesh_.n_vertices()) / options_.virtual_vertices);
    visit_face(node, TriangleMesh::face_of(h));
    if (mesh_.twin(h) != no_index) visit_face(node, TriangleMesh::face_of(mesh_.twin(h)));
    return;
  }
  Index h = mesh_.outgoing(node);
  do {
    visit_face(node, TriangleMesh::face_of(h));
    h = mesh_.next_outgoing(h);
  } while (h != no_index && h != mesh_.outgoing(node));
  if (across_.empty()) return;
  for (const auto& [other, length] : across_[node]) relax(other, distance_[node] + length);
}

std::vector<double> SurfaceGraph::run(Progress& progress) {
  for (std::size_t visited = 0; !queue_.empty(); ++visited) {
    const auto [distance, node] = queue_.top();
    queue_.pop();
    if (visited % 1024 == 0) progress.checkpoint();
    if (distance == distance_[node]) visit(node);
  }
  distance_.resize(mesh_.n_vertices());
  return std::move(distance_);
}

}  // namespace

void GraphOptions::validate() const {
  if (virtual_vertices >= 0 && virtual_vertices <= 100) return;
  throw Error(ErrorCode::bad_usage, "number of virtual vertices is out of range",
              {.element = "virtual_vertices", .value = fmt::format("{}, limits 0 and 100", virtual_vertices)});
}

std::vector<double> graph_distances(const TriangleMesh& mesh, const SourceSet& sources, const GraphOptions& options,
                                    Progress& progress) {
  options.validate();
  if (sources.empty()) throw Error(ErrorCode::bad_usage, "the source set is empty", {.advice = "name a source"});
  SurfaceGraph graph(mesh, options);
  for (const SourceElement& element : sources.elements()) graph.start(element);
  return graph.run(progress);
}

}  // namespace isopath
