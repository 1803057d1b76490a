#include "isopath/impact/gap_repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "isopath/contour/contour_graph.h"
#include "isopath/core/quiet_progress.h"
#include "isopath/core/side_by_side.h"
#include "isopath/impact/bump.h"
#include "isopath/impact/cover_field.h"
#include "isopath/impact/near_places.h"
#include "isopath/impact/open_spots.h"
#include "isopath/impact/passes.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

/// Loops go along levels of the distance from the cover: the first one so far out, in spacings, then half a spacing on.
constexpr double first_loop = 0.575;
/// Bumps leave nothing as far from the curve as what counts as wide, by so many spacings.
constexpr double bump_margin = 0.005;
/// No place is overlooked that is farther from the curve than half the widest gap and this, in spacings.
constexpr double resolution = 0.01;
/// Spots longer than this, in spacings, are cut in two where one bump does not reach them or adds more than that.
constexpr double shortest_cut = 0.3;
constexpr double short_bump = 0.15;
/// Where they go farther than this from the curve, in spacings, a loop is shorter than bumps side by side.
constexpr double highest_row = 0.9;
/// Of the half circle that a way along both sides of a curve ends with: so many on its radius.
constexpr double points_of_end = 8;
/// Along an open level the curve turns back by a half circle, which rounding leaves as it is.
constexpr double way_back_over_radius = 2.2;
/// What bumps take away beside them the next ones make good; slim ones end the to and fro.
constexpr int rounds_of_broad_bumps = 2;
/// A swell gives what it takes from the other side of the curve; where that is missed, turns end the to and fro.
constexpr int rounds_of_swells = 3;

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

/// The contours that loops go along in the marked faces: one level after the other, a spacing apart, and half a spacing
/// above the last one where the open place goes on beyond.
std::vector<Contour> loops_in(const TriangleMesh& mesh, const ExactField& field, double spacing,
                              std::vector<char> marked, double farthest, Progress& progress) {
  std::vector<double> levels;
  for (double level = first_loop * spacing; level < farthest; level += 0.5 * spacing) levels.push_back(level);
  std::vector<Contour> kept;
  if (levels.empty()) return kept;
  ContourSet set =
      contour_set(mesh, BoundedField(field, marked), levels, {.chord_tolerance = 1e-3 * spacing}, progress);
  const std::vector<char> keep = mark_passes(set, levels);
  for (std::size_t k = 0; k < keep.size(); ++k) {
    const auto& points = set.contours[k].points;
    if (keep[k] &&
        std::any_of(points.begin(), points.end(), [&](const SurfacePoint& p) { return marked[p.face] != 0; }))
      kept.push_back(std::move(set.contours[k]));
  }
  return kept;
}

/// An open curve as it is, but with points closer together within a distance from its ends.
struct MeasuredCurve {
  std::vector<SurfacePoint> points;
  std::vector<double> to_end;  ///< along the curve, to the nearer end
};

MeasuredCurve fine_at_ends(const TriangleMesh& mesh, const std::vector<SurfacePoint>& open, double distance) {
  const auto measured = [&](std::vector<SurfacePoint> points) {
    MeasuredCurve curve{std::move(points), {0}};
    std::vector<double>& to_end = curve.to_end;
    for (std::size_t i = 1; i < curve.points.size(); ++i)
      to_end.push_back(to_end.back() +
                       (position_of(mesh, curve.points[i]) - position_of(mesh, curve.points[i - 1])).norm());
    const double whole = to_end.back();
    for (double& arc : to_end) arc = std::min(arc, whole - arc);
    return curve;
  };
  const MeasuredCurve coarse = measured(open);
  std::vector<SurfacePoint> points{open.front()};
  for (std::size_t i = 1; i < open.size(); ++i) {
    if (std::min(coarse.to_end[i - 1], coarse.to_end[i]) < distance)
      append_between(mesh, open[i - 1], open[i], distance / points_of_end, points);
    points.push_back(open[i]);
  }
  return measured(std::move(points));
}

