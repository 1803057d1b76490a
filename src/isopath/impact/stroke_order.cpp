#include "isopath/impact/stroke_order.h"

#include <algorithm>

namespace isopath {
namespace {

double least_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double least = infinity;
  for (const Vec3& p : a) {
    for (const Vec3& q : b) least = std::min(least, (p - q).squaredNorm());
  }
  return std::sqrt(least);
}

struct Tour {
  std::vector<Visit> visits;
  double cost = 0;
};

}  // namespace

std::vector<Visit> order_runs(const std::vector<std::vector<Gate>>& runs, double longest_link, double lift_cost) {
  std::vector<Visit> gates;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    for (std::size_t g = 0; g < runs[r].size(); ++g) gates.push_back({r, g});
  }
  const std::size_t n = gates.size();
  std::vector<double> cost(n * n);
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = 0; b < n; ++b) {
      if (gates[a].run == gates[b].run) continue;
      const double d = least_distance(runs[gates[a].run][gates[a].gate].exit, runs[gates[b].run][gates[b].gate].entry);
      cost[a * n + b] = d + (d > longest_link ? lift_cost : 0);
    }
  }
  Tour best{{}, infinity};
  std::vector<char> done(runs.size());
  for (std::size_t start = 0; start < n; ++start) {
    std::fill(done.begin(), done.end(), 0);
    Tour tour{{gates[start]}, 0};
    done[gates[start].run] = 1;
    for (std::size_t here = start; tour.visits.size() < runs.size() && tour.cost < best.cost;) {
      std::size_t next = n;
      for (std::size_t g = 0; g < n; ++g) {
        if (!done[gates[g].run] && (next == n || cost[here * n + g] < cost[here * n + next])) next = g;
      }
      tour.cost += cost[here * n + next];
      tour.visits.push_back(gates[next]);
      done[gates[next].run] = 1;
      here = next;
    }
    if (tour.cost < best.cost) best = std::move(tour);
  }
  return best.visits;
}

}  // namespace isopath
