#pragma once

#include <span>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/vertex_field.h"

namespace isopath {

/// How close to each other the levels of a function are taken, as a factor for every level: 2 puts passes there twice
/// as close as the same spacing puts them elsewhere. Smoothing changes slopes, and with them the distances between
/// isolines of even levels; a function that is stretched along its levels has the same isolines at other ones.
class LevelDensity {
 public:
  /// The density at which passes lie no farther than a spacing apart along nearly all of each level, in the geometry's
  /// lengths, but for 15 % of it, where ridges are: one over the slope that the rest exceeds, 5 at most. The function
  /// must outlive the object. Throws Error(bad_usage) unless the spacing, mm, is positive.
  LevelDensity(const VertexField& function, const IntrinsicGeometry& geometry, double spacing);

  /// The function stretched, so that even levels of the result lie that dense.
  VertexField applied() const;

  /// Raises the density at levels where gaps, given at every vertex, are wider than allowed, by what they are too wide;
  /// by 1.4 at once and to twice the first density at most. Returns whether it has changed. Several rounds of planning
  /// and measuring lead to the density that gaps ask for.
  bool raise(std::span<const double> gaps, double allowed);

 private:
  double width() const;
  std::size_t bin_of(double value) const;

  const VertexField& function_;
  double spacing_;
  double low_ = infinity;
  double high_ = -infinity;
  std::vector<double> factor_;  ///< of each bin of levels
  std::vector<double> most_;
};

}  // namespace isopath
