#pragma once

#include <vector>

#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// A continuous function on the surface, of slope at most `max_slope`, whose levels can be found exactly on every edge.
/// Isolines (paper ch. 5) need no more than this, so that exact distances and vertex values share one extraction.
/// Unreached parts have the value infinity. Methods are const and safe to call from several threads.
class SurfaceFunction {
 public:
  SurfaceFunction() = default;
  SurfaceFunction(const SurfaceFunction&) = default;
  SurfaceFunction(SurfaceFunction&&) = default;
  SurfaceFunction& operator=(const SurfaceFunction&) = default;
  SurfaceFunction& operator=(SurfaceFunction&&) = default;
  virtual ~SurfaceFunction() = default;

  virtual double value_at_vertex(Index vertex) const = 0;
  virtual double value(const SurfacePoint& point) const = 0;

  /// Value and the unit direction of steepest ascent inside the point's face, as a vector in space (zero where it has
  /// none).
  struct Slope {
    double value = 0;
    Vec3 ascent = Vec3::Zero();
  };
  virtual Slope slope(const SurfacePoint& point) const = 0;

  /// Appends the parameters in [0, 1] along the edge's canonical half-edge where the function crosses `level`,
  /// ascending. Ends of value >= level count as above, and the number of crossings has the parity that the two ends
  /// demand.
  virtual void edge_crossings(Index edge, double level, std::vector<double>& parameters) const = 0;

  /// True when the function is linear inside every face: then no level can hide inside one.
  virtual bool linear_in_faces() const = 0;

  /// True when no closed level curve can lie inside this face without meeting its edges.
  virtual bool monotone_in_face(Index face) const = 0;

  virtual double max_slope() const = 0;

  /// No value lies below this: 0 for distances.
  virtual double lower_bound() const { return -infinity; }
};

}  // namespace isopath
