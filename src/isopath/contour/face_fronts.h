#pragma once

#include "isopath/core/geometry.h"
#include "isopath/field/exact_field_data.h"
#include "isopath/mesh/surface_point.h"

namespace isopath {

/// A front as it runs through the plane of one face: a circle around an unfolded pseudo-source, or a straight front of
/// parallel rays. All coordinates are in the frame of half-edge 3·face.
struct Front {
  Vec2 source = Vec2::Zero();  ///< the unfolded pseudo-source; of a straight front the unit direction it travels in
  double offset = 0;           ///< distance at the pseudo-source; of a straight front that at the frame's origin
  bool straight = false;
  Index root = no_index;

  double distance(const Vec2& p) const { return straight ? offset + source.dot(p) : offset + (p - source).norm(); }
  /// Unit direction of travel, the gradient of the distance; zero at the pseudo-source itself.
  Vec2 direction(const Vec2& p) const;
};

/// The angle between the directions that two fronts arrive from, in [0, π]; zero where one of them starts.
double angle_between(const Front& a, const Front& b, const Vec2& p);

/// What an exact field knows inside one face.
class FaceFronts {
 public:
  FaceFronts(const ExactFieldData& data, Index face);

  Index face() const { return face_; }
  const Vec2& corner(int i) const { return corners_[i]; }
  /// Twice the area over the square of the longest side: zero for a face without area.
  double flatness() const;
  bool contains(const Vec2& p, double slack) const;
  SurfacePoint surface_point(const Vec2& p) const;
  Vec2 plane(const SurfacePoint& point) const;
  /// The front that arrives first.
  Front nearest(const Vec2& p) const;
  /// A window of one of the face's edges; the face may lie on either side of it.
  Front of_window(Index halfedge, const Window& window) const;

 private:
  const ExactFieldData& data_;
  Index face_;
  Vec2 corners_[3];
};

}  // namespace isopath
