#include "isopath/mesh/sub_mesh.h"

#include <algorithm>
#include <utility>

namespace isopath {
namespace {

bool is_open(const TriangleMesh& mesh, std::span<const Index> part, Index halfedge) {
  const Index twin = mesh.twin(halfedge);
  return twin == no_index || part[TriangleMesh::face_of(twin)] != part[TriangleMesh::face_of(halfedge)];
}

}  // namespace

std::vector<Index> parts_between_cuts(const TriangleMesh& mesh, std::span<const char> is_cut) {
  std::vector<Index> part(mesh.n_faces(), no_index);
  std::vector<Index> open;
  Index n_parts = 0;
  for (Index seed = 0; seed < mesh.n_faces(); ++seed) {
    if (part[seed] != no_index) continue;
    part[seed] = n_parts;
    open = {seed};
    while (!open.empty()) {
      const Index face = open.back();
      open.pop_back();
      for (Index h = 3 * face; h < 3 * face + 3; ++h) {
        const Index twin = mesh.twin(h);
        if (twin == no_index || is_cut[mesh.edge_of(h)] != 0) continue;
        const Index next = TriangleMesh::face_of(twin);
        if (part[next] != no_index) continue;
        part[next] = n_parts;
        open.push_back(next);
      }
    }
    ++n_parts;
  }
  return part;
}

std::vector<SubMesh> split_mesh(const TriangleMesh& mesh, std::span<const Index> part_of_face) {
  const Index n_parts = part_of_face.empty() ? 0 : *std::max_element(part_of_face.begin(), part_of_face.end()) + 1;
  std::vector<SubMesh> parts(n_parts);
  std::vector<TriangleSoup> soups(n_parts);
  std::vector<Index> corner(mesh.n_halfedges(), no_index);  // its vertex in the part; corner i of face f is 3 f + i
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    SubMesh& part = parts[part_of_face[f]];
    TriangleSoup& soup = soups[part_of_face[f]];
    Triangle triangle;
    for (int i = 0; i < 3; ++i) {
      const Index h = 3 * f + i;
      if (corner[h] == no_index) {
        const auto vertex = static_cast<Index>(soup.positions.size());
        soup.positions.push_back(mesh.position(mesh.from(h)));
        part.vertex.push_back(mesh.from(h));
        // The faces round the vertex that hang together with this one share it: clockwise to a border or all round,
        // then counter-clockwise.
        corner[h] = vertex;
        for (Index c = h; !is_open(mesh, part_of_face, c);) {
          c = TriangleMesh::next(mesh.twin(c));
          if (corner[c] != no_index) break;
          corner[c] = vertex;
        }
        for (Index c = h; !is_open(mesh, part_of_face, TriangleMesh::prev(c));) {
          c = mesh.twin(TriangleMesh::prev(c));
          if (corner[c] != no_index) break;
          corner[c] = vertex;
        }
      }
      triangle[i] = corner[h];
    }
    soup.triangles.push_back(triangle);
    part.face.push_back(f);
  }
  for (Index p = 0; p < n_parts; ++p) parts[p].mesh = TriangleMesh(std::move(soups[p]));
  return parts;
}

}  // namespace isopath
