#pragma once

#include <array>

#include "isopath/core/geometry.h"

namespace isopath {

/// How lengths are measured around a point of a surface (paper ch. 10): a vector of the tangent plane counts with its
/// two parts along orthogonal directions stretched by a factor each.
struct MetricTensor {
  Vec3 first = Vec3::UnitX();   ///< unit, tangent
  Vec3 second = Vec3::UnitY();  ///< unit, tangent, orthogonal to the first
  double first_stretch = 1;     ///< a length of 1 mm along `first` counts as this many mm; > 0
  double second_stretch = 1;

  Vec3 normal() const { return first.cross(second); }
  /// Length of a vector that is first turned into the tangent plane, keeping its length in space.
  double length(const Vec3& v) const;
};

/// How tensors are carried from the vertices to edges, and to the points between.
enum class TensorBlend {
  linear,  ///< squared stretches as matrices: continuous everywhere, and what curvature does
  paper,  ///< the paper's: principal directions turn and stretches change evenly; jumps where directions differ by 45°
};

/// The tensor at barycentric weights between three, which are turned into the plane of their mean normal first; their
/// normals must lie on one side of the surface. Weights that are zero leave their tensor out, so that both faces at an
/// edge agree.
MetricTensor blended(const std::array<MetricTensor, 3>& tensors, const Vec3& weights, TensorBlend blend);

/// Length of an edge between two vertices: the root of the mean of the squared lengths there, or for the paper's blend
/// the mean of the lengths.
double edge_length(const Vec3& edge, const MetricTensor& a, const MetricTensor& b, TensorBlend blend);

}  // namespace isopath
