#include "isopath/impact/gap_repair.h"

#include <gtest/gtest.h>

#include <vector>

#include "impact/curve_checks.h"
#include "isopath/impact/cover_field.h"

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
  EXPECT_EQ(close_wide_gaps(plate.linker, plate.normals, 2, curve, Progress::none()), 0);
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
  const int loops = close_wide_gaps(plate.linker, plate.normals, 2, curve, Progress::none());
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
  const int loops = close_wide_gaps(plate.linker, plate.normals, 2, curve, Progress::none());
  EXPECT_GE(loops, 2);
  expect_repaired(plate, 2, before, curve);
  // as many covering stretches more as loops
  const auto stretches = [](const ImpactCurve& c) {
    int n = 0;
    for (std::size_t i = 1; i < c.points.size(); ++i) {
      n += c.points[i].kind == MoveKind::cover && c.points[i - 1].kind != MoveKind::cover ? 1 : 0;
    }
    return n;
  };
  EXPECT_GE(stretches(curve), stretches(before) + loops);
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
  const int loops = close_wide_gaps(linker, dome.normals, 3, curve, Progress::none());
  EXPECT_GE(loops, 8);  // a quarter of a great circle is 31.4 long
  expect_repaired(dome, 3, before, curve);
}

}  // namespace
}  // namespace isopath
