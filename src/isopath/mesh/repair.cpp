#include "isopath/mesh/repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/mesh/repair_steps.h"
#include "isopath/mesh/triangle_shape.h"
#include "isopath/mesh/weld.h"

namespace isopath {

RepairState::RepairState(TriangleSoup input) : soup(std::move(input)), merged(soup.positions.size()) {
  Box3 box;
  for (const Vec3& p : soup.positions) {
    if (is_usable(p)) box.extend(p);
  }
  if (box.isEmpty()) return;
  tolerance = Tolerance::of_size(box.diagonal().stableNorm());
  largest_extent = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
}

void RepairState::note(std::string_view what, std::size_t count) {
  if (count == 0) return;
  const auto same = std::find_if(changes.begin(), changes.end(), [&](const RepairChange& c) { return c.what == what; });
  if (same != changes.end()) {
    same->count += static_cast<Index>(count);
  } else {
    changes.push_back({std::string(what), static_cast<Index>(count)});
  }
}

Index RepairState::add_vertex(const Vec3& position, const Vec3& move) {
  const auto single = [](const Vec3& p) { return Vec3(p.cast<float>().eval().cast<double>()); };
  const auto is_new = [](PointWelder& welder, const Vec3& p) {
    const std::size_t before = welder.points().size();
    Index number = no_index;
    welder.add({&p, 1}, {&number, 1});
    return welder.points().size() > before;
  };
  if (!taken) {
    taken.emplace(soup.positions.size());
    taken_single.emplace(soup.positions.size());
    for (const Vec3& p : soup.positions) {
      is_new(*taken, p);
      is_new(*taken_single, single(p));
    }
  }
  // Sixteen tries are more than the sheets that meet anywhere in an ordinary file; after them, double must do.
  constexpr int tries = 16;
  Vec3 place = position;
  int k = 0;
  while (k < tries && !is_new(*taken_single, single(place))) place = position + ++k * move;
  if (k == tries) place = position;
  for (k = 0; k < 1000 && !is_new(*taken, place); ++k) place = position + k * move;
  soup.positions.push_back(place);
  merged.append();
  return static_cast<Index>(soup.positions.size()) - 1;
}

void RepairState::drop(const std::vector<char>& marked, std::string_view what) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    if (!marked[t]) soup.triangles[kept++] = soup.triangles[t];
  }
  note(what, soup.triangles.size() - kept);
  soup.triangles.resize(kept);
}

void drop_unusable_triangles(RepairState& state) {
  const auto n = static_cast<Index>(state.soup.positions.size());
  std::vector<char> out_of_range(state.soup.triangles.size(), 0);
  for (std::size_t t = 0; t < out_of_range.size(); ++t) {
    const auto& [a, b, c] = state.soup.triangles[t];
    out_of_range[t] = std::min({a, b, c}) < 0 || std::max({a, b, c}) >= n;
  }
  state.drop(out_of_range, "triangles with a vertex index out of range dropped");
  std::vector<char> unusable(state.soup.triangles.size(), 0);
  for (std::size_t t = 0; t < unusable.size(); ++t) {
    for (const Index v : state.soup.triangles[t]) unusable[t] |= static_cast<char>(!is_usable(state.soup.positions[v]));
  }
  state.drop(unusable, "triangles at coordinates that are not finite or too large dropped");
}

void weld_vertices(RepairState& state) {
  std::vector<Vec3> points;
  std::vector<Index> vertices;
  for (std::size_t v = 0; v < state.soup.positions.size(); ++v) {
    if (!is_usable(state.soup.positions[v])) continue;
    points.push_back(state.soup.positions[v]);
    vertices.push_back(static_cast<Index>(v));
  }
  PointWelder welder(points.size());
  std::vector<Index> numbers(points.size());
  welder.add(points, numbers);
  std::vector<Index> first(welder.points().size(), no_index);
  std::size_t joined = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Index& original = first[numbers[i]];
    if (original == no_index) {
      original = vertices[i];
    } else {
      state.merged.join(original, vertices[i]);
      ++joined;
    }
  }
  if (joined == 0) return;
  state.note("vertices welded to one at the same position", joined);
  for (Triangle& t : state.soup.triangles) {
    for (Index& v : t) v = state.merged.root(v);
  }
}

void drop_repeated_vertices(RepairState& state) {
  std::vector<char> marked(state.soup.triangles.size(), 0);
  for (std::size_t t = 0; t < marked.size(); ++t) {
    const auto& [a, b, c] = state.soup.triangles[t];
    marked[t] = a == b || b == c || c == a;
  }
  state.drop(marked, "triangles that use a vertex twice dropped");
}

void drop_duplicate_triangles(RepairState& state) {
  const auto& triangles = state.soup.triangles;
  std::vector<std::pair<Triangle, Index>> keys(triangles.size());
  for (std::size_t t = 0; t < keys.size(); ++t) {
    keys[t] = {triangles[t], static_cast<Index>(t)};
    std::sort(keys[t].first.begin(), keys[t].first.end());
  }
  std::sort(keys.begin(), keys.end());
  std::vector<char> marked(triangles.size(), 0);
  for (std::size_t i = 1; i < keys.size(); ++i) marked[keys[i].second] = keys[i].first == keys[i - 1].first;
  state.drop(marked, "duplicate triangles dropped");
}

