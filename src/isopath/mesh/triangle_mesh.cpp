#include "isopath/mesh/triangle_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "isopath/core/error.h"

namespace isopath {
namespace {

constexpr const char* repair_advice = "run 'isopath check --repair' on the file to mend it";

[[noreturn]] void reject(std::string what, std::string element, std::string value = {}) {
  throw Error(ErrorCode::bad_input, std::move(what),
              {.element = std::move(element), .value = std::move(value), .advice = repair_advice});
}

void check_values(const TriangleSoup& soup) {
  const auto n = static_cast<Index>(soup.positions.size());
  for (Index v = 0; v < n; ++v) {
    const Vec3& p = soup.positions[v];
    if (!is_usable(p)) {
      reject("coordinate is not a usable number", fmt::format("vertex {}", v),
             fmt::format("{} {} {}", p.x(), p.y(), p.z()));
    }
  }
  for (std::size_t f = 0; f < soup.triangles.size(); ++f) {
    const auto& [a, b, c] = soup.triangles[f];
    if (std::min({a, b, c}) < 0 || std::max({a, b, c}) >= n) {
      reject("vertex index out of range", fmt::format("triangle {}", f),
             fmt::format("{} {} {} of {} vertices", a, b, c, n));
    }
    if (a == b || b == c || c == a) {
      reject("triangle uses a vertex twice", fmt::format("triangle {}", f), fmt::format("{} {} {}", a, b, c));
    }
  }
}

}  // namespace

TriangleMesh::TriangleMesh(TriangleSoup soup) : soup_(std::move(soup)) {
  check_values(soup_);
  bounds_ = bounding_box(soup_);
  require_usable_size(bounds_);
  pair_halfedges();
  number_edges();
  choose_outgoing();
  trace_boundary();
  label_components();
}

void TriangleMesh::pair_halfedges() {
  // Counting sort of the half-edges by their lower vertex, then a short sort among those of one vertex. What a
  // half-edge is sorted by and compared for travels with it: looking it up again misses the cache when the triangles
  // are shuffled.
  struct Entry {
    Index upper;
    Index halfedge;
    bool ascending;  ///< from the lower vertex to the upper
  };
  const Index n = n_halfedges();
  twin_.assign(n, no_index);
  std::vector<Index> start(n_vertices() + 1, 0);
  for (Index h = 0; h < n; ++h) ++start[std::min(from(h), to(h)) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Entry> sorted(n);
  std::vector<Index> cursor(start.begin(), start.end() - 1);
  for (Index h = 0; h < n; ++h) {
    const Index lower = std::min(from(h), to(h));
    const Index upper = std::max(from(h), to(h));
    sorted[cursor[lower]++] = {upper, h, from(h) == lower};
  }

  for (Index v = 0; v < n_vertices(); ++v) {
    const std::span bucket(sorted.data() + start[v], sorted.data() + start[v + 1]);
    std::sort(bucket.begin(), bucket.end(), [](const Entry& a, const Entry& b) {
      return std::pair(a.upper, a.halfedge) < std::pair(b.upper, b.halfedge);
    });
    for (std::size_t i = 0; i < bucket.size();) {
      std::size_t j = i + 1;
      while (j < bucket.size() && bucket[j].upper == bucket[i].upper) ++j;
      if (j - i > 2) {
        reject("edge has more than two triangles", fmt::format("edge {} {}", v, bucket[i].upper),
               fmt::format("{} triangles", j - i));
      }
      if (j - i == 2) {
        const Index h = bucket[i].halfedge;
        const Index g = bucket[i + 1].halfedge;
        if (bucket[i].ascending == bucket[i + 1].ascending) {
          reject("two neighbouring triangles are oriented oppositely",
                 fmt::format("triangles {} and {}", face_of(h), face_of(g)));
        }
        twin_[h] = g;
        twin_[g] = h;
      }
      i = j;
    }
  }
}

void TriangleMesh::number_edges() {
  edge_of_halfedge_.assign(n_halfedges(), no_index);
  halfedge_of_edge_.reserve(n_halfedges() / 2 + n_halfedges() / 16);
  for (Index h = 0; h < n_halfedges(); ++h) {
    if (edge_of_halfedge_[h] != no_index) continue;
    edge_of_halfedge_[h] = n_edges();
    if (twin_[h] != no_index) edge_of_halfedge_[twin_[h]] = n_edges();
    halfedge_of_edge_.push_back(h);
  }
  edge_length_.resize(n_edges());
  for (Index e = 0; e < n_edges(); ++e) {
    const Index h = halfedge_of_edge_[e];
    edge_length_[e] = (position(to(h)) - position(from(h))).norm();
  }
}

void TriangleMesh::choose_outgoing() {
  outgoing_.assign(n_vertices(), no_index);
  std::vector<Index> degree(n_vertices(), 0);
  for (Index h = 0; h < n_halfedges(); ++h) {
    const Index v = from(h);
    ++degree[v];
    if (outgoing_[v] == no_index || twin_[h] == no_index) outgoing_[v] = h;
  }
  for (Index v = 0; v < n_vertices(); ++v) {
    if (outgoing_[v] == no_index) continue;
    Index reached = 0;
    Index h = outgoing_[v];
    do {
      ++reached;
      h = next_outgoing(h);
    } while (h != no_index && h != outgoing_[v]);
    if (reached != degree[v]) {
      reject("the surface touches itself in a single vertex", fmt::format("vertex {}", v),
             fmt::format("{} of its {} triangles form one fan", reached, degree[v]));
    }
  }
}

void TriangleMesh::trace_boundary() {
  std::vector<char> seen(n_halfedges(), 0);
  std::vector<std::pair<double, std::vector<Index>>> loops;
  for (Index start = 0; start < n_halfedges(); ++start) {
    if (twin_[start] != no_index || seen[start]) continue;
    auto& [length, loop] = loops.emplace_back();
    for (Index h = start; !seen[h]; h = outgoing_[to(h)]) {
      seen[h] = 1;
      loop.push_back(h);
      length += edge_length_[edge_of_halfedge_[h]];
    }
  }
  std::stable_sort(loops.begin(), loops.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (auto& [length, loop] : loops) boundary_loops_.push_back(std::move(loop));
}

void TriangleMesh::label_components() {
  component_of_face_.assign(n_faces(), no_index);
  std::vector<Index> stack;
  for (Index seed = 0; seed < n_faces(); ++seed) {
    if (component_of_face_[seed] != no_index) continue;
    component_of_face_[seed] = n_components_;
    stack.push_back(seed);
    while (!stack.empty()) {
      const Index f = stack.back();
      stack.pop_back();
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        const Index g = twin_[h];
        if (g == no_index || component_of_face_[face_of(g)] != no_index) continue;
        component_of_face_[face_of(g)] = n_components_;
        stack.push_back(face_of(g));
      }
    }
    ++n_components_;
  }
}

Vec3 TriangleMesh::face_normal(Index face) const {
  const auto& [a, b, c] = triangle(face);
  return (position(b) - position(a)).cross(position(c) - position(a)).stableNormalized();
}

double TriangleMesh::face_area(Index face) const {
  const auto& [a, b, c] = triangle(face);
  return 0.5 * (position(b) - position(a)).cross(position(c) - position(a)).norm();
}

double TriangleMesh::area() const {
  double sum = 0;
  for (Index f = 0; f < n_faces(); ++f) sum += face_area(f);
  return sum;
}

}  // namespace isopath
