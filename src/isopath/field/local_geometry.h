#pragma once

#include <span>

#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/large_pages.h"
#include "isopath/mesh/local_numbering.h"

namespace isopath {

/// A geometry's half-edges in the order of a numbering: its own arrays where nothing is numbered anew, otherwise
/// copies. The geometry must outlive it.
class LocalGeometry {
 public:
  LocalGeometry(const IntrinsicGeometry& geometry, const LocalNumbering& numbering);
  LocalGeometry(const LocalGeometry&) = delete;
  LocalGeometry& operator=(const LocalGeometry&) = delete;

  /// See IntrinsicGeometry.
  double length(Index halfedge) const { return length_[halfedge]; }
  const Vec2& apex(Index halfedge) const { return apex_[halfedge]; }
  double angle_at_tail(Index halfedge) const { return angle_[halfedge]; }

 private:
  std::span<const double> length_;
  std::span<const Vec2> apex_;
  std::span<const double> angle_;
  LargeVector<double> own_length_;
  LargeVector<Vec2> own_apex_;
  LargeVector<double> own_angle_;
};

}  // namespace isopath
