#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "isopath/mesh/edge_table.h"
#include "isopath/mesh/repair_steps.h"

namespace isopath {
namespace {

/// Decides which triangles stay glued at edges where more than two meet.
class EdgePairer {
 public:
  EdgePairer(const TriangleSoup& soup, const EdgeTable& edges, const Orientation& orientation)
      : soup_(soup), edges_(edges), orientation_(orientation) {}

  /// Greedily: consistent pairs before inconsistent ones (which need another patch to be reversed), then the flattest,
  /// then the one that encloses less.
  void pair(std::span<const Index> group, Pairing& pairing) const {
    std::vector<Fan> fans;
    for (const Index h : group) fans.push_back(describe(h));
    std::vector<std::tuple<bool, double, double, std::size_t, std::size_t>> choices;
    for (std::size_t i = 0; i < fans.size(); ++i) {
      for (std::size_t j = i + 1; j < fans.size(); ++j) {
        const bool agree = fans[i].forward != fans[j].forward;
        if (!agree && fans[i].patch == fans[j].patch) continue;
        const Fan& front = fans[i].forward ? fans[i] : fans[j];
        const Fan& back = fans[i].forward ? fans[j] : fans[i];
        // The inside lies behind the normal: clockwise from the triangle that runs forward along the edge.
        double wedge = front.angle - back.angle;
        if (wedge <= 0) wedge += 2 * std::numbers::pi;
        // Rounded, so that equal angles of a regular arrangement tie whatever their last bits.
        const auto rounded = [](double angle) { return std::round(angle * 1e6); };
        choices.emplace_back(!agree, rounded(std::abs(wedge - std::numbers::pi)), rounded(wedge), i, j);
      }
    }
    std::sort(choices.begin(), choices.end());
    for (const auto& [disagree, bend, wedge, i, j] : choices) {
      if (pairing[group[i]] != no_index || pairing[group[j]] != no_index) continue;
      pairing[group[i]] = group[j];
      pairing[group[j]] = group[i];
    }
  }

 private:
  struct Fan {
    double angle = 0;      ///< of the triangle around the edge, from a common direction
    bool forward = false;  ///< runs from the edge's lower to its upper vertex
    Index patch = no_index;
  };

  Fan describe(Index h) const {
    const auto [low, high] = std::minmax({edges_.from(h), edges_.to(h)});
    const Vec3 axis = (soup_.positions[high] - soup_.positions[low]).stableNormalized();
    int smallest = 0;
    axis.cwiseAbs().minCoeff(&smallest);
    const Vec3 u = axis.cross(Vec3::Unit(smallest)).normalized();
    const Vec3 v = axis.cross(u);
    const Vec3 inward = soup_.positions[soup_.triangles[h / 3][(h % 3 + 2) % 3]] - soup_.positions[low];
    const bool forward = (edges_.from(h) == low) != (orientation_.reverse[h / 3] != 0);
    return {std::atan2(inward.dot(v), inward.dot(u)), forward, orientation_.patch[h / 3]};
  }

  const TriangleSoup& soup_;
  const EdgeTable& edges_;
  const Orientation& orientation_;
};

/// Reverses whole closed patches that needed a repair of their orientation, so that they face outward.
void face_outward(const TriangleSoup& soup, const Pairing& pairing, Orientation& orientation) {
  std::vector<char> eligible(orientation.n_patches, 1);
  for (const Index h : orientation.conflicts) eligible[orientation.patch[h / 3]] = 0;
  std::vector<char> touched(orientation.n_patches, 0);
  std::vector<double> volume(orientation.n_patches, 0);
  std::vector<Index> origin(orientation.n_patches, no_index);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const Index patch = orientation.patch[t];
    if (orientation.reverse[t]) touched[patch] = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      if (pairing[3 * t + i] == no_index) eligible[patch] = 0;
    }
    const auto& [a, b, c] = soup.triangles[t];
    if (origin[patch] == no_index) origin[patch] = a;
    const Vec3& o = soup.positions[origin[patch]];
    const Vec3 normal = (soup.positions[b] - o).cross(soup.positions[c] - o);
    volume[patch] += (orientation.reverse[t] ? -1 : 1) * (soup.positions[a] - o).dot(normal);
  }
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const Index patch = orientation.patch[t];
    if (eligible[patch] && touched[patch] && volume[patch] < 0) orientation.reverse[t] ^= 1;
  }
}

