#include "isopath/impact/stroke_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#include "isopath/core/error.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

struct Instance {
  std::vector<std::vector<Gate>> runs;
  double longest_link = 4;
  double lift_cost = 40;

  double way(const Visit& from, const Visit& to) const {
    double d = infinity;
    for (const Vec3& a : runs[from.run][from.gate].exit) {
      for (const Vec3& b : runs[to.run][to.gate].entry) d = std::min(d, (a - b).norm());
    }
    return d + (d > longest_link ? lift_cost : 0);
  }
  double cost(const std::vector<Visit>& visits) const {
    double sum = 0;
    for (std::size_t i = 1; i < visits.size(); ++i) sum += way(visits[i - 1], visits[i]);
    return sum;
  }
  std::vector<Visit> ordered() const { return order_runs(runs, longest_link, lift_cost); }
};

Vec3 random_place(test::Rng& rng) { return {test::random_real(rng, 0, 10), test::random_real(rng, 0, 10), 0}; }

/// A run of open passes has four gates, one of closed passes two with several places each.
std::vector<Gate> random_run(test::Rng& rng) {
  if (test::random_index(rng, 2) == 0) {
    const std::vector<Vec3> first{random_place(rng), random_place(rng)};
    const std::vector<Vec3> last{random_place(rng), random_place(rng)};
    return {{{first[0]}, {last[1]}}, {{last[0]}, {first[1]}}, {{first[1]}, {last[0]}}, {{last[1]}, {first[0]}}};
  }
  const std::vector<Vec3> outer{random_place(rng), random_place(rng), random_place(rng)};
  const std::vector<Vec3> inner{random_place(rng), random_place(rng)};
  return {{outer, inner}, {inner, outer}};
}

Instance random_instance(test::Rng& rng, int most) {
  Instance instance;
  const int n = 1 + test::random_index(rng, most);
  for (int k = 0; k < n; ++k) instance.runs.push_back(random_run(rng));
  return instance;
}

/// The least cost over all orders and gates.
double brute_force(const Instance& instance) {
  std::vector<std::size_t> order(instance.runs.size());
  std::iota(order.begin(), order.end(), 0);
  double least = infinity;
  do {
    // the best way to come out of every gate of the runs so far
    std::vector<double> best(instance.runs[order[0]].size(), 0.0);
    for (std::size_t k = 1; k < order.size(); ++k) {
      std::vector<double> next(instance.runs[order[k]].size(), infinity);
      for (std::size_t g = 0; g < next.size(); ++g) {
        for (std::size_t b = 0; b < best.size(); ++b) {
          next[g] = std::min(next[g], best[b] + instance.way({order[k - 1], b}, {order[k], g}));
        }
      }
      best = next;
    }
    least = std::min(least, *std::min_element(best.begin(), best.end()));
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

/// Always on to what is nearest, from the best start.
double nearest_neighbour(const Instance& instance) {
  double least = infinity;
  for (std::size_t r = 0; r < instance.runs.size(); ++r) {
    for (std::size_t g = 0; g < instance.runs[r].size(); ++g) {
      std::vector<Visit> visits{{r, g}};
      std::vector<char> done(instance.runs.size(), 0);
      done[r] = 1;
      while (visits.size() < instance.runs.size()) {
        Visit next{};
        double nearest = infinity;
        for (std::size_t k = 0; k < instance.runs.size(); ++k) {
          for (std::size_t h = 0; !done[k] && h < instance.runs[k].size(); ++h) {
            const double d = instance.way(visits.back(), {k, h});
            if (d >= nearest) continue;
            nearest = d;
            next = {k, h};
          }
        }
        done[next.run] = 1;
        visits.push_back(next);
      }
      least = std::min(least, instance.cost(visits));
    }
  }
  return least;
}

void expect_each_once(const Instance& instance, const std::vector<Visit>& visits) {
  ASSERT_EQ(visits.size(), instance.runs.size());
  std::vector<int> seen(instance.runs.size(), 0);
  for (const Visit& visit : visits) {
    ASSERT_LT(visit.run, instance.runs.size());
    ASSERT_LT(visit.gate, instance.runs[visit.run].size());
    ++seen[visit.run];
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(seen.size()));
}

TEST(stroke_order, of_few_runs_is_near_the_best_of_all_orders) {
  int best = 0;
  constexpr int n = 300;
  for (std::uint64_t seed = 1; seed <= n; ++seed) {
    test::Rng rng(seed);
    const Instance instance = random_instance(rng, 5);
    const std::vector<Visit> visits = instance.ordered();
    expect_each_once(instance, visits);
    const double least = brute_force(instance);
    const double cost = instance.cost(visits);
    EXPECT_GE(cost, least - 1e-9) << "seed " << seed;
    EXPECT_LE(cost, 1.5 * least + 1e-9) << "seed " << seed;
    if (cost <= least + 1e-9) ++best;
  }
  EXPECT_GE(best, 9 * n / 10) << "of " << n;
}

TEST(stroke_order, is_never_worse_than_nearest_neighbour) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    test::Rng rng(seed);
    const Instance instance = random_instance(rng, 12);
    const std::vector<Visit> visits = instance.ordered();
    expect_each_once(instance, visits);
    EXPECT_LE(instance.cost(visits), nearest_neighbour(instance) + 1e-9) << "seed " << seed;
  }
}

