#pragma once

#include <span>
#include <utility>
#include <vector>

#include "isopath/impact/impact_curve.h"
#include "isopath/impact/surface_curve.h"
#include "isopath/mesh/normals.h"

namespace isopath {

/// Puts covering strokes one after the other and connects them: on the surface where that is short, through the air
/// elsewhere.
class CurveAssembly {
 public:
  struct Limits {
    double longest_link = 0;  ///< mm
    double clearance = 0;     ///< mm
  };
  CurveAssembly(const SurfaceLinker& linker, const SmoothNormals& normals, const Limits& limits)
      : linker_(linker), normals_(normals), limits_(limits) {}

  bool empty() const { return curve_.points.empty(); }
  Vec3 end() const { return curve_.points.back().position; }

  void add_stroke(const SurfaceCurve& stroke);
  /// Goes along a stretch of another curve, all of it on the surface, with the kinds of its moves.
  void add_stretch(std::span<const ImpactPoint> stretch);
  /// Goes on along a curve that is covered already and starts where the last stroke ended.
  void add_link(const SurfaceCurve& way);
  ImpactCurve take() { return std::move(curve_); }
  int blocked_lifts() const { return blocked_lifts_; }

 private:
  void connect(const SurfacePoint& to);
  void append(const SurfacePoint& at, const Vec3& position, MoveKind kind);

  const SurfaceLinker& linker_;
  const SmoothNormals& normals_;
  Limits limits_;
  ImpactCurve curve_;
  Index piece_ = 0;
  int blocked_lifts_ = 0;
};

}  // namespace isopath
