#include <algorithm>
#include <cstdint>
#include <unordered_set>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/mesh/repair_steps.h"
#include "isopath/mesh/triangle_mesh.h"
#include "isopath/mesh/triangle_shape.h"

namespace isopath {
namespace {

std::uint64_t edge_key(Index a, Index b) {
  const auto [low, high] = std::minmax({a, b});
  return static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high);
}

/// Least-area triangulation of a closed polygon in space by dynamic programming over its diagonals (Barequet & Sharir
/// 1995). A diagonal that is already an edge of the mesh is not allowed: it would get a third triangle.
class PolygonFiller {
 public:
  PolygonFiller(const std::vector<Vec3>& positions, std::vector<Index> polygon,
                const std::unordered_set<std::uint64_t>& edges)
      : positions_(positions), polygon_(std::move(polygon)), n_(polygon_.size()), area_(n_ * n_, 0), best_(n_ * n_, 0) {
    for (std::size_t width = 2; width < n_; ++width) {
      for (std::size_t i = 0; i + width < n_; ++i) solve(i, i + width, edges);
    }
  }

  bool found() const { return area_[n_ - 1] < infinity; }

  std::vector<Triangle> triangles() const {
    std::vector<Triangle> out;
    std::vector<std::pair<std::size_t, std::size_t>> stack{{0, n_ - 1}};
    while (!stack.empty()) {
      const auto [i, k] = stack.back();
      stack.pop_back();
      if (k - i < 2) continue;
      const std::size_t j = best_[i * n_ + k];
      out.push_back({polygon_[i], polygon_[j], polygon_[k]});
      stack.emplace_back(i, j);
      stack.emplace_back(j, k);
    }
    return out;
  }

 private:
  void solve(std::size_t i, std::size_t k, const std::unordered_set<std::uint64_t>& edges) {
    double& least = area_[i * n_ + k];
    least = infinity;
    const bool side = i == 0 && k == n_ - 1;
    if (!side && edges.contains(edge_key(polygon_[i], polygon_[k]))) return;
    for (std::size_t j = i + 1; j < k; ++j) {
      const double parts = area_[i * n_ + j] + area_[j * n_ + k];
      if (parts >= least) continue;
      const double sum =
          parts + shape_of(positions_[polygon_[i]], positions_[polygon_[j]], positions_[polygon_[k]]).area();
      if (sum < least) {
        least = sum;
        best_[i * n_ + k] = j;
      }
    }
  }

  const std::vector<Vec3>& positions_;
  std::vector<Index> polygon_;
  std::size_t n_;
  std::vector<double> area_;
  std::vector<std::size_t> best_;
};

/// The polygon to fill, with the side that the surface needs; empty when the loop stays open.
std::vector<Index> hole_polygon(const TriangleMesh& mesh, const std::vector<Index>& loop, double longest,
                                Index most_edges) {
  if (static_cast<Index>(loop.size()) > most_edges) return {};
  double length = 0;
  for (const Index h : loop) length += mesh.edge_length(mesh.edge_of(h));
  // A loop of three around a single triangle is its rim; filling it would put the triangle there twice.
  const bool rim = loop.size() == 3 && std::all_of(loop.begin(), loop.end(), [&](Index h) {
                     return TriangleMesh::face_of(h) == TriangleMesh::face_of(loop[0]);
                   });
  if (length > longest || rim) return {};
  std::vector<Index> polygon;
  for (const Index h : loop) polygon.push_back(mesh.from(h));
  std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

}  // namespace

void fill_holes(RepairState& state, double longest, Index most_edges, Progress& progress) {
  const TriangleMesh mesh(state.soup);
  std::unordered_set<std::uint64_t> edges;
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    const Index h = mesh.halfedge_of(e);
    edges.insert(edge_key(mesh.from(h), mesh.to(h)));
  }
  std::size_t filled = 0;
  for (const auto& loop : mesh.boundary_loops()) {
    progress.checkpoint();
    const std::vector<Index> polygon = hole_polygon(mesh, loop, longest, most_edges);
    if (polygon.empty()) continue;
    const PolygonFiller filler(state.soup.positions, polygon, edges);
    std::vector<Triangle> patch;
    if (filler.found()) {
      patch = filler.triangles();
    } else {
      // No triangulation without a doubled edge: a fan around the middle always works.
      Vec3 middle = Vec3::Zero();
      for (const Index v : polygon) middle += state.soup.positions[v] / static_cast<double>(polygon.size());
      const Index centre = state.add_vertex(middle, Vec3::Zero());
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        patch.push_back({polygon[i], polygon[(i + 1) % polygon.size()], centre});
      }
    }
    for (const auto& [a, b, c] : patch) {
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
        edges.insert(edge_key(from, to));
      }
      state.soup.triangles.push_back({a, b, c});
    }
    ++filled;
  }
  state.note("holes filled", filled);
}

}  // namespace isopath
