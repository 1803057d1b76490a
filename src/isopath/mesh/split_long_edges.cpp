#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "isopath/core/error.h"
#include "isopath/mesh/edge_middles.h"
#include "isopath/mesh/refine.h"

namespace isopath {
namespace {

/// Edges longer than so much of the longest are halved in one round. Fewer at a time as the triangles run out, so that
/// the edges that are left are as alike as can be.
constexpr std::array<double, 3> round_shares = {0.75, 0.9, 0.98};

/// Rounds are many, and most triangles have no part in most of them: these are told by their longest side alone and
/// stay where they are in memory.
class EdgeHalver {
 public:
  explicit EdgeHalver(const TriangleMesh& mesh) : positions_(mesh.soup().positions) {
    on_old_.resize(mesh.n_vertices());
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      if (mesh.outgoing(v) != no_index) on_old_[v] = point_at_vertex(mesh, v);
    }
    for (Index f = 0; f < mesh.n_faces(); ++f)
      add({mesh.triangle(f), f, {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}}, now_);
  }

  /// Halves every edge longer than `limit`. False, without a change, when there is none or when that would make more
  /// than `most_faces` triangles.
  bool halve_edges(double limit, std::size_t most_faces) {
    std::size_t more = 0;
    for (const InOrder& triangle : now_) {
      if (!(triangle.longest > limit)) continue;
      for (int i = 0; i < 3; ++i) more += length_of(triangles_[triangle.number], i) > limit;
    }
    if (more == 0 || now_.size() + more > most_faces) return false;
    next_.clear();
    next_.reserve(now_.size() + more);
    for (const InOrder& triangle : now_) {
      if (triangle.longest > limit) {
        halve_sides(Part(triangles_[triangle.number]), limit);
      } else {
        next_.push_back(triangle);
      }
    }
    now_.swap(next_);
    middles_.clear();  // every triangle beside a halved edge was divided with it
    return true;
  }

  double longest_edge() const {
    double longest = 0;
    for (const InOrder& triangle : now_) longest = std::max(longest, triangle.longest);
    return longest;
  }

  RefinedMesh finish() {
    RefinedMesh out;
    TriangleSoup soup;
    soup.triangles.reserve(now_.size());
    out.old_face.reserve(now_.size());
    for (const InOrder& triangle : now_) {
      soup.triangles.push_back(triangles_[triangle.number].corner);
      out.old_face.push_back(triangles_[triangle.number].face);
    }
    soup.positions = std::move(positions_);
    out.mesh = TriangleMesh(std::move(soup));
    out.on_old = std::move(on_old_);
    return out;
  }

 private:
  struct Part {
    Triangle corner;
    Index face;
    std::array<Vec3, 3> barycentric;
  };
  /// A triangle that has not been divided.
  struct InOrder {
    double longest;
    std::size_t number;
  };

  double length_of(const Part& part, int i) const {
    return (positions_[part.corner[(i + 1) % 3]] - positions_[part.corner[i]]).norm();
  }

  void add(const Part& part, std::vector<InOrder>& order) {
    order.push_back({std::max({length_of(part, 0), length_of(part, 1), length_of(part, 2)}), triangles_.size()});
    triangles_.push_back(part);
  }

  /// The parts of a triangle whose sides above the limit are halved: corners are cut off, a quadrangle that is left is
  /// cut by its shorter diagonal.
  void halve_sides(const Part& part, double limit) {
    std::array<Index, 6> ring{};  // corners and middles in order
    std::array<Vec3, 6> at;
    std::array<bool, 6> is_middle{};
    std::size_t n = 0;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      ring[n] = part.corner[i];
      at[n++] = part.barycentric[i];
      if (!(length_of(part, i) > limit)) continue;
      at[n] = 0.5 * (part.barycentric[i] + part.barycentric[j]);
      ring[n] = make_middle(part.corner[i], part.corner[j], {part.face, at[n]});
      is_middle[n++] = true;
    }
    std::size_t first = 0;  // a corner between two middles, or else a middle
    while (n != 5 && !is_middle[first]) ++first;
    while (n == 5 && (is_middle[first] || !is_middle[(first + 4) % 5] || !is_middle[(first + 1) % 5])) ++first;
    const auto add_part = [&](std::size_t i, std::size_t j, std::size_t k) {
      const std::size_t a = (first + i) % n;
      const std::size_t b = (first + j) % n;
      const std::size_t c = (first + k) % n;
      add({{ring[a], ring[b], ring[c]}, part.face, {at[a], at[b], at[c]}}, next_);
    };
    const auto diagonal = [&](std::size_t i, std::size_t j) {
      return (positions_[ring[(first + i) % n]] - positions_[ring[(first + j) % n]]).norm();
    };
    if (n == 4) {
      add_part(0, 1, 2);
      add_part(0, 2, 3);
    } else if (n == 5) {
      add_part(4, 0, 1);
      if (diagonal(1, 3) <= diagonal(2, 4)) {
        add_part(1, 2, 3);
        add_part(1, 3, 4);
      } else {
        add_part(1, 2, 4);
        add_part(2, 3, 4);
      }
    } else {
      for (std::size_t i = 0; i < 6; i += 2) add_part(i, i + 1, i + 2);
      add_part(0, 2, 4);
    }
  }

  Index make_middle(Index a, Index b, const SurfacePoint& at) { return middles_.make(a, b, at, positions_, on_old_); }

  std::vector<Vec3> positions_;
  std::vector<SurfacePoint> on_old_;
  std::vector<Part> triangles_;  ///< and those that have been divided
  std::vector<InOrder> now_;
  std::vector<InOrder> next_;
  EdgeMiddles middles_;
};

}  // namespace

RefinedMesh split_long_edges(const TriangleMesh& mesh, double longest, Index most_faces) {
  if (!(longest > 0)) {
    throw Error(ErrorCode::bad_usage, "the length that edges are split to must be above 0",
                {.element = "longest", .value = fmt::format("{}", longest)});
  }
  EdgeHalver halver(mesh);
  const auto most = static_cast<std::size_t>(std::max(most_faces, Index{0}));
  for (const double share : round_shares) {
    while (halver.halve_edges(std::max(longest, share * halver.longest_edge()), most)) {
    }
  }
  return halver.finish();
}

}  // namespace isopath
