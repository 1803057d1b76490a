#include "isopath/mesh/edge_table.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace isopath {

EdgeTable::EdgeTable(std::span<const Triangle> triangles, std::size_t n_vertices) : triangles_(triangles) {
  // Counting sort by lower vertex, then a short sort among the half-edges of one vertex.
  const auto n = static_cast<Index>(3 * triangles.size());
  const auto lower = [&](Index h) { return std::min(from(h), to(h)); };
  const auto upper = [&](Index h) { return std::max(from(h), to(h)); };
  std::vector<Index> start(n_vertices + 1, 0);
  for (Index h = 0; h < n; ++h) ++start[lower(h) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  halfedges_.resize(n);
  {
    std::vector<Index> cursor(start.begin(), start.end() - 1);
    for (Index h = 0; h < n; ++h) halfedges_[cursor[lower(h)]++] = h;
  }
  begin_.reserve(n / 2 + 2);
  for (std::size_t v = 0; v < n_vertices; ++v) {
    std::sort(halfedges_.begin() + start[v], halfedges_.begin() + start[v + 1],
              [&](Index a, Index b) { return std::pair(upper(a), a) < std::pair(upper(b), b); });
    for (Index i = start[v]; i < start[v + 1]; ++i) {
      if (i == start[v] || upper(halfedges_[i]) != upper(halfedges_[i - 1])) begin_.push_back(i);
    }
  }
  begin_.push_back(n);
}

Pairing pair_simple_edges(const EdgeTable& edges, std::size_t n_triangles) {
  Pairing pairing(3 * n_triangles, no_index);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto group = edges[e];
    if (group.size() != 2) continue;
    pairing[group[0]] = group[1];
    pairing[group[1]] = group[0];
  }
  return pairing;
}

Orientation orient(std::span<const Triangle> triangles, const Pairing& pairing) {
  const auto n = static_cast<Index>(triangles.size());
  Orientation out{std::vector<char>(n, 0), std::vector<Index>(n, no_index), 0, {}};
  const auto from = [&](Index h) { return triangles[h / 3][h % 3]; };
  std::vector<Index> queue;
  for (Index seed = 0; seed < n; ++seed) {
    if (out.patch[seed] != no_index) continue;
    queue.assign(1, seed);
    out.patch[seed] = out.n_patches;
    std::size_t reversed = 0;
    for (std::size_t done = 0; done < queue.size(); ++done) {
      const Index f = queue[done];
      reversed += out.reverse[f] != 0;
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        const Index g = pairing[h];
        if (g == no_index) continue;
        // Neighbours agree when they run along their edge in opposite directions.
        const char wanted = static_cast<char>(out.reverse[f] ^ static_cast<char>(from(h) == from(g)));
        if (out.patch[g / 3] == no_index) {
          out.patch[g / 3] = out.n_patches;
          out.reverse[g / 3] = wanted;
          queue.push_back(g / 3);
        } else if (out.reverse[g / 3] != wanted && h < g) {
          out.conflicts.push_back(h);
        }
      }
    }
    if (2 * reversed > queue.size()) {
      for (const Index f : queue) out.reverse[f] ^= 1;
    }
    ++out.n_patches;
  }
  return out;
}

}  // namespace isopath
