#include <algorithm>
#include <queue>
#include <utility>
#include <vector>

#include "isopath/mesh/repair_steps.h"
#include "isopath/mesh/triangle_shape.h"

namespace isopath {
namespace {

/// Removes triangles without area from a soup whose triangles' vertices all differ.
class ZeroAreaRemover {
 public:
  explicit ZeroAreaRemover(RepairState& state)
      : state_(state), triangles_(state.soup.triangles), dead_(triangles_.size(), 0) {}

  void run() {
    std::vector<Index> flat;
    for (Index t = 0; t < static_cast<Index>(triangles_.size()); ++t) {
      if (is_flat(t)) flat.push_back(t);
    }
    if (flat.empty()) return;
    incident_.resize(state_.soup.positions.size());
    for (Index t = 0; t < static_cast<Index>(triangles_.size()); ++t) {
      for (const Index v : triangles_[t]) incident_[v].push_back(t);
    }
    for (const Index t : flat) collapse_needle(t);
    for (const Index t : flat) enqueue_cap(t);
    // Longest first: a cap's neighbours are replaced by triangles with shorter edges, so that a chain of caps along a
    // line comes to an end. The limit is for chains that branch; the next pass goes on where it stopped.
    const std::size_t limit = 16 * flat.size() + 1000;
    std::size_t caps = 0;
    while (!caps_.empty() && caps < limit) {
      const Index t = caps_.top().second;
      caps_.pop();
      if (!dead_[t] && is_cap(t)) {
        remove_cap(t);
        ++caps;
      }
    }
    state_.note("zero-area triangles replaced by splitting their neighbour at their tip", caps);
    erase_dead();
  }

 private:
  TriangleShape shape(Index t) const {
    const auto& [a, b, c] = triangles_[t];
    const auto& positions = state_.soup.positions;
    return shape_of(positions[a], positions[b], positions[c]);
  }
  bool is_flat(Index t) const { return shape(t).height <= state_.tolerance.length; }
  bool is_cap(Index t) const {
    const TriangleShape s = shape(t);
    return s.height <= state_.tolerance.length && s.shortest > state_.tolerance.length;
  }

  /// Merges the ends of an edge within the tolerance; the lower index stays where it is.
  void collapse_needle(Index t) {
    for (int i = 0; i < 3 && !dead_[t]; ++i) {
      const auto [keep, gone] = std::minmax({triangles_[t][i], triangles_[t][(i + 1) % 3]});
      const auto& positions = state_.soup.positions;
      if ((positions[keep] - positions[gone]).stableNorm() > state_.tolerance.length) continue;
      state_.merged.join(keep, gone);
      state_.note("edges of zero-area triangles collapsed", 1);
      for (const Index u : std::exchange(incident_[gone], {})) {
        Triangle& triangle = triangles_[u];
        const bool both = std::find(triangle.begin(), triangle.end(), keep) != triangle.end();
        std::replace(triangle.begin(), triangle.end(), gone, keep);
        if (both) dead_[u] = 1;
        incident_[keep].push_back(u);
      }
      return;
    }
  }

  void enqueue_cap(Index t) {
    if (!dead_[t] && is_cap(t)) caps_.emplace(shape(t).longest, t);
  }

  /// The tip c of the cap lies on its edge ab. Every other triangle at ab is split there, so that nothing opens.
  void remove_cap(Index cap) {
    const int apex = shape(cap).apex;
    const Index c = triangles_[cap][apex];
    const Index a = triangles_[cap][(apex + 1) % 3];
    const Index b = triangles_[cap][(apex + 2) % 3];
    dead_[cap] = 1;
    const std::vector<Index> around = incident_[a];
    for (const Index u : around) {
      const Triangle old = triangles_[u];
      const auto has = [&](Index v) { return std::find(old.begin(), old.end(), v) != old.end(); };
      if (dead_[u] || !has(a) || !has(b)) continue;
      if (has(c)) {
        dead_[u] = 1;  // the same cap once more: both halves would have no corner of their own
        continue;
      }
      Triangle second = old;
      std::replace(triangles_[u].begin(), triangles_[u].end(), a, c);
      std::replace(second.begin(), second.end(), b, c);
      const auto added = static_cast<Index>(triangles_.size());
      triangles_.push_back(second);
      dead_.push_back(0);
      incident_[c].push_back(u);
      for (const Index v : second) incident_[v].push_back(added);
      enqueue_cap(u);
      enqueue_cap(added);
    }
  }

  void erase_dead() {
    std::size_t kept = 0;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      if (!dead_[t]) triangles_[kept++] = triangles_[t];
    }
    triangles_.resize(kept);
  }

  RepairState& state_;
  std::vector<Triangle>& triangles_;
  std::vector<char> dead_;
  std::vector<std::vector<Index>> incident_;  // may name triangles that have moved on: check before use
  std::priority_queue<std::pair<double, Index>> caps_;
};

}  // namespace

void remove_zero_area(RepairState& state, bool force) {
  if (!force) return ZeroAreaRemover(state).run();
  const auto& [positions, triangles] = state.soup;
  std::vector<char> marked(triangles.size(), 0);
  for (std::size_t t = 0; t < marked.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    marked[t] = shape_of(positions[a], positions[b], positions[c]).height <= state.tolerance.length;
  }
  state.drop(marked, "zero-area triangles dropped");
}

}  // namespace isopath
