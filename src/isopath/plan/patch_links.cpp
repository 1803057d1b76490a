#include "isopath/plan/patch_links.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "isopath/impact/curve_assembly.h"
#include "isopath/impact/stroke_order.h"

namespace isopath {
namespace {

using Stretch = std::vector<ImpactPoint>;

/// Links and lifts as inside a patch.
constexpr double longest_link_in_spacings = 8;
constexpr double lift_cost_in_spacings = 20;
/// Passes on the two sides of a border lie a spacing apart; corners and evened spacings take them a little farther.
constexpr double widest_joint_in_spacings = 1.6;
/// The way between them over the surface.
constexpr double longest_joint_in_spacings = 3;

/// Where two curves run side by side.
struct Joint {
  double distance = infinity;
  std::array<Index, 2> curve{};
  std::array<ImpactPoint, 2> at;
};

/// A point's kind is that of the move that arrives at it, from the other side in the way back.
void turn_round(Stretch& stretch) {
  for (std::size_t i = 0; i + 1 < stretch.size(); ++i) stretch[i].kind = stretch[i + 1].kind;
  std::reverse(stretch.begin(), stretch.end());
}

void turn_round(PatchCurve& curve) {
  std::reverse(curve.stretches.begin(), curve.stretches.end());
  for (Stretch& stretch : curve.stretches) turn_round(stretch);
}

std::size_t nearest_to(const Stretch& stretch, const Vec3& place) {
  std::size_t best = 0;
  double least = infinity;
  for (std::size_t i = 0; i < stretch.size(); ++i) {
    const double distance = (stretch[i].position - place).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best = i;
  }
  return best;
}

/// Makes a closed curve start at its point nearest to a place.
void start_near(PatchCurve& curve, const Vec3& place) {
  Stretch& stretch = curve.stretches.front();
  const auto first = static_cast<std::ptrdiff_t>(nearest_to(stretch, place));
  Stretch turned(stretch.begin() + first, stretch.end());
  turned.insert(turned.end(), stretch.begin() + 1, stretch.begin() + first + 1);
  stretch = std::move(turned);
}

std::vector<Gate> gates_of(const PatchCurve& curve) {
  std::vector<Vec3> places;
  for (const Stretch& stretch : curve.stretches) {
    for (const auto& point : stretch) places.push_back(point.position);
  }
  return gates_of_curve(places, curve.closed);
}

/// The covering points of curves in cells, to find what lies near.
class PointGrid {
 public:
  explicit PointGrid(double cell) : cell_(cell) {}

  void add(Index curve, const ImpactPoint& point) { cells_[cell_of(point.position)].emplace_back(curve, &point); }
  template <class Visit>
  void visit_near(const Vec3& place, const Visit& visit) const {
    const Cell at = cell_of(place);
    for (int k = 0; k < 27; ++k) {
      const auto found = cells_.find({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
      if (found == cells_.end()) continue;
      for (const auto& [curve, point] : found->second) visit(curve, *point);
    }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell_of(const Vec3& p) const {
    return {std::llround(p.x() / cell_), std::llround(p.y() / cell_), std::llround(p.z() / cell_)};
  }
  double cell_;
  std::map<Cell, std::vector<std::pair<Index, const ImpactPoint*>>> cells_;
};

class Chainer {
 public:
  Chainer(const TriangleMesh& mesh, std::vector<PatchCurve> curves, const PatchLinkOptions& options, Progress& progress)
      : mesh_(mesh),
        curves_(std::move(curves)),
        spacing_(options.spacing),
        clearance_(options.clearance > 0 ? options.clearance : options.spacing),
        progress_(progress),
        locator_(mesh),
        normals_(mesh),
        linker_(mesh, locator_, progress),
        assembly_(linker_, normals_, {longest_link_in_spacings * spacing_, clearance_}),
        children_(curves_.size()) {}

  PatchChain run(std::span<const Index> patch_of_face) {
    const std::vector<Index> roots = hang_together(joints(patch_of_face));
    std::vector<std::vector<Gate>> gates;
    for (const Index root : roots) gates.push_back(gates_of(curves_[root]));
    const std::vector<Visit> visits =
        order_runs(gates, longest_link_in_spacings * spacing_, lift_cost_in_spacings * spacing_, progress_);
    for (const Visit& visit : visits) {
      PatchCurve& curve = curves_[roots[visit.run]];
      if (curve.closed && !assembly_.empty()) start_near(curve, assembly_.end());
      if (!curve.closed && visit.gate == 1) turn_round(curve);
      walk(roots[visit.run]);
    }
    return {assembly_.take(), std::move(order_), assembly_.blocked_lifts()};
  }

 private:
  /// For every pair of neighbouring patches the place where their curves are nearest, the nearest pairs first.
  std::vector<Joint> joints(std::span<const Index> patch_of_face) const {
    std::set<std::pair<Index, Index>> neighbours;
    for (Index h = 0; h < mesh_.n_halfedges(); ++h) {
      if (mesh_.twin(h) == no_index) continue;
      const Index p = patch_of_face[TriangleMesh::face_of(h)];
      const Index q = patch_of_face[TriangleMesh::face_of(mesh_.twin(h))];
      if (p < q) neighbours.emplace(p, q);
    }
    PointGrid grid(widest_joint_in_spacings * spacing_);
    std::map<std::pair<Index, Index>, Joint> nearest;
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      for (const Stretch& stretch : curves_[c].stretches) {
        for (const ImpactPoint& point : stretch) {
          progress_.checkpoint();
          grid.visit_near(point.position, [&](Index other, const ImpactPoint& there) {
            const std::pair key = std::minmax(curves_[other].patch, curves_[c].patch);
            const double distance = (there.position - point.position).norm();
            if (distance > widest_joint_in_spacings * spacing_ || neighbours.count(key) == 0) return;
            Joint& best = nearest[key];
            if (distance < best.distance) best = {distance, {other, static_cast<Index>(c)}, {there, point}};
          });
        }
      }
      for (const Stretch& stretch : curves_[c].stretches) {
        for (std::size_t i = 1; i < stretch.size(); ++i) {
          if (stretch[i].kind == MoveKind::cover) grid.add(static_cast<Index>(c), stretch[i]);
        }
      }
    }
    std::vector<Joint> sorted;
    for (const auto& [key, joint] : nearest) sorted.push_back(joint);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Joint& a, const Joint& b) { return a.distance < b.distance; });
    return sorted;
  }

