#include "isopath/mesh/local_numbering.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <numeric>

namespace isopath {
namespace {

/// A core's own cache of 1 MB holds about as many, of what methods keep for each. Neighbours that are farther apart are
/// rarely in it together.
constexpr Index halfedges_in_cache = 1 << 14;
constexpr Index vertices_in_cache = 1 << 12;
/// So many faces are looked at to tell whether neighbours are near.
constexpr Index sample = 2048;
constexpr int most_levels = 10;

bool is_scattered(const TriangleMesh& mesh) {
  const Index step = mesh.n_faces() / sample + 1;
  Index edges = 0;
  Index far_vertices = 0;
  Index pairs = 0;
  Index far_pairs = 0;
  // Whole faces: of single half-edges a regular grid might show those alone that lead to another row.
  for (Index face = 0; face < mesh.n_faces(); face += step) {
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      ++edges;
      if (std::abs(mesh.from(h) - mesh.to(h)) > vertices_in_cache) ++far_vertices;
      const Index twin = mesh.twin(h);
      if (twin == no_index) continue;
      ++pairs;
      if (std::abs(h - twin) > halfedges_in_cache) ++far_pairs;
    }
  }
  // In rows of a grid two of three neighbours of a vertex are in other rows, and of a face every third one.
  return 4 * far_vertices > 3 * edges || 2 * far_pairs > pairs;
}

/// Every third bit, from the lowest on.
std::uint32_t spread(std::uint32_t bits) {
  std::uint32_t spread = 0;
  for (int i = 0; i < most_levels; ++i) spread |= (bits >> i & 1U) << 3 * i;
  return spread;
}

/// Cubes of equal size, numbered along a curve that fills space.
class ZOrder {
 public:
  /// Few enough that there are no more of them than points to be sorted into them.
  ZOrder(const Box3& bounds, Index n_points) : low_(bounds.min()) {
    while (levels_ < most_levels && (Index(8) << 3 * levels_) <= n_points) ++levels_;
    const double size = bounds.sizes().maxCoeff();
    cubes_per_length_ = size > 0 ? (1U << levels_) / size : 0;
    for (std::uint32_t i = 0; i < n_along(); ++i) spread_[i] = spread(i);
  }
  std::size_t n_cubes() const { return std::size_t{1} << 3 * levels_; }
  std::uint32_t cube_of(const Vec3& point) const {
    const auto along = [&](int axis) {
      const auto cube = static_cast<std::uint32_t>((point[axis] - low_[axis]) * cubes_per_length_);
      return spread_[std::min(cube, n_along() - 1)];
    };
    return along(0) | along(1) << 1 | along(2) << 2;
  }

 private:
  std::uint32_t n_along() const { return 1U << levels_; }

  int levels_ = 0;
  Vec3 low_;
  double cubes_per_length_ = 0;
  std::array<std::uint32_t, 1 << most_levels> spread_{};
};

}  // namespace

template <class Key>
LocalNumbering::Numbers LocalNumbering::in_order_of(Index n, std::size_t n_keys, const Key& key) {
  Numbers numbers{std::vector<Index>(n), std::vector<Index>(n)};
  // first the keys, then the numbers
  tbb::parallel_for(Index(0), n, [&](Index i) { numbers.here[i] = static_cast<Index>(key(i)); });
  std::vector<Index> next(n_keys + 1, 0);
  for (const Index k : numbers.here) ++next[k + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (Index i = 0; i < n; ++i) {
    Index& here = numbers.here[i];
    here = next[here]++;
    numbers.in_mesh[here] = i;
  }
  return numbers;
}

LocalNumbering::LocalNumbering(const TriangleMesh& mesh) {
  if (!is_scattered(mesh)) return;
  const ZOrder curve(mesh.bounds(), mesh.n_vertices());
  vertices_ = in_order_of(mesh.n_vertices(), curve.n_cubes(), [&](Index v) { return curve.cube_of(mesh.position(v)); });
  const auto first_vertex = [&](Index f) {
    const auto& [a, b, c] = mesh.triangle(f);
    return std::min({vertices_.here[a], vertices_.here[b], vertices_.here[c]});
  };
  faces_ = in_order_of(mesh.n_faces(), static_cast<std::size_t>(mesh.n_vertices()), first_vertex);
}

}  // namespace isopath
