#include "isopath/field/checked_distances.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/field/exact_distances.h"
#include "isopath/field/virtual_source.h"

namespace isopath {
namespace {

/// The distances that are positive and finite, in order.
std::vector<double> sorted_distances(const std::vector<double>& distances) {
  std::vector<double> sorted;
  for (const double d : distances) {
    if (d > 0 && d < infinity) sorted.push_back(d);
  }
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

double largest_error(const std::vector<double>& distances, std::span<const double> exact, double within) {
  double error = 0;
  for (std::size_t v = 0; v < distances.size(); ++v) {
    if (exact[v] > 0 && exact[v] <= within) error = std::max(error, std::abs(distances[v] - exact[v]) / exact[v]);
  }
  return error;
}

}  // namespace

void CheckedDistancesOptions::validate() const {
  if (!(max_error > 0 && max_error < 1)) {
    throw Error(ErrorCode::bad_usage, "the error asked for is out of range",
                {.element = "max_error", .value = std::to_string(max_error), .advice = "give a share between 0 and 1"});
  }
  if (!(sample > 0 && sample <= 1)) {
    throw Error(ErrorCode::bad_usage, "the share of vertices to compare is out of range",
                {.element = "sample", .value = std::to_string(sample), .advice = "give a share between 0 and 1"});
  }
}

CheckedDistances checked_distances(const TriangleMesh& mesh, const SourceSet& sources,
                                   const CheckedDistancesOptions& options, Progress& progress) {
  options.validate();
  CheckedDistances result{virtual_source_distances(mesh, sources, progress), 0, false};
  const std::vector<double> sorted = sorted_distances(result.at_vertices);
  if (sorted.empty()) return result;

  const auto compared = static_cast<std::size_t>(std::ceil(options.sample * static_cast<double>(sorted.size())));
  const double within = sorted[std::clamp<std::size_t>(compared, 1, sorted.size()) - 1];
  // A part as far again as is acceptable, so that distances that are too short are compared as well.
  const double stop = options.sample < 1 ? within * (1 + options.max_error) : infinity;
  result.estimated_error = largest_error(result.at_vertices, exact_distances(mesh, sources, stop, progress), within);
  if (result.estimated_error <= options.max_error) return result;
  result.at_vertices = exact_distances(mesh, sources, infinity, progress);
  result.exact = true;
  return result;
}

}  // namespace isopath
