#include "isopath/impact/gap_repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "impact/curve_checks.h"
#include "isopath/impact/cover_field.h"
#include "isopath/impact/min_radius.h"
#include "isopath/impact/near_places.h"
#include "isopath/impact/open_spots.h"
#include "isopath/impact/ridge_passes.h"
#include "isopath/impact/spot_patch.h"

namespace isopath {
namespace {

bool same(const ImpactPoint& a, const ImpactPoint& b) {
  return a.kind == b.kind && a.at.face == b.at.face && a.at.barycentric == b.at.barycentric &&
         a.position == b.position && a.normal == b.normal && a.piece == b.piece;
}

TEST(gap_repair, leaves_a_curve_without_wide_gaps_as_it_is) {
  const test::Plate plate{test::planar_grid(15, 15, 20, 20, {.jitter = 0.2})};
  const std::vector<double> xs{1, 3, 5, 7, 9, 11, 13, 15, 17, 19};
  ImpactCurve curve = test::parallel_lines(plate.linker, xs, 20);
  const ImpactCurve before = curve;
  EXPECT_EQ(close_wide_gaps(plate.linker, plate.normals, curve, {.spacing = 2}), 0);
  ASSERT_EQ(curve.points.size(), before.points.size());
  for (std::size_t i = 0; i < curve.points.size(); ++i) EXPECT_TRUE(same(curve.points[i], before.points[i]));
}

/// After the repair: no wide gap is left, the curve is in as many pieces as before, and covers what it covered before.
void expect_repaired(const test::Plate& plate, double spacing, const ImpactCurve& before, const ImpactCurve& after) {
  test::expect_valid(plate.mesh, after);
  EXPECT_EQ(test::pieces_of(after), test::pieces_of(before));
  const GapReport was = measure_gap(plate.mesh, before, spacing);
  const GapReport is = measure_gap(plate.mesh, after, spacing);
  EXPECT_GT(was.max, 1.9 * spacing);
  EXPECT_LE(is.max, widest_gap * spacing * 1.005);
  // both are known within the cover field's accuracy, and a gap is twice a distance
  const double known = 4 * cover_accuracy * spacing;
  for (Index v = 0; v < plate.mesh.n_vertices(); ++v) EXPECT_LE(is.vertex_gap[v], was.vertex_gap[v] + known);
  EXPECT_GE(length_of(after, MoveKind::cover), length_of(before, MoveKind::cover) * (1 - 1e-9));
}

TEST(gap_repair, fills_in_for_a_missing_line) {
  const test::Plate plate{test::planar_grid(15, 15, 20, 20, {.jitter = 0.2})};
  const std::vector<double> xs{1, 3, 5, 7, 11, 13, 15, 17, 19};
  const ImpactCurve before = test::parallel_lines(plate.linker, xs, 20);
  ImpactCurve curve = before;
  const int loops = close_wide_gaps(plate.linker, plate.normals, curve, {.spacing = 2});
  // The open strip is 4 wide: one pass more is needed, two at most.
  EXPECT_GE(loops, 1);
  EXPECT_LE(loops, 2);
  expect_repaired(plate, 2, before, curve);
  EXPECT_LE(length_of(curve, MoveKind::cover) - length_of(before, MoveKind::cover), 2 * 20 + 1e-6);
}

TEST(gap_repair, goes_round_and_round_in_a_bare_patch) {
  const test::Plate plate{test::planar_grid(24, 24, 24, 24, {.jitter = 0.2})};
  const std::vector<double> xs{1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23};
  ImpactCurve before;
  Vec3 end = Vec3::Zero();
  for (const double x : xs) {
    const Vec3 start(x, end.y(), 0);
    if (!before.points.empty()) test::append(before, test::line(plate.linker, end, start), MoveKind::link);
    end = {x, 24 - start.y(), 0};
    if (x < 7 || x > 17) {
      test::append(before, test::line(plate.linker, start, end), MoveKind::cover);
    } else {
      // over the patch in the middle the tool passes without effect
      const Vec3 in(x, start.y() < 12 ? 7 : 17, 0);
      const Vec3 out(x, 24 - in.y(), 0);
      test::append(before, test::line(plate.linker, start, in), MoveKind::cover);
      test::append(before, test::line(plate.linker, in, out), MoveKind::link);
      test::append(before, test::line(plate.linker, out, end), MoveKind::cover);
    }
  }
  ImpactCurve curve = before;
  const int loops = close_wide_gaps(plate.linker, plate.normals, curve, {.spacing = 2});
  EXPECT_GE(loops, 2);
  expect_repaired(plate, 2, before, curve);
  // loops are reached over what is covered
  const auto stretches = [](const ImpactCurve& c) {
    int n = 0;
    for (std::size_t i = 1; i < c.points.size(); ++i) {
      n += c.points[i].kind == MoveKind::cover && c.points[i - 1].kind != MoveKind::cover ? 1 : 0;
    }
    return n;
  };
  EXPECT_GE(stretches(curve), stretches(before) + 2);
}

TEST(gap_repair, works_on_a_curved_surface) {
  // A single ring at the equator's half height: both sides of the hemisphere are bare.
  const test::Plate dome{test::hemisphere(12, 48, 20)};
  ImpactCurve curve;
  const SurfaceLinker& linker = dome.linker;
  SurfaceCurve ring;
  for (int k = 0; k <= 48; ++k) linker.extend(ring, point_at_vertex(dome.mesh, 1 + 5 * 48 + k % 48));
  test::append(curve, ring, MoveKind::cover);
  for (ImpactPoint& p : curve.points) p.normal = dome.normals.at(p.at);
  const ImpactCurve before = curve;
  const int loops = close_wide_gaps(linker, dome.normals, curve, {.spacing = 3});
  EXPECT_GE(loops, 8);  // a quarter of a great circle is 31.4 long
  expect_repaired(dome, 3, before, curve);
}

/// Squares one inside the other, `spacing` apart, all around the middle of a plate of side 24.
ImpactCurve nested_squares(const SurfaceLinker& linker, double spacing) {
  ImpactCurve curve;
  Vec3 end = Vec3::Zero();
  for (double in = 0.5 * spacing; in < 12; in += spacing) {
    const std::array<Vec3, 4> corner = {Vec3(in, in, 0), Vec3(24 - in, in, 0), Vec3(24 - in, 24 - in, 0),
                                        Vec3(in, 24 - in, 0)};
    if (!curve.points.empty()) test::append(curve, test::line(linker, end, corner[0]), MoveKind::link);
    for (int i = 0; i < 4; ++i)
      test::append(curve, test::line(linker, corner[i], corner[(i + 1) % 4]), MoveKind::cover);
    end = corner[0];
  }
  return curve;
}

TEST(open_spots, lie_on_the_ridges_of_nested_squares_and_nowhere_else) {
  const test::Plate plate{test::planar_grid(15, 15, 24, 24, {.jitter = 0.2})};
  const double w = 2;
  const ImpactCurve curve = nested_squares(plate.linker, w);
  const CoverField cover = distance_from_cover(plate.mesh, curve, w, Progress::none());
  const double limit = 0.52 * w;
  const double resolution = 0.01 * w;
  const std::vector<OpenSpot> spots = open_spots(cover.field, limit, resolution);
  // on each of four diagonals one at the plate's corner and one between each two of the six squares
  EXPECT_EQ(spots.size(), 4 * 6);
  const double widest_inside = w / (1 + std::sin(std::numbers::pi / 4));  // 2 w / (1 + sin(α/2)) is the gap
  const double widest_at_corner = 0.5 * w * std::numbers::sqrt2;
  for (const OpenSpot& spot : spots) {
    const SpotCell& top = spot.cells.front();
    const double x = std::min(top.position.x(), 24 - top.position.x());
    const double y = std::min(top.position.y(), 24 - top.position.y());
    EXPECT_NEAR(x, y, 2 * top.radius);
    EXPECT_NEAR(top.distance, x < 0.5 * w ? widest_at_corner : widest_inside, top.radius);
    EXPECT_LE(top.radius, 10 * resolution);
    for (const SpotCell& cell : spot.cells) {
      EXPECT_GT(cell.distance, limit);
      EXPECT_LE(cell.distance, top.distance);
    }
  }
  const std::vector<Vec3> corner = {Vec3(0, 0, 0)};
  const NearPlaces near(corner);
  EXPECT_EQ(open_spots(cover.field, limit, resolution, Progress::none(), {&near, 1.2 * w}).size(), 1u);
}

TEST(near_places, finds_what_is_near_and_nothing_else) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const auto place = [&](double size) { return Vec3(size * coordinate(random), size * coordinate(random), 0.1); };
  EXPECT_FALSE(NearPlaces({}).any_near(Vec3::Zero(), 1));
  for (const int count : {1, 4, 5, 300}) {
    std::vector<Vec3> places;
    for (int i = 0; i < count; ++i) places.push_back(i % 3 == 2 ? places.back() : place(1));
    const NearPlaces near(places);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 p = place(1.5);
      double least = infinity;
      for (const Vec3& q : places) least = std::min(least, (q - p).norm());
      const double radius = i % 2 == 0 ? least : std::abs(coordinate(random));
      EXPECT_EQ(near.any_near(p, radius), least <= radius) << count << " places, question " << i;
    }
  }
}

