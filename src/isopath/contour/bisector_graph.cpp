#include "isopath/contour/bisector_graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <tuple>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/mesh/disjoint_sets.h"

namespace isopath {
namespace {

using Arc = BisectorGraph::Arc;
using Points = std::vector<BisectorPoint>;

double length_of_points(const TriangleMesh& mesh, const Points& points) {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    length += (position_of(mesh, points[i].point) - position_of(mesh, points[i - 1].point)).norm();
  return length;
}

/// The same arc, walked the other way.
void turn_round(Points& points) {
  std::reverse(points.begin(), points.end());
  for (BisectorPoint& point : points) std::swap(point.roots[0], point.roots[1]);
}

/// Appends points that go on where others end.
void append(Points& points, Points more) {
  points.insert(points.end(), std::make_move_iterator(more.begin() + (points.empty() ? 0 : 1)),
                std::make_move_iterator(more.end()));
}

/// Arcs between points that are numbered anyhow; joins those that follow each other.
class ArcChains {
 public:
  ArcChains(std::size_t n_points, std::vector<BisectorPiece> pieces)
      : pieces_(std::move(pieces)), at_(n_points), done_(pieces_.size(), false) {
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
      at_[pieces_[k].from].push_back(static_cast<Index>(k));
      at_[pieces_[k].to].push_back(static_cast<Index>(k));
    }
  }

  BisectorGraph run() {
    node_of_.assign(at_.size(), no_index);
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
      for (const Index p : {pieces_[k].from, pieces_[k].to}) {
        if (at_[p].size() != 2) walk_from(p, static_cast<Index>(k));
      }
    }
    for (std::size_t k = 0; k < pieces_.size(); ++k) walk_from(pieces_[k].from, static_cast<Index>(k));
    for (std::size_t k = 0; k < graph_.arcs.size(); ++k) {
      graph_.nodes[graph_.arcs[k].from].arcs.push_back(static_cast<Index>(k));
      graph_.nodes[graph_.arcs[k].to].arcs.push_back(static_cast<Index>(k));
    }
    return std::move(graph_);
  }

 private:
  Index node_at(Index point, const BisectorPoint& shown) {
    if (node_of_[point] == no_index) {
      node_of_[point] = static_cast<Index>(graph_.nodes.size());
      graph_.nodes.push_back({shown.point, shown.clearance, {}});
    }
    return node_of_[point];
  }

  /// From a point along a piece and those that follow it, up to the next node or round to the start.
  void walk_from(Index start, Index piece) {
    if (done_[piece]) return;
    Arc arc;
    Index at = start;
    while (true) {
      done_[piece] = true;
      BisectorPiece& p = pieces_[piece];
      if (p.from != at) turn_round(p.points);
      at = p.from == at ? p.to : p.from;
      append(arc.points, std::move(p.points));
      if (at == start || at_[at].size() != 2) break;
      piece = at_[at][0] == piece ? at_[at][1] : at_[at][0];
    }
    arc.from = node_at(start, arc.points.front());
    arc.to = node_at(at, arc.points.back());
    graph_.arcs.push_back(std::move(arc));
  }

  std::vector<BisectorPiece> pieces_;
  std::vector<std::vector<Index>> at_;  // pieces at each point
  std::vector<char> done_;
  std::vector<Index> node_of_;
  BisectorGraph graph_;
};

/// Takes twigs off one at a time.
class Pruner {
 public:
  Pruner(const TriangleMesh& mesh, const BisectorGraph& graph, double ratio)
      : graph_(graph), ratio_(ratio), arcs_at_(graph.nodes.size()) {
    for (std::size_t k = 0; k < graph.arcs.size(); ++k) {
      lengths_.push_back(length_of_points(mesh, graph.arcs[k].points));
      arcs_at_[graph.arcs[k].from].insert(static_cast<Index>(k));
      arcs_at_[graph.arcs[k].to].insert(static_cast<Index>(k));
    }
  }