void keep_largest_component(RepairState& state) {
  const auto& [positions, triangles] = state.soup;
  // The surface is manifold by now: triangles that share a vertex are one component.
  DisjointSets components(positions.size());
  for (const auto& [a, b, c] : triangles) {
    components.join(a, b);
    components.join(b, c);
  }
  std::vector<double> area(positions.size(), 0);
  for (const auto& [a, b, c] : triangles) {
    area[components.root(a)] += shape_of(positions[a], positions[b], positions[c]).area();
  }
  const auto largest = static_cast<Index>(std::max_element(area.begin(), area.end()) - area.begin());
  std::vector<char> marked(triangles.size(), 0);
  for (std::size_t t = 0; t < marked.size(); ++t) marked[t] = components.root(triangles[t][0]) != largest;
  state.drop(marked, "triangles outside the largest component dropped");
}

namespace {

std::size_t n_changes(const RepairState& state) {
  return std::accumulate(state.changes.begin(), state.changes.end(), std::size_t{0},
                         [](std::size_t sum, const RepairChange& change) { return sum + change.count; });
}

/// Repeats the steps until none of them finds anything to do.
void settle(RepairState& state, const RepairOptions& options, Progress& progress) {
  // A step may leave work for another: ordinary files need two or three passes. From the eighth on, steps only remove
  // triangles, so that the passes end; the limit is there to turn a fault of ours into an error.
  constexpr int patience = 8;
  constexpr int limit = 1000;
  for (int pass = 0; pass < limit; ++pass) {
    progress.checkpoint();
    const std::size_t before = n_changes(state);
    drop_repeated_vertices(state);
    drop_duplicate_triangles(state);
    remove_zero_area(state, pass >= patience);
    if (n_changes(state) != before) continue;
    make_manifold(state, options.separation, pass >= patience);
    if (n_changes(state) == before) return;
  }
  throw Error(ErrorCode::internal, "the repair does not come to an end");
}

/// Removes vertices that nothing uses and fills in where the input's vertices went.
RepairResult compact(RepairState&& state, std::size_t n_input) {
  const std::size_t n = state.soup.positions.size();
  std::vector<char> used(n, 0);
  for (const Triangle& t : state.soup.triangles) {
    for (const Index v : t) used[v] = 1;
  }
  std::size_t unusable = 0;
  std::size_t unused = 0;
  std::vector<Index> number(n, no_index);
  std::vector<Vec3> kept;
  for (std::size_t v = 0; v < n; ++v) {
    if (used[v]) {
      number[v] = static_cast<Index>(kept.size());
      kept.push_back(state.soup.positions[v]);
    } else if (v < n_input && state.merged.root(static_cast<Index>(v)) == static_cast<Index>(v)) {
      ++(is_usable(state.soup.positions[v]) ? unused : unusable);
    }
  }
  state.note("vertices that are not finite or too large dropped", unusable);
  state.note("vertices that no triangle uses dropped", unused);
  RepairResult result;
  result.vertex_of_input.resize(n_input);
  for (std::size_t v = 0; v < n_input; ++v)
    result.vertex_of_input[v] = number[state.merged.root(static_cast<Index>(v))];
  for (Triangle& t : state.soup.triangles) {
    for (Index& v : t) v = number[v];
  }
  result.soup = {std::move(kept), std::move(state.soup.triangles)};
  result.changes = std::move(state.changes);
  return result;
}

std::string listed(const std::vector<RepairChange>& changes) {
  std::string out;
  for (const RepairChange& change : changes) {
    out += fmt::format("{}{} {}", out.empty() ? "" : ", ", change.count, change.what);
  }
  return out.empty() ? "there were no triangles" : out;
}

}  // namespace

void RepairOptions::validate() const {
  const auto refuse = [](const char* option, double value, const char* range) {
    throw Error(ErrorCode::bad_usage, "repair option out of range",
                {.element = option, .value = fmt::format("{}", value), .advice = fmt::format("it lies in {}", range)});
  };
  if (!(fill_holes_length >= 0)) refuse("fill_holes_length", fill_holes_length, "[0, infinity]");
  if (fill_holes_edges < 3 || fill_holes_edges > 1000) refuse("fill_holes_edges", fill_holes_edges, "[3, 1000]");
  if (!(separation >= 0 && separation <= 1e-3)) refuse("separation", separation, "[0, 1e-3]");
}

RepairResult repair_mesh(TriangleSoup soup, const RepairOptions& options, Progress& progress) {
  options.validate();
  progress.stage("repair mesh");
  const std::size_t n_input = soup.positions.size();
  RepairState state(std::move(soup));
  drop_unusable_triangles(state);
  if (options.weld) weld_vertices(state);
  settle(state, options, progress);
  if (options.largest_component && !state.soup.triangles.empty()) keep_largest_component(state);
  if (options.fill_holes_length > 0) {
    fill_holes(state, options.fill_holes_length, options.fill_holes_edges, progress);
    settle(state, options, progress);
  }
  if (state.soup.triangles.empty()) {
    throw Error(ErrorCode::bad_input, "nothing is left of the surface after repair",
                {.element = "all triangles",
                 .value = listed(state.changes),
                 .advice = "the file holds no usable triangle; export the surface again"});
  }
  require_usable_size(bounding_box(state.soup));
  return compact(std::move(state), n_input);
}

}  // namespace isopath
