// The exact distance from a part's boundary: the farthest point, the way back from it, and a mesh to look at.
//   01_distance_field PART OUT.ply
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/mesh/read_mesh.h"
#include "isopath/mesh/write_mesh.h"

using namespace isopath;

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s PART OUT.ply\n", argv[0]);
    return 2;
  }
  try {
    // A mesh is read as a soup of triangles; TriangleMesh accepts it when it is a clean surface, and says why if not.
    const TriangleMesh mesh(read_mesh(argv[1]).soup);

    // Every boundary loop is a source, as a chain of straight segments. The mesh must outlive the field.
    const ExactField field = ExactField::compute(mesh, boundary_source(mesh));
    const auto distance = field.vertex_distances();

    const auto farthest = static_cast<Index>(std::max_element(distance.begin(), distance.end()) - distance.begin());
    const auto way = field.shortest_path(point_at_vertex(mesh, farthest));
    std::printf("vertex %d is %.6g mm from the boundary; the way there crosses %zu edges\n", farthest,
                distance[farthest], way.size() - 2);

    write_mesh(argv[2], mesh.soup(), {.distance = distance});
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
