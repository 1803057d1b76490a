#include "isopath/impact/strip.h"

#include <algorithm>
#include <queue>

namespace isopath {

namespace {

/// For each place k of `p`, the least length of the rungs that start at a later place: what the way to the end costs at
/// least.
std::vector<double> least_ahead(const std::vector<Vec3>& p, const std::vector<Vec3>& q, double gap) {
  std::vector<double> ahead(p.size(), 0.0);
  for (std::size_t i = p.size(); i-- > 1;) {
    double least = infinity;
    for (const Vec3& place : q) least = std::min(least, (p[i] - place).squaredNorm());
    ahead[i - 1] = ahead[i] + std::max(std::sqrt(least), gap);
  }
  return ahead;
}

}  // namespace

Strip least_strip(const std::vector<Vec3>& p, const std::vector<Vec3>& q, double gap, double longest) {
  struct Node {
    double estimate;
    double cost;
    Index i;
    Index j;
    bool operator>(const Node& other) const {
      // of equal estimates the one nearer the goal first
      return estimate != other.estimate ? estimate > other.estimate : i + j < other.i + other.j;
    }
  };
  const auto m = static_cast<Index>(p.size());
  const auto n = static_cast<Index>(q.size());
  if (m == 0 || n == 0) return {};
  const auto rung = [&](Index i, Index j) {
    const double chord = (p[i] - q[j]).norm();
    return chord > longest ? infinity : std::max(chord, gap);
  };
  // Every step leads to a new place of p or of q, by a rung that is no shorter than the shortest there: admissible, and
  // far closer to the truth than gap × steps where contours diverge, as around corners.
  const std::vector<double> ahead_p = least_ahead(p, q, gap);
  const std::vector<double> ahead_q = least_ahead(q, p, gap);
  enum Step : char { unseen, along_p, along_q, start };
  std::vector<char> step(static_cast<std::size_t>(m) * n, unseen);
  std::vector<double> best(step.size(), infinity);
  std::priority_queue<Node, std::vector<Node>, std::greater<>> open;
  const auto offer = [&](Index i, Index j, double cost, Step by) {
    cost += rung(i, j);
    const std::size_t at = static_cast<std::size_t>(i) * n + j;
    if (!(cost < best[at])) return;
    best[at] = cost;
    step[at] = by;
    open.push({cost + ahead_p[i] + ahead_q[j], cost, i, j});
  };
  offer(0, 0, 0, start);
  while (!open.empty()) {
    const Node node = open.top();
    open.pop();
    if (node.i == m - 1 && node.j == n - 1) break;
    if (node.cost > best[static_cast<std::size_t>(node.i) * n + node.j]) continue;  // found a better way meanwhile
    if (node.i + 1 < m) offer(node.i + 1, node.j, node.cost, along_p);
    if (node.j + 1 < n) offer(node.i, node.j + 1, node.cost, along_q);
  }
  if (step.back() == unseen) return {};
  Strip strip;
  for (Index i = m - 1, j = n - 1;;) {
    strip.emplace_back(i, j);
    const char by = step[static_cast<std::size_t>(i) * n + j];
    if (by == start) break;
    --(by == along_p ? i : j);
  }
  std::reverse(strip.begin(), strip.end());
  return strip;
}

}  // namespace isopath