TEST(gap_repair, draws_corners_out_no_farther_than_needed) {
  // faces may be smaller or much larger than the spacing
  for (const Index cells : {15, 1}) {
    SCOPED_TRACE(cells);
    const test::Plate plate{test::planar_grid(cells, cells, 24, 24, {.jitter = 0.2})};
    const double w = 2;
    const ImpactCurve before = nested_squares(plate.linker, w);
    ImpactCurve curve = before;
    EXPECT_GE(close_wide_gaps(plate.linker, plate.normals, curve, {.spacing = w}), 4 * 6);
    test::expect_valid(plate.mesh, curve);
    EXPECT_EQ(length_of(curve, MoveKind::link), length_of(before, MoveKind::link)) << "bumps cover, and need no links";
    const CoverField cover = distance_from_cover(plate.mesh, curve, w, Progress::none());
    EXPECT_TRUE(open_spots(cover.field, 0.5 * (widest_gap + 0.02) * w, 0.002 * w).empty());
    // A tip d outside a corner covers the ridge when (w - d sin 45°) / (1 + sin 45°) = 0.51 w: d = 0.18 w, there and
    // back no longer than 0.37 w; at the plate's corners, where all of √2/2 - 0.5 is missing, half a spacing and more.
    const double added = length_of(curve, MoveKind::cover) - length_of(before, MoveKind::cover);
    EXPECT_LE(added, 4 * (5 * 0.37 + 0.6) * w);
    EXPECT_GE(added, 4 * 5 * 0.1 * w);
  }
}

