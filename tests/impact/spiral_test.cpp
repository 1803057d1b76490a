#include "isopath/impact/spiral.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "impact/curve_checks.h"
#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/impact/passes.h"
#include "support/stop_at.h"

namespace isopath {
namespace {

using std::numbers::pi;

/// A surface with its distance from the boundary, and the spiral through all its contours.
struct Spiralled {
  TriangleMesh mesh;
  SurfaceLocator locator{mesh};
  SurfaceLinker linker{mesh, locator};
  ExactField field = ExactField::compute(mesh, boundary_source(mesh));
  Passes passes;
  std::vector<const Contour*> contours;
  SurfaceCurve curve;

  Spiralled(TriangleMesh m, double spacing, const Vec3& start, bool inwards = true) : mesh(std::move(m)) {
    passes = choose_passes(mesh, field, spacing, Progress::none());
    if (passes.runs.size() != 1) throw std::runtime_error("the contours are not nested");
    for (const Index c : passes.runs[0].contours) contours.push_back(&passes.contours[c]);
    if (!inwards) std::reverse(contours.begin(), contours.end());
    curve = spiral(linker, field, contours, start);
  }

  double value(std::size_t i) const { return field.value(curve.points[i]); }
  double first_level() const { return contours.front()->level; }
  double last_level() const { return contours.back()->level; }
};

/// From the last point of the first whole ring to the first point of the last one.
struct Stretch {
  std::size_t begin = 0;
  std::size_t end = 0;
};

Stretch between_rings(const Spiralled& s, double tolerance) {
  Stretch stretch;
  while (std::abs(s.value(stretch.begin + 1) - s.first_level()) <= tolerance) ++stretch.begin;
  stretch.end = s.curve.size() - 1;
  while (std::abs(s.value(stretch.end - 1) - s.last_level()) <= tolerance) --stretch.end;
  return stretch;
}

/// The level rises steadily from the first ring to the last, by no more than a spacing in every turn; `slack` is how
/// far it may fall back, or go ahead, at one point.
void expect_steady(const Spiralled& s, double slack) {
  test::expect_on_surface(s.mesh, s.curve);
  const double sign = s.last_level() > s.first_level() ? 1 : -1;
  const Stretch stretch = between_rings(s, 1e-3 * s.passes.spacing);
  ASSERT_LT(stretch.begin, stretch.end);
  EXPECT_GT(stretch.begin, 4u);
  EXPECT_LT(stretch.end + 4, s.curve.size());
  double so_far = s.first_level();
  for (std::size_t i = 0; i < s.curve.size(); ++i) {
    const double value = s.value(i);
    ASSERT_GE(sign * (value - so_far), -slack) << "point " << i << " of " << s.curve.size();
    so_far = sign * std::max(sign * so_far, sign * value);
    ASSERT_LE(sign * (value - s.last_level()), slack) << "point " << i;
  }
}

/// Length of a contour on the surface.
double perimeter(const Spiralled& s, const Contour& contour) {
  return length_of(closed_from(s.mesh, contour, Vec3::Zero()));
}

/// The whole first and last ring, and the mean of the two rings for every turn between them.
double ideal_length(const Spiralled& s) {
  double sum = perimeter(s, *s.contours.front()) + perimeter(s, *s.contours.back());
  for (std::size_t k = 1; k < s.contours.size(); ++k) {
    sum += 0.5 * (perimeter(s, *s.contours[k - 1]) + perimeter(s, *s.contours[k]));
  }
  return sum;
}

GapReport gap_of(const Spiralled& s) {
  ImpactCurve curve;
  test::append(curve, s.curve, MoveKind::cover);
  return measure_gap(s.mesh, curve, s.passes.spacing);
}

TEST(spiral, on_a_disc_is_archimedes_spiral) {
  for (const bool inwards : {true, false}) {
    const Spiralled s(test::flat_disc(120, 10, 20), 2, {15, 12, 0}, inwards);
    ASSERT_EQ(s.contours.size(), 10u);
    expect_steady(s, 5e-3 * s.passes.spacing);
    EXPECT_NEAR(length_of(s.curve), ideal_length(s), 0.01 * ideal_length(s));
    // neighbouring turns are a spacing apart: the radius after one more turn
    std::vector<double> angle{0};
    std::vector<double> radius{s.curve.positions[0].norm()};
    for (std::size_t i = 1; i < s.curve.size(); ++i) {
      const Vec3& a = s.curve.positions[i - 1];
      const Vec3& b = s.curve.positions[i];
      angle.push_back(angle.back() + std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
      radius.push_back(b.norm());
    }
    const double turn = angle.back() > 0 ? 2 * pi : -2 * pi;
    EXPECT_NEAR(angle.back() / turn, 11, 0.05);  // 9 turns between 10 rings, and 2 whole rings
    const auto radius_at = [&](double at) {
      const auto after = std::find_if(angle.begin(), angle.end(), [&](double x) { return (x - at) * turn >= 0; });
      const auto i = static_cast<std::size_t>(after - angle.begin());
      const double t = (at - angle[i - 1]) / (angle[i] - angle[i - 1]);
      return (1 - t) * radius[i - 1] + t * radius[i];
    };
    for (std::size_t i = 0; i < angle.size(); i += 7) {
      if (angle[i] / turn < 1.05 || angle[i] / turn > 8.9) continue;
      EXPECT_NEAR(std::abs(radius_at(angle[i] + turn) - radius[i]), 2, 0.05) << "at turn " << angle[i] / turn;
    }
    const GapReport gap = gap_of(s);
    EXPECT_LE(gap.max, 1.03 * s.passes.spacing);
    EXPECT_NEAR(gap.mean, 0.5 * s.passes.spacing, 0.03 * s.passes.spacing);
  }
}

TEST(spiral, starts_at_the_first_contours_point_nearest_to_the_start) {
  for (const Vec3& start : {Vec3(15, 12, 0), Vec3(-3, 0.1, 0), Vec3(0, -50, 2)}) {
    const Spiralled s(test::flat_disc(60, 6, 10), 1.5, start);
    double nearest = infinity;
    for (const SurfacePoint& p : s.contours[0]->points) {
      nearest = std::min(nearest, (position_of(s.mesh, p) - start).norm());
    }
    EXPECT_NEAR((s.curve.positions[0] - start).norm(), nearest, 1e-12);
  }
}

TEST(spiral, turns_the_way_its_contours_are_walked_and_ends_on_a_whole_ring) {
  const Spiralled s(test::planar_grid(12, 12, 20, 20, {.jitter = 0.2}), 2, {0, 0, 0});
  expect_steady(s, 0.05 * s.passes.spacing);
  EXPECT_NEAR(length_of(s.curve), ideal_length(s), 0.02 * ideal_length(s));
  const Stretch stretch = between_rings(s, 1e-3 * s.passes.spacing);
  SurfaceCurve first;
  for (std::size_t i = 0; i <= stretch.begin; ++i) first.add(s.mesh, s.curve.points[i]);
  SurfaceCurve last;
  for (std::size_t i = stretch.end; i < s.curve.size(); ++i) last.add(s.mesh, s.curve.points[i]);
  const double outer = perimeter(s, *s.contours.front());
  const double inner = perimeter(s, *s.contours.back());
  EXPECT_NEAR(length_of(first), outer, 0.02 * outer);
  EXPECT_NEAR(length_of(last), inner, 0.1 * inner);
}

TEST(spiral, keeps_its_level_across_a_fold) {
  for (const double steep : {0.5, 1.5, 3.0}) {
    SCOPED_TRACE(testing::Message() << "slope " << steep);
    const Spiralled s(test::height_grid(20, 20, 20, 20, [=](double x, double) { return -steep * std::abs(x - 9.7); }),
                      2, {0, 0, 0});
    expect_steady(s, 0.05 * s.passes.spacing);
    EXPECT_NEAR(length_of(s.curve), ideal_length(s), 0.03 * ideal_length(s));
    // the corners of the plate are half a spacing times the root of two from the first ring
    EXPECT_LE(gap_of(s).max, 1.42 * s.passes.spacing);
    EXPECT_GE(gap_of(s).covered_fraction, 0.98);
  }
}

TEST(spiral, covers_a_hemisphere) {
  for (const bool inwards : {true, false}) {
    const Spiralled s(test::hemisphere(16, 64, 20), 2, {0, -20, 0}, inwards);
    expect_steady(s, 1e-2 * s.passes.spacing);
    EXPECT_NEAR(length_of(s.curve), ideal_length(s), 0.01 * ideal_length(s));
    const GapReport gap = gap_of(s);
    EXPECT_LE(gap.max, 1.05 * s.passes.spacing);
    EXPECT_NEAR(gap.mean, 0.5 * s.passes.spacing, 0.03 * s.passes.spacing);
  }
}

TEST(spiral, of_one_contour_is_that_contour) {
  const Spiralled s(test::flat_disc(40, 4, 10), 10, {0, 0, 0});
  ASSERT_EQ(s.contours.size(), 1u);
  test::expect_on_surface(s.mesh, s.curve);
  EXPECT_NEAR(length_of(s.curve), perimeter(s, *s.contours[0]), 1e-9);
  EXPECT_LE((s.curve.positions.front() - s.curve.positions.back()).norm(), 1e-12);
}

TEST(spiral, asks_all_along_whether_to_stop) {
  const Spiralled s(test::hemisphere(10, 40, 20), 2, Vec3(20, 0, 0));
  const auto n = static_cast<long>(s.curve.size());
  ASSERT_GT(n, 100);
  for (const long at : {1L, n / 8, n / 4}) {  // one extension may add several points
    test::StopAt progress(at);
    EXPECT_THROW(spiral(s.linker, s.field, s.contours, Vec3(20, 0, 0), progress), Error) << at;
  }
}

}  // namespace
}  // namespace isopath
