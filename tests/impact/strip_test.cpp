#include "isopath/impact/strip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "isopath/core/error.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

std::vector<Vec3> random_polyline(test::Rng& rng, int n) {
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) {
    points.emplace_back(test::random_real(rng, 0, 1), test::random_real(rng, 0, 1), test::random_real(rng, 0, 0.3));
  }
  return points;
}

struct Problem {
  std::vector<Vec3> p;
  std::vector<Vec3> q;
  double gap = 0;
  double longest = infinity;

  double rung(std::size_t i, std::size_t j) const {
    const double chord = (p[i] - q[j]).norm();
    return chord > longest ? infinity : std::max(chord, gap);
  }

  /// The least sum of rungs by dynamic programming; infinity when there is no way.
  double least() const {
    std::vector<std::vector<double>> best(p.size(), std::vector<double>(q.size(), infinity));
    for (std::size_t i = 0; i < p.size(); ++i) {
      for (std::size_t j = 0; j < q.size(); ++j) {
        double before = i == 0 && j == 0 ? 0 : infinity;
        if (i > 0) before = std::min(before, best[i - 1][j]);
        if (j > 0) before = std::min(before, best[i][j - 1]);
        best[i][j] = before + rung(i, j);
      }
    }
    return best.back().back();
  }
};

void expect_monotone(const Strip& strip, const Problem& problem) {
  ASSERT_EQ(strip.size(), problem.p.size() + problem.q.size() - 1);
  EXPECT_EQ(strip.front(), std::make_pair(Index{0}, Index{0}));
  EXPECT_EQ(strip.back(),
            std::make_pair(static_cast<Index>(problem.p.size() - 1), static_cast<Index>(problem.q.size() - 1)));
  for (std::size_t k = 1; k < strip.size(); ++k) {
    const Index di = strip[k].first - strip[k - 1].first;
    const Index dj = strip[k].second - strip[k - 1].second;
    EXPECT_TRUE((di == 1 && dj == 0) || (di == 0 && dj == 1)) << "step " << k;
  }
}

TEST(strip, has_the_least_total_rung_length_of_all_monotone_ways) {
  int without = 0;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    test::Rng rng(seed);
    Problem problem;
    problem.p = random_polyline(rng, 1 + test::random_index(rng, 9));
    problem.q = random_polyline(rng, 1 + test::random_index(rng, 9));
    problem.gap = test::random_real(rng, 0, 0.4);
    if (seed % 2 == 0) problem.longest = test::random_real(rng, 0.3, 1.2);
    const Strip strip = least_strip(problem.p, problem.q, problem.gap, problem.longest);
    const double least = problem.least();
    if (least == infinity) {
      ++without;
      EXPECT_TRUE(strip.empty()) << "seed " << seed;
      continue;
    }
    ASSERT_FALSE(strip.empty()) << "seed " << seed;
    expect_monotone(strip, problem);
    double sum = 0;
    for (const auto& [i, j] : strip) sum += problem.rung(i, j);
    EXPECT_NEAR(sum, least, 1e-12 * least) << "seed " << seed;
  }
  EXPECT_GT(without, 50) << "the limit on the length of rungs was hardly tried";
}

TEST(strip, between_concentric_circles_runs_along_the_radii) {
  const int n = 90;
  Problem problem;
  for (int i = 0; i <= n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    problem.p.emplace_back(10 * std::cos(angle), 10 * std::sin(angle), 0);
    problem.q.emplace_back(9 * std::cos(angle), 9 * std::sin(angle), 0);
  }
  const Strip strip = least_strip(problem.p, problem.q, 1, 6);
  expect_monotone(strip, problem);
  for (const auto& [i, j] : strip) EXPECT_LE(std::abs(i - j), 1);
}

/// Two straight lines side by side, with so many points each.
Problem ladder(int n) {
  Problem problem;
  problem.gap = 1;
  problem.longest = 1.2;
  for (int i = 0; i < n; ++i) {
    problem.p.emplace_back(0.5 * i, 0, 0);
    problem.q.emplace_back(0.5 * i, 1, 0);
  }
  return problem;
}

TEST(strip, of_long_polylines_fits_into_memory) {
  // all pairs of points would be 4e10
  const Problem problem = ladder(200000);
  const Strip strip = least_strip(problem.p, problem.q, problem.gap, problem.longest);
  expect_monotone(strip, problem);
  for (const auto& [i, j] : strip) ASSERT_LE(std::abs(i - j), 1);
}

TEST(strip, stops_on_request) {
  class Stop final : public Progress {
    bool cancelled() const override { return true; }
  } stop;
  const Problem problem = ladder(5000);
  EXPECT_THROW(least_strip(problem.p, problem.q, problem.gap, problem.longest, stop), Error);
}

TEST(strip, of_nothing_is_empty) {
  EXPECT_TRUE(least_strip({}, {Vec3::Zero()}, 1, 2).empty());
  EXPECT_TRUE(least_strip({Vec3::Zero()}, {}, 1, 2).empty());
  EXPECT_TRUE(least_strip({Vec3::Zero()}, {Vec3(3, 0, 0)}, 1, 2).empty());
  EXPECT_EQ(least_strip({Vec3::Zero()}, {Vec3(1, 0, 0)}, 1, 2), (Strip{{0, 0}}));
}

}  // namespace
}  // namespace isopath