TEST(gap_repair, swells_a_round_curve_without_turning_it_back) {
  const test::Plate plate{test::planar_grid(15, 15, 24, 24, {.jitter = 0.2})};
  const double w = 2;
  const double radius = 0.08 * w;
  ImpactCurve curve = nested_squares(plate.linker, w);
  close_wide_gaps(plate.linker, plate.normals, curve, {.spacing = w, .radius = radius});
  const auto tight_before = keep_min_radius(plate.linker, plate.normals, curve,
                                            1.5 * radius);  // more than bumps were made for: this opens spots
  const CoverField cover = distance_from_cover(plate.mesh, curve, w, Progress::none());
  ASSERT_FALSE(open_spots(cover.field, 0.5 * widest_gap * w, 0.01 * w).empty());
  const double length_before = length_of(curve, MoveKind::cover);
  const int changes =
      close_wide_gaps(plate.linker, plate.normals, curve, {.spacing = w, .radius = radius, .form = GapForm::round});
  ASSERT_GT(changes, 0);
  test::expect_valid(plate.mesh, curve);
  EXPECT_LE(measure_gap(plate.mesh, curve, w).max, (widest_gap + 0.02) * w);
  // h cos² over a width of 2 b is longer than straight on by π² h² / 8 b at most; a full turn by 2 π radius
  EXPECT_LT(length_of(curve, MoveKind::cover) - length_before, changes * 0.25 * 2 * std::numbers::pi * radius);
  int elsewhere = 0;
  for (const TightPlace& tight : tight_places(plate.mesh, curve, 0.9 * radius)) {
    // the plate's corners are out of reach for swells, and full turns there meet the curve near a bend
    const Vec3 from_middle = (tight.position - Vec3(12, 12, 0)).cwiseAbs();
    const bool at_corner = (from_middle - Vec3(12, 12, 0)).norm() < 1.5 * w;
    const bool was = std::any_of(tight_before.begin(), tight_before.end(), [&](const TightPlace& before) {
      return (before.position - tight.position).norm() < radius;
    });
    elsewhere += at_corner || was ? 0 : 1;
  }
  // beside another swell there may be room for a full turn only
  EXPECT_LE(elsewhere, 0.05 * changes);
}

