#include "isopath/field/window.h"

#include <gtest/gtest.h>

#include <random>

namespace isopath {
namespace {

Window point_window(const Vec2& source, double offset) {
  Window w;
  w.end = 1;
  w.source = source;
  w.offset = offset;
  return w;
}

Window line_window(double angle, double offset) {
  Window w = point_window({std::cos(angle), std::sin(angle)}, offset);
  w.kind = Window::Kind::line;
  return w;
}

/// The sign of a - b may change only at a tie.
void expect_ties(const Window& a, const Window& b) {
  const Ties ties = ties_between(a, b, 0, 1);
  double bound[4] = {0, 0, 0, 0};
  for (int i = 0; i < ties.count; ++i) bound[i + 1] = ties.x[i];
  bound[ties.count + 1] = 1;
  for (int part = 0; part <= ties.count; ++part) {
    double lowest = infinity;
    double highest = -infinity;
    for (int k = 0; k <= 50; ++k) {
      const double x = bound[part] + (bound[part + 1] - bound[part]) * k / 50;
      lowest = std::min(lowest, a.distance(x) - b.distance(x));
      highest = std::max(highest, a.distance(x) - b.distance(x));
    }
    EXPECT_TRUE(lowest > -1e-12 || highest < 1e-12) << lowest << ' ' << highest;
  }
}

TEST(Ties, SeparateThePartsOfTwoFronts) {
  for (std::uint64_t seed = 0; seed < 20000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(rng); };
    // Equally old fronts, up to rounding, have almost a double root.
    const double older = seed % 2 == 0 ? uniform(-0.5, 0.5) : std::pow(10.0, uniform(-18, -1));
    const Window a = point_window({uniform(-1, 2), uniform(-1, 0)}, 0.3);
    const Window b = point_window({uniform(-1, 2), uniform(-1, 0)}, 0.3 + older);
    const Window c = line_window(uniform(0.01, 3.1), uniform(0, 1));
    const Window d = line_window(uniform(0.01, 3.1), uniform(0, 1));
    expect_ties(a, b);
    expect_ties(a, c);
    expect_ties(c, d);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(Ties, AreFoundBetweenFrontsThatDifferByARoundingError) {
  for (double older : {1e-17, -1e-17, 3e-16, 0.0}) {
    const Ties ties = ties_between(point_window({0.2, -0.05}, 0), point_window({0.23, -0.1}, older), 0, 1);
    ASSERT_GE(ties.count, 1) << older;
    // Midway: 2 (0.23 - 0.2) x = 0.23^2 + 0.1^2 - 0.2^2 - 0.05^2.
    EXPECT_NEAR(ties.x[0], 0.0204 / 0.06, 1e-12);
  }
}

}  // namespace
}  // namespace isopath