/// The closed curve around an open one at a distance, from where that begins; half circles close it at both ends.
Contour both_sides_of(const SurfaceLinker& linker, const Contour& open, double distance) {
  const TriangleMesh& mesh = linker.mesh();
  const MeasuredCurve middle = fine_at_ends(mesh, open.points, distance);
  const std::size_t n = middle.points.size();
  SurfaceCurve around;
  const auto add_beside = [&](std::size_t i, double side) {
    const Vec3 along =
        position_of(mesh, middle.points[std::min(i + 1, n - 1)]) - position_of(mesh, middle.points[i > 0 ? i - 1 : 0]);
    const Vec3 aside = mesh.face_normal(middle.points[i].face).cross(along).stableNormalized();
    const double inside = std::max(0.0, 1 - middle.to_end[i] / distance);
    const double beside = distance * std::sqrt(1 - inside * inside);
    const NearestPoint there =
        linker.locator().nearest(position_of(mesh, middle.points[i]) + side * beside * aside, 2 * distance);
    if (there.at.valid()) linker.extend(around, there.at);
  };
  around.add(mesh, middle.points.front());
  for (std::size_t i = 1; i < n; ++i) add_beside(i, -1);
  for (std::size_t i = n - 1; i-- > 0;) add_beside(i, 1);
  linker.extend(around, middle.points.front());
  around.points.pop_back();
  return {.level = open.level, .closed = true, .points = std::move(around.points)};
}

class GapCloser {
 public:
  GapCloser(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactCurve& curve, const GapLimits& limits,
            Progress& progress)
      : linker_(linker), mesh_(linker.mesh()), normals_(normals), curve_(curve), limits_(limits), progress_(progress) {
    double longest = 0;
    for (Index e = 0; e < mesh_.n_edges(); ++e) longest = std::max(longest, mesh_.edge_length(e));
    faces_are_small_ = longest <= limits.spacing;
  }

  /// Looks beside some places first, or everywhere.
  ClosedGaps run(const std::vector<Vec3>* beside) {
    ClosedGaps closed;
    if (beside) closed.unsettled = *beside;
    for (int round = 0; round < limits_.most_rounds; ++round) {
      const bool everywhere = round == 0 && !beside;
      if (!everywhere && closed.unsettled.empty()) break;
      const View view = everywhere ? look_everywhere() : look_beside(closed.unsettled);
      const std::vector<OpenSpot>& spots = view.spots;
      const std::vector<Replacement> changes = bumps_and_loops(view, round);
      closed.unsettled.clear();
      for (const OpenSpot& spot : spots) {
        for (const SpotCell& cell : spot.cells) closed.unsettled.push_back(cell.position);
      }
      if (changes.empty()) break;
      for (const Replacement& change : changes) {
        for (const ImpactPoint& point : change.points) closed.unsettled.push_back(point.position);
      }
      closed.count += replace(mesh_, curve_, changes);
    }
    return closed;
  }

 private:
  struct View {
    CoverField cover;
    std::vector<OpenSpot> spots;
    bool of_parts = false;  ///< the cover holds only moves near the places looked at
  };

  View look_everywhere() {
    CoverField cover = distance_from_cover(mesh_, curve_, limits_.spacing, progress_, limits_.metric);
    std::vector<OpenSpot> spots = open_spots(cover.field, limit(), resolution * limits_.spacing, progress_);
    return {std::move(cover), std::move(spots)};
  }

  /// Bumps and loops change gaps only beside them, and what lies two spacings away has no part in those.
  View look_beside(const std::vector<Vec3>& places) {
    const double w = limits_.spacing;
    const NearPlaces changed(places);
    QuietProgress quiet(progress_);
    // a metric's lengths are not those of places
    const std::vector<char> near = moves_near(changed, 2.5 * w);
    const bool of_parts = limits_.metric == nullptr && has_move(near);
    CoverField cover = of_parts ? distance_from_part_of_cover(mesh_, curve_, near, 2 * w, w, quiet)
                                : distance_from_cover(mesh_, curve_, w, quiet, limits_.metric);
    std::vector<OpenSpot> spots = open_spots(cover.field, limit(), resolution * w, progress_,
                                             of_parts ? OpenSpotsNear{&changed, 1.2 * w} : OpenSpotsNear{});
    return {std::move(cover), std::move(spots), of_parts};
  }

