#include "isopath/mesh/refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>

#include "isopath/core/error.h"

namespace isopath {
namespace {

/// Edges longer than so much of the longest are halved in one round. Fewer at a time as the triangles run out, so that
/// the edges that are left are as alike as can be.
constexpr std::array<double, 3> round_shares = {0.75, 0.9, 0.98};

class Refiner {
 public:
  explicit Refiner(const TriangleMesh& mesh) : positions_(mesh.soup().positions) {
    on_old_.resize(mesh.n_vertices());
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      if (mesh.outgoing(v) != no_index) on_old_[v] = point_at_vertex(mesh, v);
    }
    leaves_.reserve(mesh.n_faces());
    for (Index f = 0; f < mesh.n_faces(); ++f) {
      leaves_.push_back({mesh.triangle(f), f, {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}, 0});
    }
  }

  /// Splits what is wanted among the triangles not asked yet, then what has to follow. False when nothing was wanted.
  bool refine_once(const std::function<bool(const RefineTriangle&)>& wants_split, int max_levels) {
    std::vector<char> split(leaves_.size(), 0);
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      if (leaves_[i].asked || leaves_[i].level >= max_levels) continue;
      leaves_[i].asked = true;
      split[i] = wants_split(described(leaves_[i]));
    }
    if (std::find(split.begin(), split.end(), 1) == split.end()) return false;
    while (std::find(split.begin(), split.end(), 1) != split.end()) {
      split_red(split);
      split.assign(leaves_.size(), 0);
      for (std::size_t i = 0; i < leaves_.size(); ++i) split[i] = must_follow(leaves_[i]);
    }
    return true;
  }

  /// Halves every edge longer than `limit`. False, without a change, when there is none or when that would make more
  /// than `most_faces` triangles.
  bool halve_edges(double limit, std::size_t most_faces) {
    const auto n_long = [&](const Leaf& leaf) {
      int n = 0;
      for (int i = 0; i < 3; ++i) n += length_of(leaf, i) > limit;
      return n;
    };
    std::size_t more = 0;
    for (const Leaf& leaf : leaves_) more += static_cast<std::size_t>(n_long(leaf));
    if (more == 0 || leaves_.size() + more > most_faces) return false;
    std::vector<Leaf> next;
    next.reserve(leaves_.size() + more);
    for (const Leaf& leaf : leaves_) halve_sides(leaf, limit, next);
    leaves_ = std::move(next);
    middle_.clear();  // every triangle beside a halved edge was divided with it
    return true;
  }

  double longest_edge() const {
    double longest = 0;
    for (const Leaf& leaf : leaves_) {
      for (int i = 0; i < 3; ++i) longest = std::max(longest, length_of(leaf, i));
    }
    return longest;
  }

  RefinedMesh finish() {
    RefinedMesh out;
    TriangleSoup soup;
    for (const Leaf& leaf : leaves_) {
      const auto add = [&](const Triangle& triangle) {
        soup.triangles.push_back(triangle);
        out.old_face.push_back(leaf.face);
      };
      int i = 0;
      while (i < 3 && middle_of(leaf, i) == no_index) ++i;
      if (i == 3) {
        add(leaf.corner);
        continue;
      }
      const Index middle = middle_of(leaf, i);
      add({leaf.corner[i], middle, leaf.corner[(i + 2) % 3]});
      add({middle, leaf.corner[(i + 1) % 3], leaf.corner[(i + 2) % 3]});
    }
    soup.positions = std::move(positions_);
    out.mesh = TriangleMesh(std::move(soup));
    out.on_old = std::move(on_old_);
    return out;
  }

 private:
  struct Leaf {
    Triangle corner;
    Index face;
    std::array<Vec3, 3> barycentric;
    int level;
    bool asked = false;
  };

  RefineTriangle described(const Leaf& leaf) const {
    RefineTriangle out{leaf.face, leaf.barycentric, {}, leaf.level};
    for (int i = 0; i < 3; ++i) out.position[i] = positions_[leaf.corner[i]];
    return out;
  }

  double length_of(const Leaf& leaf, int i) const {
    return (positions_[leaf.corner[(i + 1) % 3]] - positions_[leaf.corner[i]]).norm();
  }

