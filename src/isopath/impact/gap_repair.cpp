#include "isopath/impact/gap_repair.h"

#include <algorithm>

#include "isopath/contour/contour_graph.h"
#include "isopath/field/value_range.h"
#include "isopath/impact/cover_field.h"
#include "isopath/impact/passes.h"

namespace isopath {
namespace {

/// A way out of the curve and back, starting and ending at its foot between point `after` of the curve and the next
/// one.
struct Detour {
  Index after = 0;
  std::vector<ImpactPoint> points;
};

class DetourBuilder {
 public:
  DetourBuilder(const TriangleMesh& mesh, const SmoothNormals& normals, const ImpactCurve& curve,
                const CoverField& cover)
      : mesh_(mesh), normals_(normals), curve_(curve), cover_(cover) {}

  Detour around(const Contour& contour) const {
    const SurfacePoint& start = contour.points.front();
    std::vector<SurfacePoint> way_back = cover_.field.shortest_path(start);
    Detour detour;
    // asked at the foot: where two ways from the start are equally long, its own nearest root may be the other one's
    detour.after = cover_.curve_point[cover_.field.nearest(way_back.back()).root];
    const Index piece = curve_.points[detour.after].piece;
    const auto add = [&](const SurfacePoint& at, MoveKind kind) {
      detour.points.push_back({kind, at, position_of(mesh_, at), normals_.at(at), piece});
    };
    add(way_back.back(), MoveKind::cover);  // on the curve itself
    for (auto p = way_back.rbegin() + 1; p != way_back.rend(); ++p) add(*p, MoveKind::link);
    for (std::size_t i = 1; i < contour.points.size(); ++i) add(contour.points[i], MoveKind::cover);
    if (contour.closed) {
      add(start, MoveKind::cover);
    } else {
      for (std::size_t i = contour.points.size() - 1; i-- > 0;) add(contour.points[i], MoveKind::link);
    }
    for (std::size_t i = 1; i < way_back.size(); ++i) add(way_back[i], MoveKind::link);
    return detour;
  }

 private:
  const TriangleMesh& mesh_;
  const SmoothNormals& normals_;
  const ImpactCurve& curve_;
  const CoverField& cover_;
};

/// The distance from the cover, with what is known of where it stays below a level: no isoline hides in those faces.
class BoundedField final : public SurfaceFunction {
 public:
  BoundedField(const ExactField& field, std::vector<char> may_reach)
      : field_(field), may_reach_(std::move(may_reach)) {}

  double value_at_vertex(Index vertex) const override { return field_.value_at_vertex(vertex); }
  double value(const SurfacePoint& point) const override { return field_.value(point); }
  Slope slope(const SurfacePoint& point) const override { return field_.slope(point); }
  void edge_crossings(Index edge, double level, std::vector<double>& parameters) const override {
    field_.edge_crossings(edge, level, parameters);
  }
  bool linear_in_faces() const override { return false; }
  bool monotone_in_face(Index face) const override { return !may_reach_[face] || field_.monotone_in_face(face); }
  double max_slope() const override { return field_.max_slope(); }

 private:
  const ExactField& field_;
  std::vector<char> may_reach_;
};

/// The contours that loops go along: one level after the other, a spacing apart, from where gaps begin to be too wide;
/// and half a spacing above the last one where the open place goes on beyond.
std::vector<Contour> open_places(const TriangleMesh& mesh, const ExactField& field, double spacing,
                                 Progress& progress) {
  std::vector<double> levels;
  std::vector<char> wide;  // the faces that the lowest level may lie in
  for (double level = 0.5 * widest_gap * spacing;; level += 0.5 * spacing) {
    std::vector<char> may_reach = faces_that_may_reach(mesh, field, level, progress);
    if (std::find(may_reach.begin(), may_reach.end(), 1) == may_reach.end()) break;
    if (levels.empty()) wide = std::move(may_reach);
    levels.push_back(level);
  }
  std::vector<Contour> kept;
  if (levels.empty()) return kept;
  ContourSet set =
      contour_set(mesh, BoundedField(field, std::move(wide)), levels, {.chord_tolerance = 1e-3 * spacing}, progress);
  const std::vector<char> keep = mark_passes(set, levels);
  for (std::size_t k = 0; k < keep.size(); ++k) {
    if (keep[k]) kept.push_back(std::move(set.contours[k]));
  }
  return kept;
}

}  // namespace

int close_wide_gaps(const SurfaceLinker& linker, const SmoothNormals& normals, double spacing, ImpactCurve& curve,
                    Progress& progress, const IntrinsicGeometry* metric) {
  const TriangleMesh& mesh = linker.mesh();
  const CoverField cover = distance_from_cover(mesh, curve, spacing, progress, metric);
  const DetourBuilder builder(mesh, normals, curve, cover);
  std::vector<Detour> detours;
  for (const Contour& contour : open_places(mesh, cover.field, spacing, progress)) {
    progress.checkpoint();
    detours.push_back(builder.around(contour));
  }
  if (detours.empty()) return 0;
  std::stable_sort(detours.begin(), detours.end(), [](const Detour& a, const Detour& b) { return a.after < b.after; });
  ImpactCurve whole;
  std::size_t next = 0;
  for (Index i = 0; i < static_cast<Index>(curve.points.size()); ++i) {
    whole.points.push_back(curve.points[i]);
    for (; next < detours.size() && detours[next].after == i; ++next) {
      whole.points.insert(whole.points.end(), detours[next].points.begin(), detours[next].points.end());
    }
  }
  curve = std::move(whole);
  return static_cast<int>(detours.size());
}

}  // namespace isopath