  BisectorGraph run() {
    for (std::size_t n = 0; n < arcs_at_.size(); ++n) consider_leaf(static_cast<Index>(n));
    while (!twigs_.empty()) {
      const auto [measure, leaf, arc] = *twigs_.begin();
      twigs_.erase(twigs_.begin());
      const Index inner = inner_end(leaf);
      // the others at its node may have gone since, or the twig may have grown
      if (inner == no_index || arcs_at_[inner].size() < 3 || *arcs_at_[leaf].begin() != arc) continue;
      if (lengths_[arc] >= ratio_ * graph_.nodes[inner].clearance) continue;
      arcs_at_[inner].erase(arc);
      arcs_at_[leaf].clear();
      if (arcs_at_[inner].size() != 2) continue;
      join_at(inner);
    }
    std::vector<BisectorPiece> kept;
    for (std::size_t k = 0; k < graph_.arcs.size(); ++k) {
      Arc& arc = graph_.arcs[k];
      if (arcs_at_[arc.from].contains(static_cast<Index>(k))) kept.push_back({arc.from, arc.to, std::move(arc.points)});
    }
    return ArcChains(graph_.nodes.size(), std::move(kept)).run();
  }

 private:
  /// The node that a leaf's arc leads to; none where it is no leaf.
  Index inner_end(Index leaf) const {
    if (arcs_at_[leaf].size() != 1) return no_index;
    const Arc& arc = graph_.arcs[*arcs_at_[leaf].begin()];
    return arc.from == arc.to ? no_index : arc.from == leaf ? arc.to : arc.from;
  }

  void consider_leaf(Index leaf) {
    const Index inner = inner_end(leaf);
    if (inner == no_index || arcs_at_[inner].size() < 3) return;
    const Index arc = *arcs_at_[leaf].begin();
    const double measure = lengths_[arc] / graph_.nodes[inner].clearance;
    if (measure < ratio_) twigs_.insert({measure, leaf, arc});
  }

  /// Makes one arc of the two at a node.
  void join_at(Index node) {
    const Index a = *arcs_at_[node].begin();
    const Index b = *std::next(arcs_at_[node].begin());
    Arc& first = graph_.arcs[a];
    Arc& second = graph_.arcs[b];
    if (first.from == first.to || second.from == second.to) return;
    if (first.to != node) {
      turn_round(first.points);
      std::swap(first.from, first.to);
    }
    if (second.from != node) {
      turn_round(second.points);
      std::swap(second.from, second.to);
    }
    append(first.points, std::move(second.points));
    lengths_[a] += lengths_[b];
    arcs_at_[node].clear();
    first.to = second.to;
    arcs_at_[first.to].erase(b);
    arcs_at_[first.to].insert(a);
    consider_leaf(first.from);
    consider_leaf(first.to);
  }

  BisectorGraph graph_;
  double ratio_;
  std::vector<double> lengths_;
  std::vector<std::set<Index>> arcs_at_;
  std::set<std::tuple<double, Index, Index>> twigs_;
};

}  // namespace

BisectorGraph chain_bisectors(const TriangleMesh& mesh, Index n_points, std::vector<BisectorPiece> pieces,
                              double shortest) {
  DisjointSets sets(static_cast<std::size_t>(n_points));
  std::erase_if(pieces, [&](const BisectorPiece& piece) {
    if (length_of_points(mesh, piece.points) > shortest) return false;
    sets.join(piece.from, piece.to);
    return true;
  });
  for (BisectorPiece& piece : pieces) {
    piece.from = sets.root(piece.from);
    piece.to = sets.root(piece.to);
  }
  return ArcChains(static_cast<std::size_t>(n_points), std::move(pieces)).run();
}

void check_prune_ratio(double ratio) {
  if (ratio >= 0 && ratio < infinity) return;
  throw Error(ErrorCode::bad_usage, "the length of twigs to prune is not a number",
              {.element = "prune", .value = fmt::format("{}", ratio), .advice = "allowed: 0 or more; 0 keeps all"});
}

BisectorGraph pruned(const TriangleMesh& mesh, const BisectorGraph& graph, double ratio) {
  check_prune_ratio(ratio);
  return Pruner(mesh, graph, ratio).run();
}

double length_of(const TriangleMesh& mesh, const Arc& arc) { return length_of_points(mesh, arc.points); }

}  // namespace isopath