  /// The parts of a triangle whose sides above the limit are halved: corners are cut off, a quadrangle that is left is
  /// cut by its shorter diagonal.
  void halve_sides(const Leaf& leaf, double limit, std::vector<Leaf>& out) {
    std::vector<Index> ring;  // corners and middles in order
    std::vector<Vec3> at;
    std::vector<char> is_middle;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      ring.push_back(leaf.corner[i]);
      at.push_back(leaf.barycentric[i]);
      is_middle.push_back(0);
      if (!(length_of(leaf, i) > limit)) continue;
      at.emplace_back(0.5 * (leaf.barycentric[i] + leaf.barycentric[j]));
      ring.push_back(make_middle(leaf.corner[i], leaf.corner[j], {leaf.face, at.back()}));
      is_middle.push_back(1);
    }
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
      out.push_back({{ring[a], ring[b], ring[c]}, leaf.face, {at[a], at[b], at[c]}, leaf.level + 1});
    };
    const std::size_t n = ring.size();
    std::size_t first = 0;  // a corner between two middles, or else a middle
    while (n > 3 && n != 5 && !is_middle[first]) ++first;
    while (n == 5 && (is_middle[first] || !is_middle[(first + 4) % 5] || !is_middle[(first + 1) % 5])) ++first;
    const auto k = [&](std::size_t i) { return (first + i) % n; };
    if (n == 3) {
      out.push_back(leaf);
    } else if (n == 4) {
      add(k(0), k(1), k(2));
      add(k(0), k(2), k(3));
    } else if (n == 5) {
      add(k(4), k(0), k(1));
      const double one = (positions_[ring[k(1)]] - positions_[ring[k(3)]]).norm();
      const double other = (positions_[ring[k(2)]] - positions_[ring[k(4)]]).norm();
      if (one <= other) {
        add(k(1), k(2), k(3));
        add(k(1), k(3), k(4));
      } else {
        add(k(1), k(2), k(4));
        add(k(2), k(3), k(4));
      }
    } else {
      for (std::size_t i = 0; i < 6; i += 2) add(k(i), k(i + 1), k(i + 2));
      add(k(0), k(2), k(4));
    }
  }

  static std::uint64_t key(Index a, Index b) {
    const auto [low, high] = std::minmax(a, b);
    return static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high);
  }
  /// The midpoint of an edge, `no_index` while nobody has split it.
  Index middle(Index a, Index b) const {
    const auto found = middle_.find(key(a, b));
    return found == middle_.end() ? no_index : found->second;
  }
  Index middle_of(const Leaf& leaf, int i) const { return middle(leaf.corner[i], leaf.corner[(i + 1) % 3]); }

  /// Halving serves a triangle with one split edge whose halves are whole; any other has to be split in four.
  bool must_follow(const Leaf& leaf) const {
    int n_split = 0;
    for (int i = 0; i < 3; ++i) {
      const Index m = middle_of(leaf, i);
      if (m == no_index) continue;
      ++n_split;
      if (middle(leaf.corner[i], m) != no_index || middle(m, leaf.corner[(i + 1) % 3]) != no_index) return true;
    }
    return n_split > 1;
  }

  void split_red(const std::vector<char>& split) {
    const auto n = static_cast<std::size_t>(std::count(split.begin(), split.end(), 1));
    if (leaves_.size() + 3 * n > static_cast<std::size_t>(std::numeric_limits<Index>::max() / 6)) {
      throw Error(ErrorCode::bad_input, "refinement leads to too many triangles",
                  {.value = fmt::format("{} triangles", leaves_.size() + 3 * n),
                   .advice = "ask for fewer levels or a larger tolerance"});
    }
    std::vector<Leaf> next;
    next.reserve(leaves_.size() + 3 * n);
    for (std::size_t l = 0; l < leaves_.size(); ++l) {
      if (!split[l]) {
        next.push_back(leaves_[l]);
        continue;
      }
      const Leaf& leaf = leaves_[l];
      Triangle m{};
      std::array<Vec3, 3> b;
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        b[i] = 0.5 * (leaf.barycentric[i] + leaf.barycentric[j]);
        m[i] = make_middle(leaf.corner[i], leaf.corner[j], {leaf.face, b[i]});
      }
      for (int i = 0; i < 3; ++i) {
        const int k = (i + 2) % 3;
        next.push_back({{leaf.corner[i], m[i], m[k]}, leaf.face, {leaf.barycentric[i], b[i], b[k]}, leaf.level + 1});
      }
      next.push_back({m, leaf.face, b, leaf.level + 1});
    }
    leaves_ = std::move(next);
  }

  Index make_middle(Index a, Index b, const SurfacePoint& at) {
    const auto [found, fresh] = middle_.try_emplace(key(a, b), static_cast<Index>(positions_.size()));
    if (fresh) {
      positions_.push_back(0.5 * (positions_[a] + positions_[b]));
      on_old_.push_back(at);
    }
    return found->second;
  }

  std::vector<Vec3> positions_;
  std::vector<SurfacePoint> on_old_;
  std::vector<Leaf> leaves_;
  std::unordered_map<std::uint64_t, Index> middle_;
};

}  // namespace

RefinedMesh refine(const TriangleMesh& mesh, const std::function<bool(const RefineTriangle&)>& wants_split,
                   int max_levels) {
  if (max_levels < 0 || max_levels > 20) {
    throw Error(ErrorCode::bad_usage, "the number of refinement levels must lie between 0 and 20",
                {.element = "max_levels", .value = fmt::format("{}", max_levels)});
  }
  Refiner refiner(mesh);
  while (refiner.refine_once(wants_split, max_levels)) {
  }
  return refiner.finish();
}

RefinedMesh split_long_edges(const TriangleMesh& mesh, double longest, Index most_faces) {
  if (!(longest > 0)) {
    throw Error(ErrorCode::bad_usage, "the length that edges are split to must be above 0",
                {.element = "longest", .value = fmt::format("{}", longest)});
  }
  Refiner refiner(mesh);
  const auto most = static_cast<std::size_t>(std::max(most_faces, Index{0}));
  for (const double share : round_shares) {
    while (refiner.halve_edges(std::max(longest, share * refiner.longest_edge()), most)) {
    }
  }
  return refiner.finish();
}

RefinedMesh split_uniformly(const TriangleMesh& mesh) {
  return refine(
      mesh, [](const RefineTriangle&) { return true; }, 1);
}

}  // namespace isopath
