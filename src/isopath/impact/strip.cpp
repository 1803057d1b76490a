#include "isopath/impact/strip.h"

#include <algorithm>
#include <queue>

namespace isopath {

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
    open.push({cost + gap * ((m - 1 - i) + (n - 1 - j)), cost, i, j});
  };
  offer(0, 0, 0, start);
  while (!open.empty()) {
    const Node node = open.top();
    open.pop();
    if (node.i == m - 1 && node.j == n - 1) break;
    if (node.cost > best[static_cast<std::size_t>(node.i) * n + node.j]) continue;
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
