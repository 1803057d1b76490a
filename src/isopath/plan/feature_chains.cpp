#include <algorithm>
#include <vector>

#include "isopath/plan/make_sources.h"

#include "isopath/core/angle.h"

namespace isopath {
namespace {

/// Edges that are to be chained, and which of them meet at each vertex.
class EdgeGraph {
 public:
  EdgeGraph(const TriangleMesh& mesh, double angle)
      : mesh_(mesh), chosen_(mesh.n_edges(), 0), degree_(mesh.n_vertices(), 0) {
    for (Index e = 0; e < mesh.n_edges(); ++e) {
      if (mesh.is_boundary_edge(e)) continue;
      const Index h = mesh.halfedge_of(e);
      const Vec3 a = mesh.face_normal(TriangleMesh::face_of(h));
      const Vec3 b = mesh.face_normal(TriangleMesh::face_of(mesh.twin(h)));
      // A triangle without area has no normal, and hence no feature edge.
      if (a.isZero(0) || b.isZero(0) || angle_between(a, b) <= angle) continue;
      chosen_[e] = 1;
      ++degree_[mesh.from(h)];
      ++degree_[mesh.to(h)];
    }
  }

  bool starts_chain(Index vertex) const { return degree_[vertex] > 0 && degree_[vertex] != 2; }
  bool is_open(Index edge) const { return chosen_[edge] != 0; }

  /// Walks from a half-edge until the chain ends, and takes its edges out.
  std::vector<Index> take_chain(Index halfedge) {
    std::vector<Index> chain;
    for (Index h = halfedge; h != no_index;) {
      chain.push_back(h);
      chosen_[mesh_.edge_of(h)] = 0;
      h = degree_[mesh_.to(h)] == 2 ? open_from(mesh_.to(h)) : no_index;
    }
    return chain;
  }

  /// A half-edge that leaves the vertex along an edge still there; `no_index` when there is none.
  Index open_from(Index vertex) const {
    const Index first = mesh_.outgoing(vertex);
    for (Index h = first; h != no_index;) {
      if (is_open(mesh_.edge_of(h))) return h;
      h = mesh_.next_outgoing(h);
      if (h == first) break;
    }
    return no_index;
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<char> chosen_;
  std::vector<int> degree_;
};

}  // namespace

std::vector<std::vector<Index>> feature_chains(const TriangleMesh& mesh, double angle) {
  EdgeGraph graph(mesh, angle);
  std::vector<std::vector<Index>> chains;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (!graph.starts_chain(v)) continue;
    for (Index h = graph.open_from(v); h != no_index; h = graph.open_from(v)) chains.push_back(graph.take_chain(h));
  }
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    if (graph.is_open(e)) chains.push_back(graph.take_chain(mesh.halfedge_of(e)));
  }
  return chains;
}

}  // namespace isopath
