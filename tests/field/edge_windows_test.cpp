#include "isopath/field/edge_windows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "support/test_meshes.h"

namespace isopath::test {
namespace {

/// n windows side by side, of lengths from 0 to 1; `offset` tells which edge they belong to.
std::vector<Window> random_windows(Rng& rng, std::size_t n, double offset) {
  std::vector<Window> windows(n);
  double x = 0;
  for (Window& window : windows) {
    window.begin = x;
    window.end = x += random_real(rng, 0, 1);
    window.offset = offset;
  }
  return windows;
}

TEST(EdgeWindows, GivesBackWhatWasAddedInAnyOrder) {
  Rng rng(1);
  constexpr Index n_edges = 200;
  std::vector<std::vector<Window>> expected;
  for (Index edge = 0; edge < n_edges; ++edge) expected.push_back(random_windows(rng, random_index(rng, 40), edge));
  std::vector<Index> order(n_edges);
  for (Index edge = 0; edge < n_edges; ++edge) order[edge] = edge;
  std::shuffle(order.begin(), order.end(), rng);
  EdgeWindows all(n_edges, 7);
  std::size_t n = 0;
  for (const Index edge : order) {
    all.add(static_cast<std::size_t>(random_index(rng, 7)), edge, expected[edge]);
    n += expected[edge].size();
  }
  for (std::size_t part = 0; part < 7; ++part) all.finish(part);
  const EdgeWindows moved = std::move(all);
  EXPECT_EQ(moved.size(), n);
  for (Index edge = 0; edge < n_edges; ++edge) {
    const auto windows = moved.of(edge);
    ASSERT_EQ(windows.size(), expected[edge].size());
    for (std::size_t i = 0; i < windows.size(); ++i) {
      EXPECT_EQ(windows[i].begin, expected[edge][i].begin);
      EXPECT_EQ(windows[i].offset, edge);
    }
  }
}

TEST(EdgeWindows, FindsThoseThatReachIntoAnInterval) {
  Rng rng(2);
  for (int k = 0; k < 1000; ++k) {
    EdgeWindows all(1, 1);
    const std::vector<Window> windows = random_windows(rng, random_index(rng, 60), 0);
    all.add(0, 0, windows);
    const double low = random_real(rng, -5, 35);
    const double high = low + random_real(rng, 0, 5);
    std::vector<double> expected;
    for (const Window& window : windows) {
      if (window.end >= low && window.begin <= high) expected.push_back(window.begin);
    }
    std::vector<double> found;
    all.for_each(0, low, high, [&](const Window& window) { found.push_back(window.begin); });
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace isopath::test