/// A plate of side 20 and passes on it, folded at x = 10 so that its halves stand that angle apart; flat for π.
struct FoldedPlate {
  FoldedPlate(double angle, const std::vector<double>& xs) : plate{folded(angle)} {
    const test::Plate flat{test::planar_grid(20, 15, 20, 20)};
    curve = test::parallel_lines(flat.linker, xs, 20);
    for (ImpactPoint& p : curve.points) {
      p.position = position_of(plate.mesh, p.at);
      p.normal = plate.normals.at(p.at);
    }
  }

  static TriangleMesh folded(double angle) {
    const TriangleMesh flat = test::planar_grid(20, 15, 20, 20);
    TriangleSoup soup;
    for (Index v = 0; v < flat.n_vertices(); ++v) {
      const Vec3& p = flat.position(v);
      const double beyond = std::max(0.0, p.x() - 10);
      soup.positions.emplace_back(std::min(p.x(), 10.0) - beyond * std::cos(angle), p.y(), beyond * std::sin(angle));
    }
    for (Index f = 0; f < flat.n_faces(); ++f) soup.triangles.push_back(flat.triangle(f));
    return TriangleMesh(std::move(soup));
  }

  test::Plate plate;
  ImpactCurve curve;
};

constexpr double fold_angles[] = {std::numbers::pi, 2.0, 0.9, 0.05, 0.002};
/// The strip in the middle is wider than it should be, but not wide enough for a loop.
const std::vector<double> with_a_wide_strip{1, 3, 5, 7, 8.9, 11.1, 13, 15, 17, 19};

TEST(gap_repair, closes_a_long_narrow_gap_along_a_fold_by_many_small_bumps) {
  for (const double angle : fold_angles) {
    SCOPED_TRACE(testing::Message() << "angle " << angle);
    FoldedPlate folded(angle, with_a_wide_strip);
    const double w = 2;
    const ImpactCurve before = folded.curve;
    ASSERT_NEAR(measure_gap(folded.plate.mesh, before, w).max, 1.1 * w, 0.01 * w);
    EXPECT_GT(close_wide_gaps(folded.plate.linker, folded.plate.normals, folded.curve, {.spacing = w}), 5);
    test::expect_valid(folded.plate.mesh, folded.curve);
    EXPECT_LE(measure_gap(folded.plate.mesh, folded.curve, w).max, widest_gap * w * 1.005);
    EXPECT_EQ(length_of(folded.curve, MoveKind::link), length_of(before, MoveKind::link));
    // A pass more would add 20. A tip every 0.3 w, 0.07 w high on a base of 0.12 w: 0.21 of that.
    EXPECT_LT(length_of(folded.curve, MoveKind::cover) - length_of(before, MoveKind::cover), 0.4 * 20);
  }
}

