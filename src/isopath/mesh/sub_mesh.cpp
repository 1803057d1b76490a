#include "isopath/mesh/sub_mesh.h"

#include <algorithm>
#include <utility>

namespace isopath {
namespace {

/// Adds a face to a part. `corner(h)` is the place for the vertex in the part of the corner that half-edge h starts at,
/// `joined(h)` tells whether the face over half-edge h belongs to the part too.
template <class Corner, class Joined>
void add_face(const TriangleMesh& mesh, Index face, const Corner& corner, const Joined& joined, SubMesh& part,
              TriangleSoup& soup) {
  Triangle triangle;
  for (int i = 0; i < 3; ++i) {
    const Index h = 3 * face + i;
    if (corner(h) == no_index) {
      const auto vertex = static_cast<Index>(soup.positions.size());
      soup.positions.push_back(mesh.position(mesh.from(h)));
      part.vertex.push_back(mesh.from(h));
      // The faces round the vertex that hang together with this one share it: clockwise to a border or all round, then
      // counter-clockwise.
      corner(h) = vertex;
      for (Index c = h; joined(c);) {
        c = TriangleMesh::next(mesh.twin(c));
        if (corner(c) != no_index) break;
        corner(c) = vertex;
      }
      for (Index c = h; joined(TriangleMesh::prev(c));) {
        c = mesh.twin(TriangleMesh::prev(c));
        if (corner(c) != no_index) break;
        corner(c) = vertex;
      }
    }
    triangle[i] = corner(h);
  }
  soup.triangles.push_back(triangle);
  part.face.push_back(face);
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

SubMesh sub_mesh(const TriangleMesh& mesh, std::span<const Index> faces) {
  const auto number_of = [&](Index face) {
    const auto at = std::lower_bound(faces.begin(), faces.end(), face);
    return at != faces.end() && *at == face ? static_cast<Index>(at - faces.begin()) : no_index;
  };
  std::vector<Index> corners(3 * faces.size(), no_index);
  const auto corner = [&](Index h) -> Index& { return corners[3 * number_of(TriangleMesh::face_of(h)) + h % 3]; };
  const auto joined = [&](Index h) {
    const Index twin = mesh.twin(h);
    return twin != no_index && number_of(TriangleMesh::face_of(twin)) != no_index;
  };
  SubMesh part;
  TriangleSoup soup;
  for (const Index face : faces) add_face(mesh, face, corner, joined, part, soup);
  part.mesh = TriangleMesh(std::move(soup));
  return part;
}

std::vector<SubMesh> split_mesh(const TriangleMesh& mesh, std::span<const Index> part_of_face) {
  const Index n_parts = part_of_face.empty() ? 0 : *std::max_element(part_of_face.begin(), part_of_face.end()) + 1;
  std::vector<SubMesh> parts(n_parts);
  std::vector<TriangleSoup> soups(n_parts);
  std::vector<Index> corners(mesh.n_halfedges(), no_index);
  const auto corner = [&](Index h) -> Index& { return corners[h]; };
  const auto joined = [&](Index h) {
    const Index twin = mesh.twin(h);
    return twin != no_index && part_of_face[TriangleMesh::face_of(twin)] == part_of_face[TriangleMesh::face_of(h)];
  };
  for (Index f = 0; f < mesh.n_faces(); ++f)
    add_face(mesh, f, corner, joined, parts[part_of_face[f]], soups[part_of_face[f]]);
  for (Index p = 0; p < n_parts; ++p) parts[p].mesh = TriangleMesh(std::move(soups[p]));
  return parts;
}

}  // namespace isopath
