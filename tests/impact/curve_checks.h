#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <span>
#include <vector>

#include "isopath/impact/gap.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/impact/surface_curve.h"
#include "isopath/mesh/normals.h"
#include "isopath/mesh/surface_walk.h"
#include "support/test_meshes.h"

/// What every curve on a surface promises, checked point by point.
namespace isopath::test {

/// A mesh with what curves on it are made with.
struct Plate {
  TriangleMesh mesh;
  SurfaceLocator locator{mesh};
  SurfaceLinker linker{mesh, locator};
  SmoothNormals normals{mesh};
};

/// Consecutive points share a face, and positions are those of the points.
inline void expect_on_surface(const TriangleMesh& mesh, const SurfaceCurve& curve) {
  ASSERT_EQ(curve.points.size(), curve.positions.size());
  for (std::size_t i = 0; i < curve.size(); ++i) {
    ASSERT_TRUE(curve.points[i].valid()) << "point " << i;
    ASSERT_GE(curve.points[i].barycentric.minCoeff(), -1e-15) << "point " << i;
    ASSERT_NEAR(curve.points[i].barycentric.sum(), 1, 1e-12) << "point " << i;
    ASSERT_LE((curve.positions[i] - position_of(mesh, curve.points[i])).norm(), 1e-12 * mesh.size()) << "point " << i;
    if (i == 0) continue;
    ASSERT_NE(common_face(mesh, curve.points[i - 1], curve.points[i]), no_index)
        << "points " << i - 1 << " and next share no face";
  }
}

/// The definition of an impact curve: one piece after the other, told apart by lifts and by nothing else; on the
/// surface from point to point between them.
inline void expect_valid(const TriangleMesh& mesh, const ImpactCurve& curve) {
  ASSERT_FALSE(curve.points.empty());
  ASSERT_NE(curve.points.front().kind, MoveKind::lift);
  ASSERT_NE(curve.points.back().kind, MoveKind::lift);
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const ImpactPoint& p = curve.points[i];
    ASSERT_NEAR(p.normal.norm(), 1, 1e-9) << "point " << i;
    const bool before_lift = i > 0 && curve.points[i - 1].kind != MoveKind::lift;
    const bool lift_starts = p.kind == MoveKind::lift && before_lift;
    const Index last_piece = i > 0 ? curve.points[i - 1].piece : 0;
    ASSERT_EQ(p.piece, last_piece + (lift_starts ? 1 : 0)) << "point " << i;
    if (p.kind == MoveKind::lift) {
      // the point where a lift touches down is on the surface, the others are in the air
      const bool touches_down = curve.points[i + 1].kind != MoveKind::lift;
      ASSERT_EQ(p.at.valid(), touches_down) << "point " << i;
    } else {
      ASSERT_TRUE(p.at.valid()) << "point " << i;
      if (i > 0) {
        ASSERT_NE(common_face(mesh, curve.points[i - 1].at, p.at), no_index)
            << name_of(p.kind) << " " << i << " shares no face with the point before";
      }
    }
    if (p.at.valid()) {
      ASSERT_LE((p.position - position_of(mesh, p.at)).norm(), 1e-12 * mesh.size()) << "point " << i;
    }
  }
}

inline Index pieces_of(const ImpactCurve& curve) { return curve.points.back().piece + 1; }

inline int lifts_of(const ImpactCurve& curve) {
  int n = 0;
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    n += curve.points[i].kind == MoveKind::lift && curve.points[i - 1].kind != MoveKind::lift ? 1 : 0;
  }
  return n;
}

/// Appends a curve on the surface, all of one kind; one that goes on starts where the last one ended.
inline void append(ImpactCurve& curve, const SurfaceCurve& stroke, MoveKind kind) {
  for (std::size_t i = curve.points.empty() ? 0 : 1; i < stroke.size(); ++i) {
    curve.points.push_back({kind, stroke.points[i], stroke.positions[i], Vec3::UnitZ(), 0});
  }
}

/// The straight line between two places of a flat mesh.
inline SurfaceCurve line(const SurfaceLinker& linker, const Vec3& from, const Vec3& to) {
  const auto way =
      linker.link(linker.locator().nearest(from).at, linker.locator().nearest(to).at, 2 * (to - from).norm());
  return way.value_or(SurfaceCurve{});
}

/// Lines parallel to y at the given abscissas, from y = 0 to `depth` and back in turn, linked along the boundary.
inline ImpactCurve parallel_lines(const SurfaceLinker& linker, std::span<const double> xs, double depth) {
  ImpactCurve curve;
  Vec3 end = Vec3::Zero();
  for (const double x : xs) {
    const Vec3 start(x, end.y(), 0);
    if (!curve.points.empty()) append(curve, line(linker, end, start), MoveKind::link);
    end = {x, depth - start.y(), 0};
    append(curve, line(linker, start, end), MoveKind::cover);
  }
  return curve;
}

/// True when the point is on the boundary of the mesh.
inline bool on_boundary(const TriangleMesh& mesh, const SurfacePoint& point) {
  const Support support = support_of(mesh, point);
  if (support.kind == Support::Kind::vertex) return mesh.is_boundary_vertex(support.index);
  return support.kind == Support::Kind::edge && mesh.twin(support.index) == no_index;
}

/// A flat disc: a regular polygon around the origin.
inline TriangleMesh flat_disc(int segments, int rings, double radius) {
  return open_cone(segments, rings, radius, radius);
}

}  // namespace isopath::test
