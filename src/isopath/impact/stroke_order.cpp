#include "isopath/impact/stroke_order.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace isopath {
namespace {

constexpr std::size_t samples_of_closed_curve = 48;

double least_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double least = infinity;
  for (const Vec3& p : a) {
    for (const Vec3& q : b) least = std::min(least, (p - q).squaredNorm());
  }
  return std::sqrt(least);
}

/// Gates numbered through, and the cost of the way from one's exit to another's entry.
class GateCosts {
 public:
  GateCosts(const std::vector<std::vector<Gate>>& runs, double longest_link, double lift_cost,
            const Progress& progress) {
    for (std::size_t r = 0; r < runs.size(); ++r) {
      for (std::size_t g = 0; g < runs[r].size(); ++g) gates_.push_back({r, g});
    }
    cost_.resize(size() * size());
    for (std::size_t a = 0; a < size(); ++a) {
      progress.checkpoint();
      for (std::size_t b = 0; b < size(); ++b) {
        if (gates_[a].run == gates_[b].run) continue;
        const double d =
            least_distance(runs[gates_[a].run][gates_[a].gate].exit, runs[gates_[b].run][gates_[b].gate].entry);
        cost_[a * size() + b] = d + (d > longest_link ? lift_cost : 0);
      }
    }
  }

  std::size_t size() const { return gates_.size(); }
  const Visit& operator[](std::size_t gate) const { return gates_[gate]; }
  double cost(std::size_t from, std::size_t to) const { return cost_[from * size() + to]; }

 private:
  std::vector<Visit> gates_;
  std::vector<double> cost_;
};

using Tour = std::vector<std::size_t>;  // gate numbers

double cost_of(const GateCosts& gates, const Tour& tour) {
  double sum = 0;
  for (std::size_t i = 1; i < tour.size(); ++i) sum += gates.cost(tour[i - 1], tour[i]);
  return sum;
}

Tour nearest_neighbour(const GateCosts& gates, std::size_t start, std::size_t runs, const Progress& progress) {
  Tour tour{start};
  std::vector<char> done(runs, 0);
  done[gates[start].run] = 1;
  while (tour.size() < runs) {
    progress.checkpoint();
    std::size_t next = gates.size();
    for (std::size_t g = 0; g < gates.size(); ++g) {
      if (done[gates[g].run]) continue;
      if (next == gates.size() || gates.cost(tour.back(), g) < gates.cost(tour.back(), next)) next = g;
    }
    tour.push_back(next);
    done[gates[next].run] = 1;
  }
  return tour;
}

/// What it costs to have `gate` between places i - 1 and i of a tour that does not hold it.
double insertion_cost(const GateCosts& gates, const Tour& tour, std::size_t i, std::size_t gate) {
  double cost = 0;
  if (i > 0) cost += gates.cost(tour[i - 1], gate);
  if (i < tour.size()) cost += gates.cost(gate, tour[i]);
  if (i > 0 && i < tour.size()) cost -= gates.cost(tour[i - 1], tour[i]);
  return cost;
}

/// Takes one run after the other out and puts it back where, and by the gate where, it costs least; until nothing
/// improves.
void relocate_runs(const GateCosts& gates, Tour& tour, const Progress& progress) {
  for (bool improved = true; improved;) {
    improved = false;
    for (std::size_t i = 0; i < tour.size(); ++i) {
      progress.checkpoint();
      Tour rest = tour;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      const double now = insertion_cost(gates, rest, i, tour[i]);
      double least = now - 1e-9 * (1 + now);
      std::size_t best_place = i;
      std::size_t best_gate = tour[i];
      for (std::size_t g = 0; g < gates.size(); ++g) {
        if (gates[g].run != gates[tour[i]].run) continue;
        for (std::size_t k = 0; k <= rest.size(); ++k) {
          const double cost = insertion_cost(gates, rest, k, g);
          if (cost >= least) continue;
          least = cost;
          best_place = k;
          best_gate = g;
        }
      }
      if (best_place == i && best_gate == tour[i]) continue;
      rest.insert(rest.begin() + static_cast<std::ptrdiff_t>(best_place), best_gate);
      tour = std::move(rest);
      improved = true;
    }
  }
}

/// Every start is tried while that is cheap.
constexpr std::size_t most_starts = 64;

}  // namespace

std::vector<Vec3> samples_of(std::span<const Vec3> places, std::size_t most) {
  std::vector<Vec3> samples;
  const std::size_t stride = std::max<std::size_t>(1, places.size() / most);
  for (std::size_t i = 0; i < places.size(); i += stride) samples.push_back(places[i]);
  return samples;
}

std::vector<Gate> gates_of_curve(std::span<const Vec3> places, bool closed) {
  if (!closed) return {{{places.front()}, {places.back()}}, {{places.back()}, {places.front()}}};
  const std::vector<Vec3> samples = samples_of(places, samples_of_closed_curve);
  return {{samples, samples}};
}

std::vector<Visit> order_runs(const std::vector<std::vector<Gate>>& runs, double longest_link, double lift_cost,
                              const Progress& progress) {
  const GateCosts gates(runs, longest_link, lift_cost, progress);
  Tour best;
  const std::size_t stride = std::max<std::size_t>(1, gates.size() / most_starts);
  for (std::size_t start = 0; start < gates.size(); start += stride) {
    Tour tour = nearest_neighbour(gates, start, runs.size(), progress);
    relocate_runs(gates, tour, progress);
    if (best.empty() || cost_of(gates, tour) < cost_of(gates, best)) best = std::move(tour);
  }
  std::vector<Visit> visits;
  for (const std::size_t gate : best) visits.push_back(gates[gate]);
  return visits;
}

}  // namespace isopath