TEST(spot_patch, measures_along_the_surface) {
  for (const double angle : fold_angles) {
    SCOPED_TRACE(testing::Message() << "angle " << angle);
    const FoldedPlate folded(angle, with_a_wide_strip);
    const TriangleMesh& mesh = folded.plate.mesh;
    const CoverField cover = distance_from_cover(mesh, folded.curve, 2, Progress::none());
    const std::vector<OpenSpot> spots = open_spots(cover.field, 0.515 * 2, 0.02);
    ASSERT_GE(spots.size(), 1u);  // all along the fold
    SurfaceCurve way;
    for (const ImpactPoint& p : folded.curve.points) {
      const double y = p.position.y();
      if (p.kind == MoveKind::cover && std::abs(y - 10) < 3 && (way.empty() || y != way.positions.back().y()))
        way.add(mesh, p.at);
      if (!way.empty() && std::abs(y - 10) >= 3) break;
    }
    ASSERT_GT(way.size(), 2u);
    SourceSet source;
    source.add_polyline(mesh, way.points, false);
    const ExactField field = ExactField::compute(mesh, source);
    // the first pass is some way off
    for (const double reach : {1.0, 30.0}) {
      const SpotPatch patch(mesh, spots.front(), reach, Progress::none());
      EXPECT_EQ(patch.nearly_flat(), angle == std::numbers::pi);
      const std::vector<double> distances = patch.distances_from(way);
      ASSERT_EQ(distances.size(), spots.front().cells.size());
      for (std::size_t k = 0; k < distances.size(); ++k) {
        const double exact = field.value(spots.front().cells[k].at);
        if (exact <= 1.5 * reach) {
          EXPECT_NEAR(distances[k], exact, 2e-3 * reach);
        } else {
          EXPECT_GT(distances[k], 1.4 * reach);
        }
      }
    }
  }
}

TEST(open_spots, are_cut_in_two_with_all_their_cells) {
  const FoldedPlate folded(std::numbers::pi, with_a_wide_strip);
  const CoverField cover = distance_from_cover(folded.plate.mesh, folded.curve, 2, Progress::none());
  const std::vector<OpenSpot> spots = open_spots(cover.field, 0.515 * 2, 0.02);
  ASSERT_EQ(spots.size(), 1u);
  const std::vector<OpenSpot> halves = halves_of(spots.front(), 1);
  ASSERT_EQ(halves.size(), 2u);
  EXPECT_EQ(halves[0].cells.size() + halves[1].cells.size(), spots.front().cells.size());
  for (const SpotCell& a : halves[0].cells) EXPECT_LT(a.position.y(), 10 + 1e-9);
  for (const SpotCell& b : halves[1].cells) EXPECT_GT(b.position.y(), 10 - 1e-9);
  for (const OpenSpot& half : halves) {
    for (const SpotCell& cell : half.cells) EXPECT_LE(cell.distance, half.cells.front().distance);
  }
  EXPECT_TRUE(halves_of(spots.front(), 21).empty());
}

TEST(gap_repair, sees_with_each_round_what_the_whole_field_shows) {
  // far from the source the distance from a part of the curve is not that from the whole one: only near its moves
  const test::Plate plate{test::planar_grid(24, 24, 24, 24, {.jitter = 0.2})};
  const double w = 2;
  const ImpactCurve curve = nested_squares(plate.linker, w);
  const CoverField whole = distance_from_cover(plate.mesh, curve, w, Progress::none());
  const Vec3 place(1, 1, 0);
  std::vector<char> near;
  for (const ImpactPoint& p : curve.points) near.push_back((p.position - place).norm() < 2.5 * w ? 1 : 0);
  const CoverField part = distance_from_part_of_cover(plate.mesh, curve, near, 2 * w, w, Progress::none());
  for (Index v = 0; v < plate.mesh.n_vertices(); ++v) {
    if ((plate.mesh.position(v) - place).norm() > 1.2 * w) continue;
    EXPECT_NEAR(part.field.value_at_vertex(v), whole.field.value_at_vertex(v), 2 * cover_accuracy * w);
  }
}

