#pragma once

#include <string_view>
#include <vector>

#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// What a stretch of the curve is for: it covers the surface, links two covering stretches on the surface, or lifts
/// off.
enum class MoveKind { cover, link, lift };
std::string_view name_of(MoveKind kind);

/// A point of the impact curve (paper ch. 3.1). Its kind is that of the move that arrives at it.
struct ImpactPoint {
  MoveKind kind = MoveKind::cover;
  SurfacePoint at;               ///< where on the surface; invalid in the air, and a lift ends on the surface
  Vec3 position = Vec3::Zero();  ///< mm
  Vec3 normal = Vec3::UnitZ();   ///< unit, outward from the side the triangles' orientation shows
  Index piece = 0;               ///< counts up with every lift: one piece is covered without leaving the surface
};

/// The curve on the surface that the tool is led along, in order.
struct ImpactCurve {
  std::vector<ImpactPoint> points;
};

/// Length in space of the moves of one kind.
double length_of(const ImpactCurve& curve, MoveKind kind);

}  // namespace isopath
