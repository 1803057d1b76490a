#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <limits>

namespace isopath {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Box3 = Eigen::AlignedBox3d;

/// Index of a vertex, face, edge or half-edge.
using Index = std::int32_t;
inline constexpr Index no_index = -1;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// z component of the cross product of two plane vectors: twice the signed area they span.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace isopath
