#include "isopath/field/face_trees.h"

#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include "isopath/field/face_part.h"
#include "isopath/field/way_back.h"

namespace isopath {
namespace {

/// Faces with fewer candidates are asked faster as they are.
constexpr std::size_t many = 48;
/// Parts with so few are not divided further.
constexpr std::size_t few = 32;
/// Nor those that are as small as their distance from the source: halves would keep most of what the whole has.
constexpr int most_halvings = 40;
/// A part that keeps so much of what is above it wins nothing by being a half; after so many of them in a row it is not
/// divided either: candidates that lie on each other stay together for ever, all along the line that they share.
constexpr double all_but_all = 0.9;
constexpr int most_in_vain = 12;
/// Halves of the first parts are divided at the same time.
constexpr int halvings_in_parallel = 5;
/// Distances are not known better than to this part of the model's size.
constexpr double rounding = 1e-10;

struct Tree {
  std::vector<FaceTrees::Node> nodes;
  std::vector<NearCandidate> candidates;
};

class TreeBuilder {
 public:
  TreeBuilder(const ExactFieldData& data, Index face, const Progress& progress)
      : data_(data), face_(face), progress_(progress) {
    const IntrinsicGeometry& geometry = data.geometry;
    const Vec2 apex = geometry.apex(3 * face);
    corners_ = {Vec3::Zero(), Vec3(geometry.length(3 * face), 0, 0), Vec3(apex.x(), apex.y(), 0)};
    for (int i = 0; i < 3; ++i) {
      const Index edge = data.mesh.edge_of(3 * face + i);
      windows_[i] = data.windows.of(edge);
      canonical_[i] = data.mesh.halfedge_of(edge) == 3 * face + i;
    }
  }

  Tree build() const {
    std::vector<NearCandidate> all;
    for (std::size_t k = 0; k < data_.sources_in(face_).size(); ++k) all.emplace_back(NearCandidate::in_face, k);
    for (unsigned i = 0; i < 3; ++i) {
      const Index h = 3 * face_ + static_cast<Index>(i);
      for (std::size_t k = 0; k < windows_[i].size(); ++k) {
        if (windows_[i][k].halfedge == h) all.emplace_back(i, k);
      }
    }
    Tree tree;
    divide(FacePart::whole(face_), all, infinity, 0, tree);
    return tree;
  }

 private:
  /// Adds a part and what it is divided into; `above` may hold what is nearest in it, and all of that up to `bound`.
  /// The halvings just before were `in_vain`.
  void divide(const FacePart& part, std::span<const NearCandidate> above, double bound, int in_vain, Tree& tree) const {
    progress_.checkpoint();
    const Vec3 centre = part.centre();
    const Ways ways = ways_from(centre, above);
    double nearest = ways.least;
    if (nearest > bound) nearest = best_way_back(data_, face_, centre).distance;
    const double radius = radius_of(corners_, part);
    const std::vector<NearCandidate> kept = no_longer_than(nearest + 2 * radius, above, ways);
    const double here = nearest + radius;
    const std::size_t node = tree.nodes.size();
    tree.nodes.emplace_back();
    const bool small = radius <= nearest;
    const auto n = static_cast<double>(above.size());
    in_vain = static_cast<double>(kept.size()) > all_but_all * n ? in_vain + 1 : 0;
    if (kept.size() <= few || small || part.depth >= most_halvings || in_vain > most_in_vain) {
      tree.nodes[node] = {Vec2::Zero(), here, static_cast<std::uint32_t>(tree.candidates.size()),
                          static_cast<std::uint32_t>(tree.candidates.size() + kept.size())};
      tree.candidates.insert(tree.candidates.end(), kept.begin(), kept.end());
      return;
    }
    std::vector<FacePart> halves;
    halve(corners_, part, halves);
    tree.nodes[node] = cut_between(halves[0]);
    if (part.depth < halvings_in_parallel) {
      Tree trees[2];
      tbb::parallel_invoke([&] { divide(halves[0], kept, here, in_vain, trees[0]); },
                           [&] { divide(halves[1], kept, here, in_vain, trees[1]); });
      tree.nodes[node].first = append(tree, trees[0]);
      tree.nodes[node].second = append(tree, trees[1]);
    } else {
      tree.nodes[node].first = static_cast<std::uint32_t>(tree.nodes.size());
      divide(halves[0], kept, here, in_vain, tree);
      tree.nodes[node].second = static_cast<std::uint32_t>(tree.nodes.size());
      divide(halves[1], kept, here, in_vain, tree);
    }
  }

  /// The line from the middle of the side that was cut to the corner opposite.
  FaceTrees::Node cut_between(const FacePart& half) const {
    const Vec2 outer = place_of(half.corner[0]);
    const Vec2 middle = place_of(half.corner[1]);
    const Vec2 way = place_of(half.corner[2]) - middle;
    Vec2 normal(-way.y(), way.x());
    if (normal.dot(outer - middle) < 0) normal = -normal;
    if (normal == Vec2::Zero()) normal = Vec2::UnitX();  // of a face without area: either half is as good
    return {normal, normal.dot(middle), 0, 0};
  }