  /// Marks the points of the curve within `reach` of a place, and both ends of moves that pass it.
  std::vector<char> moves_near(const NearPlaces& places, double reach) const {
    const double w = limits_.spacing;
    std::vector<char> marked;
    for (const ImpactPoint& point : curve_.points) marked.push_back(places.any_near(point.position, reach) ? 1 : 0);
    for (std::size_t i = 1; i < marked.size(); ++i) {
      const Vec3& from = curve_.points[i - 1].position;
      const Vec3 way = curve_.points[i].position - from;
      const int parts = static_cast<int>(std::ceil(way.norm() / w));
      if (marked[i - 1] & marked[i] || curve_.points[i].kind != MoveKind::cover) continue;
      for (int k = 1; k < parts; ++k) {
        if (!places.any_near(from + k * way / parts, reach + 0.5 * w)) continue;
        marked[i - 1] = marked[i] = 1;
        break;
      }
    }
    return marked;
  }

  /// Whether a covering move lies between marked points.
  bool has_move(const std::vector<char>& marked) const {
    for (std::size_t i = 1; i < marked.size(); ++i) {
      if (marked[i - 1] & marked[i] && curve_.points[i].kind == MoveKind::cover) return true;
    }
    return false;
  }

  double limit() const { return 0.5 * limits_.widest * limits_.spacing; }

  /// In the form that the limits and the round ask for.
  std::optional<Replacement> bump_to(const OpenSpot& spot, const CoverField& cover, int round) const {
    const BumpLimits limits{limit() - bump_margin * limits_.spacing, limits_.spacing, limits_.radius,
                            round >= rounds_of_broad_bumps, progress_};
    if (limits_.form == GapForm::bumps) return bump_into(linker_, normals_, curve_, cover, spot, limits);
    if (round < rounds_of_swells) {
      if (auto swell = swell_into(linker_, normals_, curve_, cover, spot, limits)) return swell;
    }
    if (limits_.form == GapForm::swells) return std::nullopt;
    return turn_into(linker_, normals_, curve_, cover, spot, limits);
  }

  struct Bumps {
    std::vector<Replacement> changes;
    double added = 0;  ///< infinity where there is no bump
  };

  /// A bump to a spot, or bumps to parts of a long one where these are shorter together or the only ones.
  Bumps bumps_to(const OpenSpot& spot, const CoverField& cover, int round) const {
    progress_.checkpoint();
    const double w = limits_.spacing;
    Bumps whole{{}, infinity};
    if (auto bump = bump_to(spot, cover, round)) whole = {{*bump}, bump->added};
    if (limits_.form != GapForm::bumps || whole.added <= short_bump * w ||
        spot.cells.front().distance > highest_row * w)
      return whole;
    Bumps parts;
    for (const OpenSpot& half : halves_of(spot, shortest_cut * w)) {
      Bumps bumps = bumps_to(half, cover, round);
      parts.added += bumps.added;
      std::move(bumps.changes.begin(), bumps.changes.end(), std::back_inserter(parts.changes));
    }
    return parts.changes.empty() || whole.added <= parts.added ? whole : parts;
  }

  /// Whether bumps are shorter than a loop, which goes along the spot twice, would be, or no loop can be made.
  bool better_than_loop(const Bumps& bumps, const OpenSpot& spot, int round) const {
    if (limits_.form != GapForm::bumps || spot.cells.front().distance <= first_loop * limits_.spacing) return true;
    if (bumps.changes.size() == 1 || (!bumps.changes.empty() && round >= rounds_of_broad_bumps)) return true;
    Box3 box;
    for (const SpotCell& cell : spot.cells) box.extend(cell.position);
    return bumps.added < 2 * box.sizes().maxCoeff();
  }

  std::vector<Replacement> bumps_and_loops(const View& view, int round) {
    const double w = limits_.spacing;
    const CoverField& cover = view.cover;
    std::vector<Replacement> replacements;
    std::vector<char> wide(mesh_.n_faces(), 0);
    double farthest = 0;
    std::vector<Bumps> bumps(view.spots.size());
    all_side_by_side(bumps.size(), [&](std::size_t k) { bumps[k] = bumps_to(view.spots[k], cover, round); });
    for (std::size_t k = 0; k < bumps.size(); ++k) {
      const OpenSpot& spot = view.spots[k];
      if (better_than_loop(bumps[k], spot, round)) {
        std::move(bumps[k].changes.begin(), bumps[k].changes.end(), std::back_inserter(replacements));
        continue;
      }
      farthest = std::max(farthest, spot.cells.front().distance);
      for (const SpotCell& cell : spot.cells) wide[cell.at.face] = 1;
    }
    const auto add_loops = [&](const CoverField& around) {
      const double width = way_back_over_radius * limits_.radius;
      for (const Contour& contour : loops_in(mesh_, around.field, w, std::move(wide), farthest, progress_)) {
        progress_.checkpoint();
        replacements.push_back(detour_along(contour, linker_, normals_, curve_, around, width));
      }
    };
    // in large faces levels of the distance from some of the moves run on where others are nearer
    if (farthest > first_loop * w && view.of_parts && !faces_are_small_) {
      QuietProgress quiet(progress_);
      add_loops(distance_from_cover(mesh_, curve_, w, quiet));
    } else {
      add_loops(cover);
    }
    return replacements;
  }

