#include "isopath/impact/gap_repair.h"

#include <algorithm>

#include "isopath/contour/contour_graph.h"
#include "isopath/field/value_range.h"
#include "isopath/impact/cover_field.h"

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

/// The contours that loops go along: one level after the other, a spacing apart, from where gaps begin to be too wide;
/// and half a spacing above the last one where the open place goes on beyond.
std::vector<Contour> open_places(const TriangleMesh& mesh, const ExactField& field, double spacing,
                                 Progress& progress) {
  const double first = 0.5 * widest_gap * spacing;
  const ValueRange range = value_range(mesh, field, 0.01 * spacing);
  std::vector<double> levels;
  for (int k = 0; first + 0.5 * k * spacing < range.high; ++k) levels.push_back(first + 0.5 * k * spacing);
  std::vector<Contour> kept;
  if (levels.empty()) return kept;
  ContourSet set = contour_set(mesh, field, levels, {.chord_tolerance = 1e-3 * spacing}, progress);
  for (std::size_t k = 0; k < set.contours.size(); ++k) {
    const auto place = std::lower_bound(levels.begin(), levels.end(), set.contours[k].level) - levels.begin();
    if (place % 2 == 0 || set.graph.children[k].empty()) kept.push_back(std::move(set.contours[k]));
  }
  return kept;
}

}  // namespace

int close_wide_gaps(const SurfaceLinker& linker, const SmoothNormals& normals, double spacing, ImpactCurve& curve,
                    Progress& progress) {
  const TriangleMesh& mesh = linker.mesh();
  const CoverField cover = distance_from_cover(mesh, curve, progress);
  const DetourBuilder builder(mesh, normals, curve, cover);
  std::vector<Detour> detours;
  for (const Contour& contour : open_places(mesh, cover.field, spacing, progress)) {
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