  /// How long the ways by some candidates are.
  struct Ways {
    std::vector<double> length;  ///< squared for sources
    double least = infinity;     ///< of them and of those by the corners
  };

  Ways ways_from(const Vec3& centre, std::span<const NearCandidate> candidates) const {
    Vec2 on_edge[3];
    for (int i = 0; i < 3; ++i) {
      const Index h = 3 * face_ + i;
      on_edge[i] = data_.geometry.in_frame(h, centre);
      if (!canonical_[i]) on_edge[i] = Vec2(data_.geometry.length(h) - on_edge[i].x(), -on_edge[i].y());
    }
    const Vec2 place = place_of(centre);
    const auto sources = data_.sources_in(face_);
    Ways ways;
    ways.length.reserve(candidates.size());
    double least_squared = infinity;
    for (const NearCandidate candidate : candidates) {
      const unsigned i = candidate.where();
      const std::uint32_t k = candidate.number();
      const bool is_source = i == NearCandidate::in_face;
      const double way = is_source ? squared_distance(sources[k], place) : way_by(windows_[i][k], on_edge[i]);
      double& least = is_source ? least_squared : ways.least;
      least = std::min(least, way);
      ways.length.push_back(way);
    }
    ways.least = std::min(ways.least, std::sqrt(least_squared));
    for (int i = 0; i < 3; ++i) {
      const double way = data_.distance[data_.mesh.triangle(face_)[i]] + (place_of(Vec3::Unit(i)) - place).norm();
      ways.least = std::min(ways.least, way);
    }
    return ways;
  }

  std::vector<NearCandidate> no_longer_than(double most, std::span<const NearCandidate> candidates,
                                            const Ways& ways) const {
    const double limit = most + rounding * data_.geometry.size();
    std::vector<NearCandidate> kept;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const bool is_source = candidates[k].where() == NearCandidate::in_face;
      if (ways.length[k] <= (is_source ? limit * limit : limit)) kept.push_back(candidates[k]);
    }
    return kept;
  }

  Vec2 place_of(const Vec3& barycentric) const { return data_.geometry.in_frame(3 * face_, barycentric); }

  static std::uint32_t append(Tree& tree, const Tree& part) {
    const auto first = static_cast<std::uint32_t>(tree.nodes.size());
    const auto first_candidate = static_cast<std::uint32_t>(tree.candidates.size());
    for (FaceTrees::Node node : part.nodes) {
      const std::uint32_t shift = node.normal == Vec2::Zero() ? first_candidate : first;
      node.first += shift;
      node.second += shift;
      tree.nodes.push_back(node);
    }
    tree.candidates.insert(tree.candidates.end(), part.candidates.begin(), part.candidates.end());
    return first;
  }

  const ExactFieldData& data_;
  Index face_;
  const Progress& progress_;
  FaceCorners corners_;
  std::span<const Window> windows_[3];
  bool canonical_[3];
};

std::size_t candidates_of(const ExactFieldData& data, Index face) {
  std::size_t count = data.sources_in(face).size();
  for (Index h = 3 * face; h < 3 * face + 3; ++h) count += data.windows.of(data.mesh.edge_of(h)).size();
  return count;
}

}  // namespace

FaceTrees::FaceTrees(const ExactFieldData& data, const Progress& progress) {
  std::vector<Index> faces;
  for (Index f = 0; f < data.mesh.n_faces(); ++f) {
    if (candidates_of(data, f) >= many && !lies_flat(data.geometry, f)) faces.push_back(f);
  }
  if (faces.empty()) return;
  tree_.assign(data.mesh.n_faces(), no_index);
  nodes_.resize(faces.size());
  candidates_.resize(faces.size());
  tbb::parallel_for(std::size_t{0}, faces.size(), [&](std::size_t k) {
    Tree tree = TreeBuilder(data, faces[k], progress).build();
    nodes_[k] = std::move(tree.nodes);
    candidates_[k] = std::move(tree.candidates);
  });
  for (std::size_t k = 0; k < faces.size(); ++k) tree_[faces[k]] = static_cast<Index>(k);
}

std::optional<FaceTrees::Part> FaceTrees::part_at(Index face, const Vec2& p) const {
  if (tree_.empty() || tree_[face] == no_index) return std::nullopt;
  const std::vector<Node>& nodes = nodes_[tree_[face]];
  const Node* node = nodes.data();
  while (node->normal != Vec2::Zero())
    node = nodes.data() + (node->normal.dot(p) > node->offset ? node->first : node->second);
  const NearCandidate* first = candidates_[tree_[face]].data();
  return Part{{first + node->first, first + node->second}, node->offset};
}

}  // namespace isopath
