#include "isopath/mesh/refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/mesh/edge_middles.h"

namespace isopath {
namespace {

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

  Index middle_of(const Leaf& leaf, int i) const { return middles_.find(leaf.corner[i], leaf.corner[(i + 1) % 3]); }

  /// Halving serves a triangle with one split edge whose halves are whole; any other has to be split in four.
  bool must_follow(const Leaf& leaf) const {
    int n_split = 0;
    for (int i = 0; i < 3; ++i) {
      const Index m = middle_of(leaf, i);
      if (m == no_index) continue;
      ++n_split;
      if (middles_.find(leaf.corner[i], m) != no_index || middles_.find(m, leaf.corner[(i + 1) % 3]) != no_index)
        return true;
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

  Index make_middle(Index a, Index b, const SurfacePoint& at) { return middles_.make(a, b, at, positions_, on_old_); }

  std::vector<Vec3> positions_;
  std::vector<SurfacePoint> on_old_;
  std::vector<Leaf> leaves_;
  EdgeMiddles middles_;
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

void RefinementTrail::add(const TriangleMesh& mesh, const RefinedMesh& refined) {
  std::vector<Part> parts(refined.old_face.size());
  for (std::size_t f = 0; f < parts.size(); ++f) {
    const Index old = refined.old_face[f];
    parts[f].face = old;
    for (int i = 0; i < 3; ++i) {
      const Index v = refined.mesh.triangle(static_cast<Index>(f))[i];
      const SurfacePoint corner = on_first({old, express_in(mesh, refined.on_old[v], old).barycentric});
      parts[f].face = corner.face;
      parts[f].corners[i] = corner.barycentric;
    }
  }
  parts_ = std::move(parts);
}

SurfacePoint RefinementTrail::on_first(const SurfacePoint& point) const {
  if (parts_.empty() || !point.valid()) return point;
  const Part& part = parts_[point.face];
  const Vec3& b = point.barycentric;
  return {part.face, b[0] * part.corners[0] + b[1] * part.corners[1] + b[2] * part.corners[2]};
}

RefinedMesh composed(const TriangleMesh& mesh, const RefinedMesh& first, RefinedMesh second) {
  RefinementTrail trail;
  trail.add(mesh, first);
  for (SurfacePoint& point : second.on_old) point = trail.on_first(point);
  for (Index& face : second.old_face) face = first.old_face[face];
  return second;
}

RefinedMesh split_uniformly(const TriangleMesh& mesh) {
  return refine(
      mesh, [](const RefineTriangle&) { return true; }, 1);
}

}  // namespace isopath
