#pragma once

#include <array>
#include <cstdint>

#include "isopath/field/large_pages.h"

#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// A half-edge of a `FlatLayout`: `4 face + corner`, so that face and corner are a shift and a mask away.
using FlatHalfedge = std::uint32_t;
inline constexpr FlatHalfedge no_flat_halfedge = ~FlatHalfedge{0};

inline constexpr std::uint32_t no_flat_record = ~std::uint32_t{0};

inline FlatHalfedge flat_of(Index halfedge) { return static_cast<FlatHalfedge>(4 * (halfedge / 3) + halfedge % 3); }
inline std::uint32_t flat_face(FlatHalfedge h) { return h >> 2; }
inline std::uint32_t flat_corner(FlatHalfedge h) { return h & 3; }

/// What fronts need of a triangle, on one cache line, in single precision. The frame of a half-edge has its origin at
/// the tail, x along the half-edge, and the face at y > 0.
struct alignas(64) FlatFace {
  std::array<std::uint32_t, 3> vertex;  ///< at the tails of the half-edges
  std::array<FlatHalfedge, 3> twin;     ///< `no_flat_halfedge` on the boundary
  /// Where the user keeps what belongs to the half-edge; `no_flat_record` to begin with. Records that are numbered as
  /// a front first touches them lie side by side in memory.
  std::array<std::uint32_t, 3> record;
  std::array<float, 3> length;
  std::array<float, 3> apex_x;  ///< of the corner opposite the half-edge, in its frame
  float twice_area;

  /// Of the corner opposite the half-edge, in its frame; the half-edge must have a length.
  float apex_y(std::uint32_t corner) const { return twice_area / length[corner]; }
};

/// All triangles of a mesh laid out for fast propagation of fronts. Lengths are divided by `unit`, a power of two near
/// the mean edge length, so that single precision serves every scale.
struct FlatLayout {
  explicit FlatLayout(const TriangleMesh& mesh);

  LargeVector<FlatFace> faces;
  double unit = 1;
};

}  // namespace isopath
