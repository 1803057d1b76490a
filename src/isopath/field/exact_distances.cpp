#include "isopath/field/exact_distances.h"

#include "isopath/core/error.h"
#include "isopath/field/list_propagation.h"

namespace isopath {

std::vector<double> exact_distances(const TriangleMesh& mesh, const SourceSet& sources, double stop_distance,
                                    Progress& progress) {
  return exact_distances(mesh, IntrinsicGeometry(mesh), sources, stop_distance, progress);
}

std::vector<double> exact_distances(const TriangleMesh& mesh, const IntrinsicGeometry& metric, const SourceSet& sources,
                                    double stop_distance, Progress& progress) {
  if (sources.empty()) throw Error(ErrorCode::bad_usage, "a distance field needs at least one source");
  ListPropagation propagation(mesh, metric, false);
  propagation.start(source_fronts(mesh, metric, sources, progress));
  propagation.run(stop_distance, progress);
  return propagation.vertex_distances();
}

}  // namespace isopath
