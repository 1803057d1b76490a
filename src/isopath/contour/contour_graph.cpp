#include "isopath/contour/contour_graph.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "isopath/contour/bands.h"
#include "isopath/contour/chain.h"
#include "isopath/contour/descent.h"
#include "isopath/contour/level_cut.h"

namespace isopath {

namespace {

// From so many points of a contour at most a way down is followed. A neighbour that only a shorter stretch of the
// contour looks down on is no neighbour to go on to.
constexpr std::size_t most_descents = 32;

using Member = std::pair<Index, Index>;  // component, contour

class GraphBuilder {
 public:
  GraphBuilder(const TriangleMesh& mesh, const SurfaceFunction& function, const LevelCut& cut, const Chains& chains,
               Progress& progress)
      : cut_(cut), chains_(chains), bands_(mesh, function, cut), descent_(mesh, function, cut), progress_(progress) {}

  ContourGraph build() {
    const std::size_t n = chains_.contours.size();
    graph_.children.resize(n);
    graph_.parents.resize(n);
    graph_.order.resize(n);
    std::iota(graph_.order.begin(), graph_.order.end(), Index{0});  // contours are sorted by level
    std::vector<Member> lower;                                      // contours that bound a component from below
    std::vector<Member> upper;
    for (Index k = 0; k < static_cast<Index>(n); ++k) {
      lower.emplace_back(bands_.above(chains_.some_piece_of[k]), k);
      upper.emplace_back(bands_.below(chains_.some_piece_of[k]), k);
    }
    std::sort(lower.begin(), lower.end());
    std::sort(upper.begin(), upper.end());
    auto up = upper.begin();
    for (auto low = lower.begin(); low != lower.end();) {
      progress_.checkpoint();
      const Index component = low->first;
      const auto same = [&](const Member& member) { return member.first == component; };
      const auto low_end = std::find_if_not(low, lower.end(), same);
      while (up != upper.end() && up->first < component) ++up;
      const auto up_end = std::find_if_not(up, upper.end(), same);
      link_component({low, low_end}, {up, up_end});
      low = low_end;
      up = up_end;
    }
    for (auto& links : graph_.children) std::sort(links.begin(), links.end());
    for (auto& links : graph_.parents) std::sort(links.begin(), links.end());
    find_runs();
    return std::move(graph_);
  }

 private:
  void link(Index lower, Index upper) {
    graph_.children[lower].push_back(upper);
    graph_.parents[upper].push_back(lower);
  }

  Index level_of(Index contour) const { return cut_.pieces[chains_.some_piece_of[contour]].level; }

  void link_component(std::span<const Member> lower, std::span<const Member> upper) {
    const bool certain = lower.size() <= 1 || upper.size() <= 1;
    for (const Member& u : upper) {
      std::vector<Index> met;
      if (!certain) met = contours_met_below(u.second, u.first);
      for (const Member& l : lower) {
        // Without any verdict every neighbour in the band stays possible.
        // Where contours of several levels touch, their bands run together; neighbours are still one level apart.
        if (level_of(u.second) != level_of(l.second) + 1) continue;
        if (met.empty() || std::binary_search(met.begin(), met.end(), l.second)) link(l.second, u.second);
      }
    }
  }

  /// The contours one level down, on the same component, that the ways down from a contour lead to.
  std::vector<Index> contours_met_below(Index contour, Index component) {
    std::vector<Index> met;
    const Index level = level_of(contour) - 1;
    const auto& points = chains_.contours[contour].points;
    const std::size_t stride = (points.size() + most_descents - 1) / most_descents;
    for (std::size_t i = 0; i < points.size(); i += stride) {
      progress_.checkpoint();
      const Index piece = descent_.piece_below(points[i], level);
      if (piece == no_index || bands_.above(piece) != component) continue;
      if (const Index below = chains_.contour_of_piece[piece]; below != no_index) met.push_back(below);
    }
    std::sort(met.begin(), met.end());
    met.erase(std::unique(met.begin(), met.end()), met.end());
    return met;
  }

  bool continues_run(Index contour) const {
    const auto& parents = graph_.parents[contour];
    return parents.size() == 1 && graph_.children[parents[0]].size() == 1 &&
           chains_.contours[parents[0]].closed == chains_.contours[contour].closed;
  }

  void find_runs() {
    std::vector<Index> run_of(chains_.contours.size(), no_index);
    for (const Index contour : graph_.order) {
      if (continues_run(contour)) {
        run_of[contour] = run_of[graph_.parents[contour][0]];
      } else {
        run_of[contour] = static_cast<Index>(graph_.runs.size());
        graph_.runs.emplace_back();
        graph_.runs.back().closed = chains_.contours[contour].closed;
      }
      graph_.runs[run_of[contour]].contours.push_back(contour);
    }
    for (auto& run : graph_.runs) {
      for (const Index child : graph_.children[run.contours.back()]) run.children.push_back(run_of[child]);
      for (const Index parent : graph_.parents[run.contours.front()]) run.parents.push_back(run_of[parent]);
    }
  }

  const LevelCut& cut_;
  const Chains& chains_;
  Bands bands_;
  Descent descent_;
  Progress& progress_;
  ContourGraph graph_;
};

}  // namespace

ContourSet contour_set(const TriangleMesh& mesh, const SurfaceFunction& function, std::span<const double> levels,
                       const IsolineOptions& options, Progress& progress) {
  options.validate();
  validate_levels(levels);
  const LevelCut cut = cut_levels(mesh, function, levels, options.chord_tolerance_for(mesh), progress);
  Chains chains = chain_pieces(mesh, cut);
  ContourGraph graph = GraphBuilder(mesh, function, cut, chains, progress).build();
  return {std::move(chains.contours), std::move(graph)};
}

}  // namespace isopath
