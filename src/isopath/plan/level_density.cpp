#include "isopath/plan/level_density.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "isopath/core/error.h"

namespace isopath {
namespace {

constexpr double bins_over_spacing = 0.25;
constexpr double least_slope = 0.2;
/// Share of a level's length along which passes may lie farther apart: about as much as there is on ridges.
constexpr double flat_share = 0.15;
constexpr double most_raised = 2;
constexpr double most_at_once = 1.4;

struct FaceSlope {
  double slope = 0;
  double length = 0;  ///< of a level in the face, up to a factor
};

FaceSlope slope_in(const VertexField& function, const IntrinsicGeometry& geometry, Index face) {
  const auto& [a, b, c] = function.mesh().triangle(face);
  const Vec2 ab(geometry.length(3 * face), 0);
  const Vec2 ac = geometry.apex(3 * face);
  const double twice_area = cross(ab, ac);
  const double db = function.values()[b] - function.values()[a];
  const double dc = function.values()[c] - function.values()[a];
  const double slope = twice_area > 0 ? (dc * ab - db * ac).norm() / twice_area : 0;
  return {slope, slope * twice_area};
}

/// The slope that is exceeded along nearly all of the length; `otherwise` without parts.
double low_slope(std::vector<FaceSlope>& parts, double otherwise) {
  std::sort(parts.begin(), parts.end(), [](const FaceSlope& a, const FaceSlope& b) { return a.slope < b.slope; });
  double whole = 0;
  for (const FaceSlope& part : parts) whole += part.length;
  double below = 0;
  for (const FaceSlope& part : parts) {
    below += part.length;
    if (below >= flat_share * whole) return part.slope;
  }
  return otherwise;
}

}  // namespace

LevelDensity::LevelDensity(const VertexField& function, const IntrinsicGeometry& geometry, double spacing)
    : function_(function), spacing_(spacing) {
  if (!(spacing > 0 && spacing < infinity)) {
    throw Error(ErrorCode::bad_usage, "must be a positive length in mm",
                {.element = "spacing", .value = fmt::format("{}", spacing)});
  }
  for (const double value : function.values()) {
    if (!std::isfinite(value)) continue;
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
  }
  if (low_ > high_) low_ = high_ = 0;
  factor_.resize(static_cast<std::size_t>((high_ - low_) / width()) + 1);
  std::vector<std::vector<FaceSlope>> parts(factor_.size());
  for (Index face = 0; face < function.mesh().n_faces(); ++face) {
    const auto& [a, b, c] = function.mesh().triangle(face);
    const auto [least, most] = std::minmax({function.values()[a], function.values()[b], function.values()[c]});
    if (!std::isfinite(most)) continue;
    const std::size_t first = bin_of(least);
    const std::size_t last = bin_of(most);
    FaceSlope part = slope_in(function, geometry, face);
    part.length /= static_cast<double>(last - first + 1);
    for (std::size_t bin = first; bin <= last; ++bin) parts[bin].push_back(part);
  }
  double slope = 1;
  for (std::size_t bin = 0; bin < factor_.size(); ++bin) {
    slope = std::max(low_slope(parts[bin], slope), least_slope);
    factor_[bin] = 1 / slope;
  }
  most_ = factor_;
  for (double& most : most_) most *= most_raised;
}

VertexField LevelDensity::applied() const {
  // linear between the middles of bins, so that no kink of the stretching shows in isolines
  const std::size_t n = factor_.size();
  std::vector<double> at_end(n + 1);  // of the bins
  for (std::size_t k = 0; k <= n; ++k) at_end[k] = 0.5 * (factor_[k > 0 ? k - 1 : 0] + factor_[std::min(k, n - 1)]);
  std::vector<double> start{low_};
  for (std::size_t k = 0; k < n; ++k) start.push_back(start.back() + 0.5 * (at_end[k] + at_end[k + 1]) * width());
  std::vector<double> result(function_.values().begin(), function_.values().end());
  for (double& value : result) {
    if (!std::isfinite(value)) continue;
    const std::size_t bin = bin_of(value);
    const double above = value - low_ - static_cast<double>(bin) * width();
    value = start[bin] + above * (at_end[bin] + 0.5 * (at_end[bin + 1] - at_end[bin]) * above / width());
  }
  return {function_.mesh(), std::move(result)};
}

bool LevelDensity::raise(std::span<const double> gaps, double allowed) {
  std::vector<double> widest(factor_.size(), 0.0);
  for (std::size_t v = 0; v < gaps.size(); ++v) {
    const double value = function_.values()[v];
    if (!std::isfinite(value) || !std::isfinite(gaps[v])) continue;
    double& gap = widest[bin_of(value)];
    gap = std::max(gap, gaps[v]);
  }
  // a gap is widest half-way between two passes, and both have to move
  const auto reach = static_cast<std::size_t>(std::ceil(0.5 / bins_over_spacing));
  bool changed = false;
  for (std::size_t bin = 0; bin < factor_.size(); ++bin) {
    const auto first = widest.begin() + static_cast<std::ptrdiff_t>(bin - std::min(bin, reach));
    const auto last = widest.begin() + static_cast<std::ptrdiff_t>(std::min(bin + reach + 1, widest.size()));
    const double gap = *std::max_element(first, last);
    const double raised = std::min(most_[bin], factor_[bin] * std::clamp(gap / allowed, 1.0, most_at_once));
    changed = changed || raised > factor_[bin];
    factor_[bin] = raised;
  }
  return changed;
}

double LevelDensity::width() const { return bins_over_spacing * spacing_; }

std::size_t LevelDensity::bin_of(double value) const {
  return std::min(factor_.size() - 1, static_cast<std::size_t>(std::max(0.0, (value - low_) / width())));
}

}  // namespace isopath
