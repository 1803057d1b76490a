#include "isopath/contour/isolines.h"

#include <fmt/format.h>

#include <cmath>

#include "isopath/contour/chain.h"
#include "isopath/contour/level_cut.h"
#include "isopath/core/error.h"

namespace isopath {

void IsolineOptions::validate() const {
  if (!std::isfinite(chord_tolerance) || chord_tolerance < 0) {
    throw Error(ErrorCode::bad_usage, "the chord tolerance must be a length of at least 0",
                {.element = "chord_tolerance", .value = fmt::format("{}", chord_tolerance)});
  }
}

double IsolineOptions::chord_tolerance_for(const TriangleMesh& mesh) const {
  return chord_tolerance > 0 ? chord_tolerance : 1e-4 * mesh.size();
}

void validate_levels(std::span<const double> levels) {
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (!std::isfinite(levels[i]) || (i > 0 && !(levels[i] > levels[i - 1]))) {
      throw Error(ErrorCode::bad_usage, "levels must be finite and ascending",
                  {.element = fmt::format("level {}", i), .value = fmt::format("{}", levels[i])});
    }
  }
}

std::vector<Contour> isolines(const TriangleMesh& mesh, const SurfaceFunction& function, std::span<const double> levels,
                              const IsolineOptions& options, Progress& progress) {
  options.validate();
  validate_levels(levels);
  return chain_pieces(mesh, cut_levels(mesh, function, levels, options.chord_tolerance_for(mesh), progress)).contours;
}

double length_of(const TriangleMesh& mesh, const Contour& contour) {
  if (contour.points.empty()) return 0;
  double length = 0;
  Vec3 last = position_of(mesh, contour.closed ? contour.points.back() : contour.points.front());
  for (const SurfacePoint& point : contour.points) {
    const Vec3 position = position_of(mesh, point);
    length += (position - last).norm();
    last = position;
  }
  return length;
}

}  // namespace isopath
