#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/source.h"
#include "isopath/field/vertex_fan.h"
#include "isopath/field/window.h"

namespace isopath {

/// How sources enter a propagation: segments send straight fronts over their strip, points circles over what the strips
/// leave.
struct SourceFronts {
  /// A window in the frame of a half-edge, which it arrives at from inside the half-edge's face.
  struct Front {
    Index halfedge = no_index;
    Window window;
  };
  /// A vertex that is a source, and the directions that its segments serve.
  struct Vertex {
    Index vertex = no_index;
    Index root = no_index;
    std::vector<BlockedArc> blocked;
  };
  std::vector<Front> fronts;
  std::vector<Vertex> vertices;
};

/// Throws Error(cancelled) when `progress` wants to stop: there may be a million elements.
SourceFronts source_fronts(const TriangleMesh& mesh, const IntrinsicGeometry& geometry, const SourceSet& sources,
                           Progress& progress = Progress::none());

}  // namespace isopath