TEST(gap_repair, goes_out_and_back_on_both_sides_of_an_open_level) {
  const test::Plate plate{test::planar_grid(15, 15, 20, 20, {.jitter = 0.2})};
  const std::vector<double> xs{1, 3};
  const ImpactCurve curve = test::parallel_lines(plate.linker, xs, 20);
  const CoverField cover = distance_from_cover(plate.mesh, curve, 2, Progress::none());
  Contour open;
  for (const SurfacePoint& p : test::line(plate.linker, Vec3(5, 4, 0), Vec3(5, 14, 0)).points) open.points.push_back(p);
  const double width = 0.3;
  const Replacement detour = detour_along(open, plate.linker, plate.normals, curve, cover, width);
  double covered = 0;
  for (std::size_t i = 1; i < detour.points.size(); ++i) {
    const ImpactPoint& p = detour.points[i];
    const double step = (p.position - detour.points[i - 1].position).norm();
    if (p.kind != MoveKind::cover) {
      EXPECT_NEAR(p.position.y(), 4, 4 * cover_accuracy) << "a link anywhere but between the curve and the level";
      continue;
    }
    covered += step;
    // half a width from a middle line that ends half a width before the level does, as half circles do
    const Vec3 nearest(5, std::clamp(p.position.y(), 4 + 0.5 * width, 14 - 0.5 * width), 0);
    EXPECT_NEAR((p.position - nearest).norm(), 0.5 * width, 0.06 * width);
  }
  EXPECT_NEAR(covered, 2 * (10 - width) + std::numbers::pi * width, 0.02 * width);
}

TEST(ridge_passes, cover_a_ridge_in_one_go) {
  const test::Plate plate{test::planar_grid(15, 15, 20, 20, {.jitter = 0.2})};
  const std::vector<double> xs{1, 3, 5, 7, 8.5, 11.5, 13, 15, 17, 19};
  const ImpactCurve before = test::parallel_lines(plate.linker, xs, 20);
  const auto at = [&](double x, double y) { return plate.locator.nearest(Vec3(x, y, 0)).at; };
  ImpactCurve curve = before;
  // the second one lies on a pass
  const std::vector<std::vector<SurfacePoint>> ridges{{at(10, 0), at(10, 12), at(10, 20)}, {at(3, 0), at(3, 20)}};
  EXPECT_EQ(add_ridge_passes(plate.linker, plate.normals, ridges, curve, {.spacing = 2}), 1);
  test::expect_valid(plate.mesh, curve);
  EXPECT_EQ(test::pieces_of(curve), test::pieces_of(before));
  // a hairpin that is a spacing wide, with half circles at its ends
  EXPECT_NEAR(length_of(curve, MoveKind::cover) - length_of(before, MoveKind::cover),
              2 * (20 - 2) + 2 * std::numbers::pi, 0.05);
  // to the ridge and back
  EXPECT_NEAR(length_of(curve, MoveKind::link) - length_of(before, MoveKind::link), 1.5 + 1.5, 1e-6);
  EXPECT_GT(measure_gap(plate.mesh, before, 2).max, 2.9);
  EXPECT_LT(measure_gap(plate.mesh, curve, 2).max, 2.01);
}

TEST(ridge_passes, leave_ridges_without_wide_gaps) {
  const test::Plate plate{test::planar_grid(15, 15, 20, 20)};
  const std::vector<double> xs{1, 3, 5, 7, 9, 11, 13, 15, 17, 19};
  ImpactCurve curve = test::parallel_lines(plate.linker, xs, 20);
  const std::size_t points = curve.points.size();
  const std::vector<std::vector<SurfacePoint>> ridges{
      {plate.locator.nearest(Vec3(0, 0, 0)).at, plate.locator.nearest(Vec3(20, 20, 0)).at}};
  EXPECT_EQ(add_ridge_passes(plate.linker, plate.normals, ridges, curve, {.spacing = 2}), 0);
  EXPECT_EQ(curve.points.size(), points);
}

}  // namespace
}  // namespace isopath
