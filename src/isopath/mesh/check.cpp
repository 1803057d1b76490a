#include "isopath/mesh/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/core/tolerance.h"
#include "isopath/mesh/disjoint_sets.h"
#include "isopath/mesh/edge_table.h"
#include "isopath/mesh/self_intersections.h"
#include "isopath/mesh/triangle_shape.h"
#include "isopath/mesh/weld.h"

namespace isopath {
namespace {

struct KindText {
  std::string_view name;
  Severity severity;
};

constexpr std::array<KindText, 13> kinds = {{{"index_out_of_range", Severity::error},
                                             {"non_finite_coordinate", Severity::error},
                                             {"overflowing_coordinate", Severity::error},
                                             {"repeated_vertex", Severity::error},
                                             {"zero_area", Severity::warning},
                                             {"duplicate_triangle", Severity::warning},
                                             {"non_manifold_edge", Severity::error},
                                             {"inconsistent_orientation", Severity::error},
                                             {"non_manifold_vertex", Severity::error},
                                             {"self_intersection", Severity::warning},
                                             {"sliver", Severity::warning},
                                             {"duplicate_position", Severity::note},
                                             {"unreferenced_vertex", Severity::note}}};

class Checker {
 public:
  Checker(const TriangleSoup& soup, const CheckOptions& options, Progress& progress)
      : soup_(soup), options_(options), progress_(progress) {
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      defects_[k].kind = static_cast<DefectKind>(k);
      defects_[k].severity = kinds[k].severity;
    }
  }

  MeshReport run() {
    report_.triangles = static_cast<Index>(soup_.triangles.size());
    report_.vertices = static_cast<Index>(soup_.positions.size());
    check_vertices();
    check_triangles();
    check_duplicates();
    progress_.checkpoint();
    check_topology();
    progress_.checkpoint();
    if (options_.self_intersections) check_self_intersections();
    for (Defect& defect : defects_) {
      if (defect.count > 0) report_.defects.push_back(std::move(defect));
    }
    return std::move(report_);
  }

 private:
  void add(DefectKind kind, std::initializer_list<Index> element) {
    Defect& defect = defects_[static_cast<std::size_t>(kind)];
    if (defect.count++ < options_.listed) defect.first.emplace_back(element);
  }

  void check_vertices() {
    const auto n = static_cast<Index>(soup_.positions.size());
    std::vector<char> used(n, 0);
    for (const Triangle& t : soup_.triangles) {
      for (const Index v : t) {
        if (v >= 0 && v < n) used[v] = 1;
      }
    }
    PointWelder welder(n);
    std::vector<Index> first;
    for (Index v = 0; v < n; ++v) {
      const Vec3& p = soup_.positions[v];
      if (!used[v]) add(DefectKind::unreferenced_vertex, {v});
      if (!p.allFinite()) {
        add(DefectKind::non_finite_coordinate, {v});
      } else if (!is_usable(p)) {
        add(DefectKind::overflowing_coordinate, {v});
      } else {
        report_.bounds.extend(p);
        Index number = no_index;
        welder.add({&p, 1}, {&number, 1});
        if (number < static_cast<Index>(first.size())) {
          add(DefectKind::duplicate_position, {v, first[number]});
        } else {
          first.push_back(v);
        }
      }
    }
  }

  /// Shapes, and the triangles that the topology is made of.
  void check_triangles() {
    const auto n = static_cast<Index>(soup_.positions.size());
    const double size = report_.bounds.isEmpty() ? 0 : report_.bounds.diagonal().stableNorm();
    const Tolerance tolerance = Tolerance::of_size(size);
    for (Index t = 0; t < report_.triangles; ++t) {
      const auto& [a, b, c] = soup_.triangles[t];
      if (std::min({a, b, c}) < 0 || std::max({a, b, c}) >= n) {
        add(DefectKind::index_out_of_range, {t});
        continue;
      }
      if (a == b || b == c || c == a) {
        add(DefectKind::repeated_vertex, {t});
        continue;
      }
      sound_.push_back(soup_.triangles[t]);
      original_.push_back(t);
      const auto& p = soup_.positions;
      if (!is_usable(p[a]) || !is_usable(p[b]) || !is_usable(p[c])) continue;
      const TriangleShape shape = shape_of(p[a], p[b], p[c]);
      report_.area += shape.area();
      if (shape.height <= tolerance.length) {
        add(DefectKind::zero_area, {t});
      } else if (shape.aspect() >= options_.sliver_aspect) {
        add(DefectKind::sliver, {t});
      }
    }
  }

