#include "support/random_sources.h"

#include <algorithm>
#include <utility>

namespace isopath::test {

std::vector<SurfacePoint> random_polyline(Rng& rng, const TriangleMesh& mesh, int n) {
  std::vector<SurfacePoint> points = {random_supported_point(rng, mesh)};
  Index face = points.back().face;
  while (static_cast<int>(points.size()) + 1 < n) {
    const SurfacePoint last = express_in(mesh, points.back(), face);
    const Index h = 3 * face + random_index(rng, 3);
    // An edge that the walk stands on would make it turn back, or stay where it is.
    if (last.barycentric[TriangleMesh::prev(h) % 3] == 0) continue;
    points.push_back(point_on_halfedge(h, random_real(rng, 0.1, 0.9)));
    if (mesh.twin(h) == no_index) return points;
    face = TriangleMesh::face_of(mesh.twin(h));
  }
  SurfacePoint end{face, Vec3(random_real(rng, 0.1, 1), random_real(rng, 0.1, 1), random_real(rng, 0.1, 1))};
  end.barycentric /= end.barycentric.sum();
  points.push_back(end);
  return points;
}

std::vector<SurfacePoint> random_loop(Rng& rng, const TriangleMesh& mesh) {
  std::vector<Index> inner;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (mesh.outgoing(v) != no_index && !mesh.is_boundary_vertex(v)) inner.push_back(v);
  }
  std::vector<SurfacePoint> points;
  if (inner.empty()) return points;
  const Index first = mesh.outgoing(inner[random_index(rng, static_cast<Index>(inner.size()))]);
  Index h = first;
  do {
    points.push_back(point_on_halfedge(h, random_real(rng, 0.1, 0.9)));
    h = mesh.next_outgoing(h);
  } while (h != first);
  return points;
}

namespace {

std::vector<Index> random_chain(Rng& rng, const TriangleMesh& mesh) {
  std::vector<Index> chain = {random_index(rng, mesh.n_halfedges())};
  std::vector<Index> visited = {mesh.from(chain[0]), mesh.to(chain[0])};
  while (chain.size() < 4) {
    Index h = TriangleMesh::next(chain.back());
    if (random_index(rng, 2) == 1 && mesh.twin(h) != no_index) h = TriangleMesh::next(mesh.twin(h));
    if (std::find(visited.begin(), visited.end(), mesh.to(h)) != visited.end()) break;
    chain.push_back(h);
    visited.push_back(mesh.to(h));
  }
  return chain;
}

}  // namespace

SourceSet random_sources(Rng& rng, const TriangleMesh& mesh, int most) {
  SourceSet sources;
  const int n = 1 + random_index(rng, most);
  for (int k = 0; k < n; ++k) {
    switch (random_index(rng, 7)) {
      case 0:
        sources.add_vertex(mesh, mesh.from(random_index(rng, mesh.n_halfedges())));
        break;
      case 1:
        sources.add_polyline(mesh, random_polyline(rng, mesh, 2 + random_index(rng, 4)), false);
        break;
      case 2:
        if (const auto loop = random_loop(rng, mesh); !loop.empty()) sources.add_polyline(mesh, loop, true);
        break;
      case 3:
        sources.add_halfedges(mesh, random_chain(rng, mesh), false);
        break;
      case 4:
        if (const auto& loops = mesh.boundary_loops(); k == 0 && !loops.empty()) {
          sources.add_halfedges(mesh, loops[random_index(rng, static_cast<Index>(loops.size()))], true);
        }
        break;
      default:
        sources.add_point(random_supported_point(rng, mesh));
    }
  }
  if (sources.empty()) sources.add_point(random_supported_point(rng, mesh));
  return sources;
}

RandomCase random_case(std::uint64_t seed) {
  Rng rng(seed);
  TriangleMesh mesh = random_mesh(rng, {.closed = seed % 2 == 0, .holes = seed % 5 == 0, .slivers = seed % 3 == 0});
  SourceSet sources = random_sources(rng, mesh);
  return {std::move(mesh), std::move(sources)};
}

}  // namespace isopath::test