/// Gives every fan of glued triangles around a vertex a vertex of its own.
void split_vertices(RepairState& state, const Pairing& pairing, double separation) {
  std::vector<Vec3>& positions = state.soup.positions;
  std::vector<Triangle>& triangles = state.soup.triangles;
  const auto n_corners = static_cast<Index>(3 * triangles.size());
  const auto vertex = [&](Index corner) { return triangles[corner / 3][corner % 3]; };
  DisjointSets fans(n_corners);
  for (Index h = 0; h < n_corners; ++h) {
    const Index g = pairing[h];
    if (g == no_index || g < h) continue;
    const Index h_end = h % 3 == 2 ? h - 2 : h + 1;
    const Index g_end = g % 3 == 2 ? g - 2 : g + 1;
    const bool opposite = vertex(h) == vertex(g_end);
    fans.join(h, opposite ? g_end : g);
    fans.join(h_end, opposite ? g : g_end);
  }
  std::vector<Index> size(n_corners, 0);
  for (Index c = 0; c < n_corners; ++c) ++size[fans.root(c)];
  std::vector<Index> largest(positions.size(), no_index);
  for (Index c = 0; c < n_corners; ++c) {
    Index& best = largest[vertex(c)];
    if (size[c] > 0 && (best == no_index || size[c] > size[best])) best = c;
  }
  std::vector<std::pair<Index, Index>> apart;  // the roots of the other fans, and the vertex that each leaves
  for (Index c = 0; c < n_corners; ++c) {
    if (size[c] > 0 && largest[vertex(c)] != c) apart.emplace_back(c, vertex(c));
  }
  if (apart.empty()) return;

  // The copies move towards the middle of their fans.
  std::vector<Vec3> sum(n_corners, Vec3::Zero());
  std::vector<double> nearest(n_corners, infinity);
  for (Index c = 0; c < n_corners; ++c) {
    const Index root = fans.root(c);
    for (const Index other : {c % 3 == 2 ? c - 2 : c + 1, c % 3 == 0 ? c + 2 : c - 1}) {
      const Vec3 edge = positions[vertex(other)] - positions[vertex(c)];
      sum[root] += edge;
      nearest[root] = std::min(nearest[root], edge.stableNorm());
    }
  }
  std::vector<Index> replacement(n_corners, no_index);
  for (const auto& [root, v] : apart) {
    const double step = std::min(separation * state.largest_extent, nearest[root] / 64);
    const Vec3 direction = sum[root].stableNorm() > 0 ? Vec3(sum[root].stableNormalized()) : Vec3::UnitX();
    const Vec3 position = positions[v];
    replacement[root] = state.add_vertex(position, step * direction);
  }
  for (Index c = 0; c < n_corners; ++c) {
    const Index copy = replacement[fans.root(c)];
    if (copy != no_index) triangles[c / 3][c % 3] = copy;
  }
  state.note("vertices added to part sheets that only touch", apart.size());
}

/// Where sheets still share both ends of an edge, each sheet but the first gets a vertex of its own in the middle.
void split_shared_edges(RepairState& state, const Pairing& pairing, double separation, bool force) {
  auto& triangles = state.soup.triangles;
  const EdgeTable edges(triangles, state.soup.positions.size());
  std::vector<std::vector<Index>> sheets;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto group = edges[e];
    if (group.size() == 1 || (group.size() == 2 && pairing[group[0]] == group[1])) continue;
    bool first = true;
    for (const Index h : group) {
      if (pairing[h] != no_index && pairing[h] < h) continue;
      if (!first) sheets.push_back(pairing[h] == no_index ? std::vector{h} : std::vector{h, pairing[h]});
      first = false;
    }
  }
  if (sheets.empty()) return;
  std::vector<char> touched(triangles.size(), 0);
  std::size_t split = 0;
  for (const auto& sheet : sheets) {
    if (std::any_of(sheet.begin(), sheet.end(), [&](Index h) { return touched[h / 3] != 0; })) continue;
    for (const Index h : sheet) touched[h / 3] = 1;
    if (force) continue;
    const Index a = triangles[sheet[0] / 3][sheet[0] % 3];
    const Index b = triangles[sheet[0] / 3][(sheet[0] % 3 + 1) % 3];
    const Vec3 halfway = 0.5 * state.soup.positions[a] + 0.5 * state.soup.positions[b];
    const Vec3 inward = state.soup.positions[triangles[sheet[0] / 3][(sheet[0] % 3 + 2) % 3]] - halfway;
    const double step = std::min(separation * state.largest_extent, inward.stableNorm() / 64);
    const Index middle = state.add_vertex(halfway, step * inward.stableNormalized());
    for (const Index h : sheet) {
      const int i = h % 3;
      Triangle second = triangles[h / 3];
      triangles[h / 3][(i + 1) % 3] = middle;
      second[i] = middle;
      triangles.push_back(second);
    }
    ++split;
  }
  if (force) {
    state.drop(touched, "triangles at edges with too many triangles dropped");
  } else {
    state.note("edges split to part sheets that share both their ends", split);
  }
}

void reverse_triangles(RepairState& state, Pairing& pairing, const std::vector<char>& reverse) {
  // Reversing swaps corners 1 and 2, which exchanges half-edges 0 and 2.
  const auto moved = [&](Index h) { return h != no_index && reverse[h / 3] ? 3 * (h / 3) + 2 - h % 3 : h; };
  Pairing out(pairing.size());
  for (Index h = 0; h < static_cast<Index>(pairing.size()); ++h) out[moved(h)] = moved(pairing[h]);
  pairing = std::move(out);
  std::size_t count = 0;
  for (std::size_t t = 0; t < reverse.size(); ++t) {
    if (!reverse[t]) continue;
    std::swap(state.soup.triangles[t][1], state.soup.triangles[t][2]);
    ++count;
  }
  state.note("triangles reversed to agree with their neighbours", count);
}

}  // namespace

void make_manifold(RepairState& state, double separation, bool force) {
  const TriangleSoup& soup = state.soup;
  Pairing pairing;
  Orientation orientation;
  {
    const EdgeTable edges(soup.triangles, soup.positions.size());
    pairing = pair_simple_edges(edges, soup.triangles.size());
    orientation = orient(soup.triangles, pairing);
    std::size_t crowded = 0;
    const EdgePairer pairer(soup, edges, orientation);
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (edges[e].size() < 3) continue;
      pairer.pair(edges[e], pairing);
      ++crowded;
    }
    if (crowded > 0) orientation = orient(soup.triangles, pairing);
    state.note("edges with more than two triangles taken apart", crowded);
  }
  face_outward(soup, pairing, orientation);
  for (const Index h : orientation.conflicts) {
    pairing[pairing[h]] = no_index;
    pairing[h] = no_index;
  }
  state.note("edges cut where the surface is one-sided", orientation.conflicts.size());
  reverse_triangles(state, pairing, orientation.reverse);
  split_vertices(state, pairing, separation);
  split_shared_edges(state, pairing, separation, force);
}

}  // namespace isopath
