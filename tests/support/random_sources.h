#pragma once

#include <cstdint>
#include <vector>

#include "isopath/field/source.h"
#include "support/test_meshes.h"

namespace isopath::test {

/// A walk over the surface from face to face, of up to `n` points, whose consecutive points share a face.
std::vector<SurfacePoint> random_polyline(Rng& rng, const TriangleMesh& mesh, int n);
/// A closed polyline round an inner vertex, over its edges; empty when the mesh has no inner vertex.
std::vector<SurfacePoint> random_loop(Rng& rng, const TriangleMesh& mesh);
/// One to `most` sources of every kind: points of all supports, polylines, loops, chains of edges, boundary loops.
SourceSet random_sources(Rng& rng, const TriangleMesh& mesh, int most = 3);

/// A small random mesh with random sources. By turns the mesh is open or closed, has holes, has slivers.
struct RandomCase {
  TriangleMesh mesh;
  SourceSet sources;
};
RandomCase random_case(std::uint64_t seed);

}  // namespace isopath::test