  const SurfaceLinker& linker_;
  const TriangleMesh& mesh_;
  const SmoothNormals& normals_;
  ImpactCurve& curve_;
  const GapLimits& limits_;
  Progress& progress_;
  bool faces_are_small_ = false;
};

}  // namespace

Replacement detour_along(const Contour& contour, const SurfaceLinker& linker, const SmoothNormals& normals,
                         const ImpactCurve& curve, const CoverField& cover, double width) {
  const TriangleMesh& mesh = linker.mesh();
  if (!contour.closed && width > 0) {
    Contour around = both_sides_of(linker, contour, 0.5 * width);
    if (around.points.size() > 2) return detour_along(around, linker, normals, curve, cover);
  }
  const SurfacePoint& start = contour.points.front();
  std::vector<SurfacePoint> way_back = cover.field.shortest_path(start);
  Replacement detour;
  // asked at the foot: where two ways from the start are equally long, its own nearest root may be the other one's
  detour.first = cover.curve_point[cover.field.nearest(way_back.back()).root];
  detour.last = detour.first + 1;
  const Index piece = curve.points[detour.first].piece;
  const auto add = [&](const SurfacePoint& at, MoveKind kind) {
    detour.points.push_back({kind, at, position_of(mesh, at), normals.at(at), piece});
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

int replace(const TriangleMesh& mesh, ImpactCurve& curve, std::vector<Replacement> replacements) {
  const double tolerance = mesh.tolerance().length;
  // several may lie on one long move
  const auto along_move = [&](Index first, const ImpactPoint& point) {
    return (point.position - curve.points[first].position).norm();
  };
  std::stable_sort(replacements.begin(), replacements.end(), [&](const Replacement& a, const Replacement& b) {
    if (a.first != b.first) return a.first < b.first;
    return std::pair(along_move(a.first, a.points.front()), a.last) <
           std::pair(along_move(b.first, b.points.front()), b.last);
  });
  std::vector<ImpactPoint> points;
  int count = 0;
  Index next = 0;  // the first point not dealt with
  for (const Replacement& r : replacements) {
    const bool same_move = count > 0 && r.first + 1 == next;
    if (r.first + 1 < next ||
        (same_move && along_move(r.first, points.back()) > along_move(r.first, r.points.front()) + tolerance))
      continue;
    points.insert(points.end(), curve.points.begin() + next, curve.points.begin() + r.first + 1);
    points.insert(points.end(), r.points.begin(), r.points.end());
    next = std::max(r.first + 1, r.last);
    ++count;
  }
  points.insert(points.end(), curve.points.begin() + next, curve.points.end());
  curve.points.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool inside = !curve.points.empty() && i + 1 < points.size() && points[i].kind != MoveKind::lift &&
                        points[i + 1].kind != MoveKind::lift;
    // a point that says nothing new goes, unless the way needs it to change faces
    const bool idle = inside && (points[i].position - curve.points.back().position).norm() <= tolerance &&
                      curve.points.back().at.valid() &&
                      common_face(mesh, curve.points.back().at, points[i + 1].at) != no_index;
    if (!idle) curve.points.push_back(points[i]);
  }
  return count;
}

int close_wide_gaps(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactCurve& curve,
                    const GapLimits& limits, Progress& progress) {
  return GapCloser(linker, normals, curve, limits, progress).run(nullptr).count;
}

ClosedGaps close_gaps_everywhere(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactCurve& curve,
                                 const GapLimits& limits, Progress& progress) {
  return GapCloser(linker, normals, curve, limits, progress).run(nullptr);
}

ClosedGaps close_gaps_beside(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactCurve& curve,
                             const std::vector<Vec3>& places, const GapLimits& limits, Progress& progress) {
  return GapCloser(linker, normals, curve, limits, progress).run(&places);
}

}  // namespace isopath