  void check_duplicates() {
    std::vector<std::pair<Triangle, Index>> keys(sound_.size());
    for (std::size_t i = 0; i < keys.size(); ++i) {
      keys[i] = {sound_[i], original_[i]};
      std::sort(keys[i].first.begin(), keys[i].first.end());
    }
    std::sort(keys.begin(), keys.end());
    std::vector<std::pair<Index, Index>> repeats;
    for (std::size_t i = 1, first = 0; i < keys.size(); ++i) {
      if (keys[i].first != keys[first].first) {
        first = i;
      } else {
        repeats.emplace_back(keys[i].second, keys[first].second);
      }
    }
    std::sort(repeats.begin(), repeats.end());
    for (const auto& [t, earlier] : repeats) add(DefectKind::duplicate_triangle, {t, earlier});
  }

  void check_topology() {
    const EdgeTable edges(sound_, soup_.positions.size());
    const Pairing pairing = pair_simple_edges(edges, sound_.size());
    std::vector<char> crowded(3 * sound_.size(), 0);
    DisjointSets pieces(sound_.size());
    DisjointSets fans(3 * sound_.size());
    bool any_boundary = false;
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const auto group = edges[e];
      any_boundary |= group.size() == 1;
      const auto [low, high] = std::minmax({edges.from(group[0]), edges.to(group[0])});
      if (group.size() > 2) {
        add(DefectKind::non_manifold_edge, {low, high});
        for (const Index h : group) crowded[h] = 1;
      } else if (group.size() == 2 && edges.from(group[0]) == edges.from(group[1])) {
        add(DefectKind::inconsistent_orientation, {low, high});
      }
      for (const Index h : group.subspan(1)) {
        pieces.join(group[0] / 3, h / 3);
        fans.join(corner_at(group[0], low), corner_at(h, low));
        fans.join(corner_at(group[0], high), corner_at(h, high));
      }
    }
    const Index referenced = check_fans(fans);
    measure_pieces(pieces);
    trace_boundary(pairing, crowded);
    report_.edges = static_cast<Index>(edges.size());
    report_.euler_characteristic = referenced - report_.edges + static_cast<Index>(sound_.size());
    report_.closed = !any_boundary && !sound_.empty();
    report_.orientable = orient(sound_, pairing).conflicts.empty();
    report_.manifold = count(DefectKind::non_manifold_edge) == 0 && count(DefectKind::non_manifold_vertex) == 0;
    if (report_.manifold && report_.orientable) {
      // χ = 2 c − 2 g − b, summed over the components.
      const auto loops = static_cast<Index>(report_.boundary_loops.size());
      report_.genus = (2 * report_.components - loops - report_.euler_characteristic) / 2;
    }
  }

  void measure_pieces(DisjointSets& pieces) {
    std::vector<double> area(sound_.size(), 0.0);
    for (std::size_t f = 0; f < sound_.size(); ++f) {
      const auto root = pieces.root(static_cast<Index>(f));
      report_.components += root == static_cast<Index>(f);
      const auto& [a, b, c] = sound_[f];
      const auto& p = soup_.positions;
      if (!is_usable(p[a]) || !is_usable(p[b]) || !is_usable(p[c])) continue;
      area[root] += shape_of(p[a], p[b], p[c]).area();
      report_.largest_area = std::max(report_.largest_area, area[root]);
    }
  }

