#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/source.h"

namespace isopath {

/// Exact geodesic distances at the vertices and nothing else, in the mesh's order, in mm; infinity where no source
/// reaches. The same as those of ExactField (see there), several times faster and in less memory: windows are freed
/// behind the front. Not propagated beyond `stop_distance`; farther values are bounds from above. The result does not
/// depend on the number of threads. Throws Error(bad_usage) for an empty source set, Error(cancelled) on request.
std::vector<double> exact_distances(const TriangleMesh& mesh, const SourceSet& sources, double stop_distance = infinity,
                                    Progress& progress = Progress::none());
/// The same in the metric of a geometry.
std::vector<double> exact_distances(const TriangleMesh& mesh, const IntrinsicGeometry& metric, const SourceSet& sources,
                                    double stop_distance = infinity, Progress& progress = Progress::none());

}  // namespace isopath
