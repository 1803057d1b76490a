#pragma once

#include <string>

#include "support/test_meshes.h"

namespace isopath::test {

/// A small mesh that is hard on distances, and what makes it so, for the message of a failing test.
struct HardMesh {
  TriangleMesh mesh;
  std::string kind;
};

struct HardMeshOptions {
  double least_height = 0;        ///< of a triangle over its longest side, relative to it; 0 for any
  double least_distance = 1e-15;  ///< of two neighbours, relative to the size; 1e-15 for any
  double strongest_squeeze = 1e-8;
};

/// A random mesh of 2 to about 130 triangles, of one or two components, each of one of these shapes: random discs, with
/// and without holes, and closed random surfaces; regular flat grids (exact ties); saddles with angles of many turns;
/// tori; boxes and pyramids; fans of needles. Then, each with some chance: slivers, among them ones with angles of
/// zero; vertices close together; all of it squeezed along one axis. At last scaled by 1e-9, 1 or 1e12 and renumbered.
HardMesh hard_mesh(Rng& rng, const HardMeshOptions& options = {});

/// The same surface with vertices and faces in random order. `vertex[v]` and `face[f]` tell the new numbers; corner i
/// of a face stays corner i.
struct Renumbered {
  TriangleMesh mesh;
  std::vector<Index> vertex;
  std::vector<Index> face;
};
Renumbered renumbered(Rng& rng, const TriangleMesh& mesh);

}  // namespace isopath::test