  Index count(DefectKind kind) const { return defects_[static_cast<std::size_t>(kind)].count; }
  Index vertex(Index corner) const { return sound_[corner / 3][corner % 3]; }
  static Index next(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static Index prev(Index h) { return h % 3 == 0 ? h + 2 : h - 1; }
  /// The corner of the half-edge's triangle at one of its ends.
  Index corner_at(Index h, Index v) const { return vertex(h) == v ? h : next(h); }

  /// Vertices with more than one fan; returns how many vertices are in use.
  Index check_fans(DisjointSets& fans) {
    std::vector<Index> count(soup_.positions.size(), 0);
    for (Index c = 0; c < static_cast<Index>(3 * sound_.size()); ++c) {
      if (fans.root(c) == c) ++count[vertex(c)];
    }
    Index referenced = 0;
    for (Index v = 0; v < static_cast<Index>(count.size()); ++v) {
      referenced += count[v] > 0;
      if (count[v] > 1) add(DefectKind::non_manifold_vertex, {v});
    }
    return referenced;
  }

  /// Follows edges with one triangle, at each vertex around the fan to its other rim, whatever the orientations.
  void trace_boundary(const Pairing& pairing, const std::vector<char>& crowded) {
    std::vector<char> seen(pairing.size(), 0);
    const auto on_boundary = [&](Index h) { return pairing[h] == no_index && !crowded[h]; };
    const auto length = [&](Index h) {
      const Vec3& p = soup_.positions[vertex(h)];
      const Vec3& q = soup_.positions[vertex(next(h))];
      return is_usable(p) && is_usable(q) ? (q - p).norm() : 0;
    };
    // The next edge of the boundary from h around v, no_index at a non-manifold edge.
    const auto turn = [&](Index h, Index v) {
      for (;;) {
        h = vertex(h) == v ? prev(h) : next(h);
        if (crowded[h]) return no_index;
        if (pairing[h] == no_index) return h;
        h = pairing[h];
      }
    };
    const auto far_end = [&](Index h, Index v) { return vertex(h) == v ? vertex(next(h)) : vertex(h); };
    for (Index start = 0; start < static_cast<Index>(pairing.size()); ++start) {
      if (!on_boundary(start) || seen[start]) continue;
      BoundaryLoop loop{length(start), 1, vertex(start), true};
      seen[start] = 1;
      for (const Index begin : {vertex(next(start)), vertex(start)}) {
        Index v = begin;
        Index h = turn(start, v);
        while (h != no_index && !seen[h]) {
          seen[h] = 1;
          loop.length += length(h);
          ++loop.edges;
          v = far_end(h, v);
          h = turn(h, v);
        }
        if (h != no_index) break;
        loop.closed = false;
      }
      report_.boundary_loops.push_back(loop);
    }
    std::stable_sort(report_.boundary_loops.begin(), report_.boundary_loops.end(),
                     [](const BoundaryLoop& a, const BoundaryLoop& b) { return a.length > b.length; });
  }

  void check_self_intersections() {
    TriangleSoup usable{soup_.positions, {}};
    std::vector<Index> original;
    for (std::size_t i = 0; i < sound_.size(); ++i) {
      if (!std::all_of(sound_[i].begin(), sound_[i].end(), [&](Index v) { return is_usable(soup_.positions[v]); })) {
        continue;
      }
      usable.triangles.push_back(sound_[i]);
      original.push_back(original_[i]);
    }
    for (const auto& [s, t] : find_self_intersections(usable, progress_)) {
      add(DefectKind::self_intersection, {original[s], original[t]});
    }
  }

  const TriangleSoup& soup_;
  const CheckOptions& options_;
  Progress& progress_;
  MeshReport report_;
  std::array<Defect, kinds.size()> defects_;
  std::vector<Triangle> sound_;  ///< triangles with three different vertices that exist
  std::vector<Index> original_;  ///< their numbers in the soup
};

}  // namespace

std::string_view name_of(DefectKind kind) { return kinds[static_cast<std::size_t>(kind)].name; }

std::string_view name_of(Severity severity) {
  constexpr std::array<std::string_view, 3> names = {"error", "warning", "note"};
  return names[static_cast<std::size_t>(severity)];
}

void CheckOptions::validate() const {
  const auto refuse = [](const char* option, double value, const char* range) {
    throw Error(ErrorCode::bad_usage, "check option out of range",
                {.element = option, .value = fmt::format("{}", value), .advice = fmt::format("it must be {}", range)});
  };
  if (listed < 0) refuse("listed", listed, "0 or more");
  if (!(sliver_aspect > 1)) refuse("sliver_aspect", sliver_aspect, "more than 1");
}

const Defect* MeshReport::find(DefectKind kind) const {
  const auto found = std::find_if(defects.begin(), defects.end(), [&](const Defect& d) { return d.kind == kind; });
  return found == defects.end() ? nullptr : &*found;
}

Index MeshReport::count(DefectKind kind) const {
  const Defect* defect = find(kind);
  return defect == nullptr ? 0 : defect->count;
}

bool MeshReport::sound() const {
  return std::none_of(defects.begin(), defects.end(), [](const Defect& d) { return d.severity == Severity::error; });
}

MeshReport check_mesh(const TriangleSoup& soup, const CheckOptions& options, Progress& progress) {
  options.validate();
  progress.stage("check mesh");
  return Checker(soup, options, progress).run();
}

}  // namespace isopath