TEST(stroke_order, follows_runs_that_lie_in_a_row) {
  // Single passes across a strip, numbered at random: the best order is from one end to the other, each pass walked
  // against the last, with n - 1 ways of length 1.
  const std::vector<int> shuffled{3, 0, 6, 1, 5, 2, 7, 4};
  Instance instance;
  for (const int x : shuffled) {
    const Vec3 low(x, 0, 0);
    const Vec3 high(x, 20, 0);
    instance.runs.push_back({{{low}, {high}}, {{high}, {low}}});
  }
  const std::vector<Visit> visits = instance.ordered();
  expect_each_once(instance, visits);
  EXPECT_NEAR(instance.cost(visits), 7, 1e-12);
  for (std::size_t i = 1; i < visits.size(); ++i) {
    EXPECT_EQ(std::abs(shuffled[visits[i].run] - shuffled[visits[i - 1].run]), 1);
    EXPECT_NE(visits[i].gate, visits[i - 1].gate);
  }
}

TEST(stroke_order, lifts_once_between_two_heaps) {
  test::Rng rng(7);
  Instance instance;
  for (int k = 0; k < 10; ++k) {
    const Vec3 place = Vec3(k % 2 == 0 ? 0 : 100, 0, 0) + 0.2 * random_place(rng);
    instance.runs.push_back({{{place}, {place}}});
  }
  const std::vector<Visit> visits = instance.ordered();
  expect_each_once(instance, visits);
  int lifts = 0;
  for (std::size_t i = 1; i < visits.size(); ++i) lifts += visits[i].run % 2 != visits[i - 1].run % 2 ? 1 : 0;
  EXPECT_EQ(lifts, 1);
}

TEST(stroke_order, stops_on_request) {
  class Stop final : public Progress {
    bool cancelled() const override { return true; }
  } stop;
  test::Rng rng(1);
  EXPECT_THROW(order_runs({random_run(rng), random_run(rng)}, 1, 1, stop), Error);
}

TEST(stroke_order, enters_open_curves_at_their_ends_and_closed_ones_all_round) {
  std::vector<Vec3> ring;
  for (int i = 0; i < 1000; ++i)
    ring.emplace_back(std::cos(0.002 * std::numbers::pi * i), std::sin(0.002 * std::numbers::pi * i), 0);
  const std::vector<Gate> open = gates_of_curve(ring, false);
  ASSERT_EQ(open.size(), 2U);
  EXPECT_EQ(open[0].entry, std::vector<Vec3>{ring.front()});
  EXPECT_EQ(open[0].exit, std::vector<Vec3>{ring.back()});
  EXPECT_EQ(open[1].entry, open[0].exit);
  EXPECT_EQ(open[1].exit, open[0].entry);
  const std::vector<Gate> closed = gates_of_curve(ring, true);
  ASSERT_EQ(closed.size(), 1U);
  EXPECT_EQ(closed[0].entry, closed[0].exit);
  EXPECT_LT(closed[0].entry.size(), 60U);
  for (const Vec3& place : ring) {  // none is farther from a sample than a fortieth of the way round
    double least = infinity;
    for (const Vec3& sample : closed[0].entry) least = std::min(least, (sample - place).norm());
    EXPECT_LT(least, std::numbers::pi / 20);
  }
  EXPECT_EQ(samples_of(std::span(ring).first(5), 48).size(), 5U);
}

TEST(stroke_order, of_nothing_is_nothing) { EXPECT_TRUE(order_runs({}, 1, 1).empty()); }

}  // namespace
}  // namespace isopath
