#include "isopath/impact/gap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "impact/curve_checks.h"
#include "isopath/core/error.h"
#include "support/random_sources.h"
#include "support/slow_exact.h"

namespace isopath {
namespace {

std::vector<double> every(double spacing, double from, double to) {
  std::vector<double> xs;
  for (double x = from + spacing / 2; x < to; x += spacing) xs.push_back(x);
  return xs;
}

void expect_shares(const GapReport& report) {
  EXPECT_NEAR(std::accumulate(report.histogram.begin(), report.histogram.end(), 0.0), 1, 1e-12);
  for (const double share : report.histogram) EXPECT_GE(share, 0);
  EXPECT_LE(report.p99, report.max);
  EXPECT_LE(report.mean, report.max);
}

TEST(gap, between_parallel_lines_is_known_everywhere) {
  const test::Plate plate{test::planar_grid(13, 7, 20, 10, {.jitter = 0.2})};
  for (const double w : {0.5, 1.0, 2.0}) {
    const ImpactCurve curve = test::parallel_lines(plate.linker, every(w, 0, 20), 10);
    test::expect_valid(plate.mesh, curve);
    const GapReport report = measure_gap(plate.mesh, curve, w);
    EXPECT_NEAR(report.max, w, 0.02 * w);
    EXPECT_NEAR(report.mean, w / 2, 0.01 * w);
    EXPECT_NEAR(report.cv, 1 / std::sqrt(3.0), 0.01);
    EXPECT_NEAR(report.p99, 0.99 * w, 0.02 * w);
    EXPECT_NEAR(report.covered_fraction, 1, 1e-12);
    EXPECT_NEAR(report.area, 200, 1e-9);
    expect_shares(report);
    // The gap is spread evenly between 0 and the spacing: 20 bins of equal share, sampled at a sixth of a spacing.
    for (int fifth = 0; fifth < 5; ++fifth) {
      double share = 0;
      for (int k = 4 * fifth; k < 4 * fifth + 4; ++k) share += report.histogram[k];
      EXPECT_NEAR(share, 0.2, 0.03) << "fifth " << fifth;
    }
    for (Index v = 0; v < plate.mesh.n_vertices(); ++v) {
      const double x = plate.mesh.position(v).x();
      const double to_line = std::abs(std::remainder(x - w / 2, w));
      EXPECT_NEAR(report.vertex_gap[v], 2 * to_line, 1e-9) << "vertex " << v;
    }
  }
}

TEST(gap, of_a_plate_covered_by_half_says_so) {
  const test::Plate plate{test::planar_grid(10, 5, 20, 10)};
  const double w = 1;
  const GapReport report = measure_gap(plate.mesh, test::parallel_lines(plate.linker, every(w, 0, 10), 10), w);
  // The last line is at 9.5; a gap of 1.02 spacings is reached at 9.5 + 0.51.
  EXPECT_NEAR(report.covered_fraction, 10.01 / 20, 0.01);
  EXPECT_NEAR(report.max, 2 * 10.5, 1e-9);
  EXPECT_NEAR(report.p99, 2 * 10.3, 0.1);                // 1 % of the plate is 0.2 wide
  EXPECT_NEAR(report.histogram.back(), 9.5 / 20, 0.01);  // wider than 2 spacings, from 9.5 + 1 on
  expect_shares(report);
}

TEST(gap, at_vertices_is_twice_the_exact_distance) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    test::Rng rng(seed);
    const TriangleMesh mesh = test::random_mesh(rng, {.max_faces = 24, .closed = seed % 3 == 0});
    ImpactCurve curve;
    SourceSet source;
    for (int stretch = 0; stretch < 2; ++stretch) {
      const std::vector<SurfacePoint> points = test::random_polyline(rng, mesh, 5);
      if (points.size() < 2) continue;
      source.add_polyline(mesh, points, false);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const MoveKind kind = i == 0 && !curve.points.empty() ? MoveKind::lift : MoveKind::cover;
        curve.points.push_back({kind, points[i], position_of(mesh, points[i]), Vec3::UnitZ(), stretch});
      }
    }
    if (source.empty()) continue;
    const test::SlowExact judge(mesh, source.elements());
    const GapReport report = measure_gap(mesh, curve, 0.3 * mesh.size());
    ASSERT_EQ(report.vertex_gap.size(), static_cast<std::size_t>(mesh.n_vertices()));
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      const double exact = 2 * judge.vertex_distances()[v];
      if (exact == infinity) {
        EXPECT_EQ(report.vertex_gap[v], infinity) << "seed " << seed << " vertex " << v;
      } else {
        EXPECT_NEAR(report.vertex_gap[v], exact, 1e-9 * mesh.size()) << "seed " << seed << " vertex " << v;
      }
    }
  }
}

TEST(gap, is_infinite_where_no_pass_reaches) {
  const test::Plate plate{test::planar_cells(5, 2, [](int i, int) { return i != 2; })};  // two plates, 1 apart
  ImpactCurve curve;
  test::append(curve, test::line(plate.linker, {1, 0, 0}, {1, 2, 0}), MoveKind::cover);
  const GapReport report = measure_gap(plate.mesh, curve, 2);
  EXPECT_EQ(report.max, infinity);
  EXPECT_EQ(report.mean, infinity);
  EXPECT_EQ(report.cv, infinity);
  EXPECT_NEAR(report.covered_fraction, 0.5, 1e-12);
}

TEST(gap, counts_covering_moves_only) {
  const test::Plate plate{test::planar_grid(20, 10, 20, 10)};
  // A line at x = 2, a link along the boundary and across at x = 18, a lift from there.
  ImpactCurve curve;
  test::append(curve, test::line(plate.linker, {2, 0, 0}, {2, 10, 0}), MoveKind::cover);
  test::append(curve, test::line(plate.linker, {2, 10, 0}, {18, 10, 0}), MoveKind::link);
  test::append(curve, test::line(plate.linker, {18, 10, 0}, {18, 0, 0}), MoveKind::link);
  curve.points.push_back({MoveKind::lift, {}, {10, 5, 3}, Vec3::UnitZ(), 1});
  const SurfaceCurve last = test::line(plate.linker, {4, 0, 0}, {4, 10, 0});
  curve.points.push_back({MoveKind::lift, last.points[0], last.positions[0], Vec3::UnitZ(), 1});
  test::append(curve, last, MoveKind::cover);
  for (ImpactPoint& p : curve.points) p.piece = 0;
  const GapReport report = measure_gap(plate.mesh, curve, 2);
  for (Index v = 0; v < plate.mesh.n_vertices(); ++v) {
    const double x = plate.mesh.position(v).x();
    EXPECT_NEAR(report.vertex_gap[v], 2 * std::min(std::abs(x - 2), std::abs(x - 4)), 1e-9);
  }
}

TEST(gap, needs_a_spacing_and_a_covering_move) {
  const test::Plate plate{test::planar_grid(2, 2, 2, 2)};
  const ImpactCurve curve = test::parallel_lines(plate.linker, std::vector{1.0}, 2);
  for (const double spacing : {0.0, -1.0, std::nan(""), infinity}) {
    try {
      measure_gap(plate.mesh, curve, spacing);
      ADD_FAILURE() << "spacing " << spacing;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_usage);
      EXPECT_EQ(error.where().element, "spacing");
    }
  }
  try {
    measure_gap(plate.mesh, {}, 1);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::no_plan);
  }
}

}  // namespace
}  // namespace isopath
