#pragma once

#include <vector>

#include "isopath/impact/surface_curve.h"

namespace isopath {

/// A closed polyline on the surface with arc length as parameter. Arcs are in mm from the first point and taken modulo
/// the length. The mesh must outlive it.
class Ring {
 public:
  /// `points`, at least two, as of a closed contour: consecutive ones share a face, the last one and the first too, and
  /// the first is not repeated. An open curve may be given as a ring whose last point is followed by the first one at
  /// once, without a length between them: consecutive points of it share a face but for these.
  Ring(const TriangleMesh& mesh, std::vector<SurfacePoint> points, bool open = false);

  bool open() const { return open_; }
  double length() const { return arc_.back(); }
  Index face() const { return points_.front().face; }
  /// The arc brought to [0, length).
  double wrapped(double arc) const;
  SurfacePoint point(double arc) const;
  Vec3 position(double arc) const;
  /// The arc, within `reach` of `near`, of the point nearest to a place.
  double nearest_arc(const Vec3& place, double near, double reach) const;
  /// Appends the stretch from one arc forward to another, both included; all round when they are equal.
  void append_forward(SurfaceCurve& curve, double from, double to) const;
  /// The same against the order of the points.
  void append_backward(SurfaceCurve& curve, double from, double to) const;

 private:
  /// The segment that contains the arc, and where in it.
  std::size_t segment_at(double wrapped_arc) const;
  double fraction_in(std::size_t segment, double wrapped_arc) const;
  std::size_t next(std::size_t i) const { return i + 1 < points_.size() ? i + 1 : 0; }

  const TriangleMesh& mesh_;
  bool open_;
  std::vector<SurfacePoint> points_;
  std::vector<Vec3> positions_;
  std::vector<double> arc_;  // of every point, and the length at the end
};

}  // namespace isopath
