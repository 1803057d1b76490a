#include "isopath/impact/strip.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <queue>

namespace isopath {

namespace {

/// Cancel is asked for after so many steps of a loop: far less than 100 ms.
constexpr std::size_t steps_between_checks = 1024;

/// For each place k of `p`, the least length of the rungs that start at a later place: what the way to the end costs at
/// least.
std::vector<double> least_ahead(const std::vector<Vec3>& p, const std::vector<Vec3>& q, double gap,
                                const Progress& progress) {
  double step = 0;
  for (std::size_t j = 1; j < q.size(); ++j) step = std::max(step, (q[j] - q[j - 1]).norm());
  std::vector<double> ahead(p.size(), 0.0);
  std::size_t nearest = 0;
  for (std::size_t i = p.size(); i-- > 1;) {
    if (i % steps_between_checks == 0) progress.checkpoint();
    double least = (p[i] - q[nearest]).norm();
    for (std::size_t j = 0; j < q.size();) {
      const double distance = (p[i] - q[j]).norm();
      if (distance < least) {
        least = distance;
        nearest = j;
      }
      // the next places of q come nearer by no more than a step each
      j += 1 + (distance > least ? static_cast<std::size_t>((distance - least) / step) : 0);
    }
    ahead[i - 1] = ahead[i] + std::max(least, gap);
  }
  return ahead;
}

/// How the search came to a cell of the grid.
enum class Step : std::uint8_t { unseen, along_p, along_q, start };

/// The cells that the search has come to: of each row one stretch, as rungs that are short enough lie near the
/// diagonal. The whole grid of two long polylines would not fit into memory.
class Grid {
 public:
  struct Cell {
    double cost = infinity;
    Step by = Step::unseen;
  };

  explicit Grid(std::size_t rows) : rows_(rows) {}

  Cell& at(Index i, Index j) {
    Row& row = rows_[i];
    if (row.cells.empty()) row.first = j;
    if (j < row.first) {
      const auto more = std::max(row.first - j, std::min(row.first, static_cast<Index>(row.cells.size())));
      row.cells.insert(row.cells.begin(), static_cast<std::size_t>(more), Cell{});
      row.first -= more;
    }
    const auto place = static_cast<std::size_t>(j - row.first);
    if (place >= row.cells.size()) row.cells.resize(place + 1);
    return row.cells[place];
  }

 private:
  struct Row {
    Index first = 0;  ///< column of the first cell
    std::vector<Cell> cells;
  };
  std::vector<Row> rows_;
};

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

Strip way_to(Index i, Index j, Grid& grid) {
  Strip strip;
  for (;;) {
    strip.emplace_back(i, j);
    const Step by = grid.at(i, j).by;
    if (by == Step::start) break;
    --(by == Step::along_p ? i : j);
  }
  std::reverse(strip.begin(), strip.end());
  return strip;
}

}  // namespace

Strip least_strip(const std::vector<Vec3>& p, const std::vector<Vec3>& q, double gap, double longest,
                  const Progress& progress) {
  const auto m = static_cast<Index>(p.size());
  const auto n = static_cast<Index>(q.size());
  if (m == 0 || n == 0) return {};
  // Every step leads to a new place of p or of q, by a rung that is no shorter than the shortest there: admissible, and
  // far closer to the truth than gap × steps where contours diverge, as around corners.
  const std::vector<double> ahead_p = least_ahead(p, q, gap, progress);
  const std::vector<double> ahead_q = least_ahead(q, p, gap, progress);
  Grid grid(p.size());
  std::priority_queue<Node, std::vector<Node>, std::greater<>> open;
  const auto offer = [&](Index i, Index j, double cost, Step by) {
    const double chord = (p[i] - q[j]).norm();
    if (chord > longest) return;
    cost += std::max(chord, gap);
    Grid::Cell& cell = grid.at(i, j);
    if (!(cost < cell.cost)) return;
    cell = {cost, by};
    open.push({cost + ahead_p[i] + ahead_q[j], cost, i, j});
  };
  offer(0, 0, 0, Step::start);
  for (std::size_t visited = 1; !open.empty(); ++visited) {
    const Node node = open.top();
    open.pop();
    if (node.i == m - 1 && node.j == n - 1) return way_to(node.i, node.j, grid);
    if (node.cost > grid.at(node.i, node.j).cost) continue;  // found a better way meanwhile
    if (visited % steps_between_checks == 0) progress.checkpoint();
    if (node.i + 1 < m) offer(node.i + 1, node.j, node.cost, Step::along_p);
    if (node.j + 1 < n) offer(node.i, node.j + 1, node.cost, Step::along_q);
  }
  return {};
}

}  // namespace isopath