  /// Makes trees of curves that can be walked in one go: only a root may be open. Returns the roots.
  std::vector<Index> hang_together(const std::vector<Joint>& joints) {
    std::vector<Index> tree(curves_.size());
    std::iota(tree.begin(), tree.end(), 0);
    const auto find = [&](Index c) {
      while (tree[c] != c) c = tree[c];
      return c;
    };
    std::vector<std::vector<const Joint*>> used(curves_.size());
    for (const Joint& joint : joints) {
      Index a = find(joint.curve[0]);
      Index b = find(joint.curve[1]);
      if (a == b || (!curves_[a].closed && !curves_[b].closed)) continue;
      if (!linker_.link(joint.at[0].at, joint.at[1].at, longest_joint_in_spacings * spacing_)) continue;
      if (!curves_[b].closed || (curves_[a].closed && b < a)) std::swap(a, b);  // an open root stays the root
      tree[b] = a;
      for (const Index c : joint.curve) used[c].push_back(&joint);
    }
    std::vector<Index> roots;
    for (Index c = 0; c < static_cast<Index>(curves_.size()); ++c) {
      if (find(c) != c) continue;
      roots.push_back(c);
      std::vector<std::pair<Index, const Joint*>> open = {{c, nullptr}};
      while (!open.empty()) {
        const auto [curve, from] = open.back();
        open.pop_back();
        for (const Joint* joint : used[curve]) {
          if (joint == from) continue;
          const int here = joint->curve[0] == curve ? 0 : 1;
          children_[curve].push_back({joint->curve[1 - here], joint->at[here].position, joint->at[1 - here].position});
          open.emplace_back(joint->curve[1 - here], joint);
        }
      }
    }
    return roots;
  }

  /// Where a curve is left for another one, and where that is entered.
  struct Child {
    Index curve = no_index;
    Vec3 leave = Vec3::Zero();
    Vec3 enter = Vec3::Zero();
  };

  /// Goes along a curve with all the excursions from it.
  void walk(Index c) {
    progress_.checkpoint();
    order_.push_back(c);
    const PatchCurve& curve = curves_[c];
    std::map<std::pair<std::size_t, std::size_t>, std::vector<const Child*>> at;  // by stretch and point
    for (const Child& child : children_[c]) {
      std::pair<std::size_t, std::size_t> best;
      double least = infinity;
      for (std::size_t s = 0; s < curve.stretches.size(); ++s) {
        const std::size_t i = nearest_to(curve.stretches[s], child.leave);
        const double distance = (curve.stretches[s][i].position - child.leave).norm();
        if (distance >= least) continue;
        least = distance;
        best = {s, i};
      }
      at[best].push_back(&child);
    }
    for (std::size_t s = 0; s < curve.stretches.size(); ++s) {
      const std::span<const ImpactPoint> stretch = curve.stretches[s];
      std::size_t from = 0;
      for (auto leave = at.lower_bound({s, 0}); leave != at.end() && leave->first.first == s; ++leave) {
        const std::size_t i = leave->first.second;
        assembly_.add_stretch(stretch.subspan(from, i + 1 - from));
        for (const Child* child : leave->second) {
          start_near(curves_[child->curve], child->enter);
          walk(child->curve);
        }
        from = i;
      }
      assembly_.add_stretch(stretch.subspan(from));
    }
  }

  const TriangleMesh& mesh_;
  std::vector<PatchCurve> curves_;
  double spacing_;
  double clearance_;
  Progress& progress_;
  SurfaceLocator locator_;
  SmoothNormals normals_;
  SurfaceLinker linker_;
  CurveAssembly assembly_;
  std::vector<std::vector<Child>> children_;
  std::vector<Index> order_;
};

}  // namespace

PatchChain chain_patches(const TriangleMesh& mesh, std::span<const Index> patch_of_face, std::vector<PatchCurve> curves,
                         const PatchLinkOptions& options, Progress& progress) {
  return Chainer(mesh, std::move(curves), options, progress).run(patch_of_face);
}

}  // namespace isopath
