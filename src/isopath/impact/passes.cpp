#include "isopath/impact/passes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/field/value_range.h"
#include "isopath/impact/moved_levels.h"

namespace isopath {
namespace {

/// Far beyond all use, and far below what an index can count.
constexpr double most_passes = 1e6;

/// The contours kept, linked over those left out.
struct Links {
  std::vector<std::vector<Index>> children;
  std::vector<std::vector<Index>> parents;
};

Links link_kept(const ContourSet& set, const std::vector<char>& keep) {
  Links links;
  links.children.resize(set.contours.size());
  links.parents.resize(set.contours.size());
  for (std::size_t k = 0; k < set.contours.size(); ++k) {
    if (!keep[k]) continue;
    for (const Index child : set.graph.children[k]) {
      const auto join = [&](Index c) {
        auto& children = links.children[k];
        if (std::find(children.begin(), children.end(), c) != children.end()) return;
        children.push_back(c);
        links.parents[c].push_back(static_cast<Index>(k));
      };
      if (keep[child]) {
        join(child);
      } else {
        for (const Index grandchild : set.graph.children[child]) {
          if (keep[grandchild]) join(grandchild);
        }
      }
    }
  }
  return links;
}

/// The level half way between the extremes of each component that no contour lies on, infinity for the others.
std::vector<double> levels_of_missed_components(const TriangleMesh& mesh, const SurfaceFunction& function,
                                                const std::vector<Contour>& contours, const Progress& progress) {
  std::vector<ValueRange> range(mesh.n_components());
  std::vector<char> met(mesh.n_components(), 0);
  for (const Contour& contour : contours) met[mesh.component_of(contour.points.front().face)] = 1;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    if (met[mesh.component_of(f)]) continue;
    progress.checkpoint();
    ValueRange& here = range[mesh.component_of(f)];
    const double centre = function.value({f, Vec3::Constant(1.0 / 3)});
    for (const double value :
         {centre, function.value_at_vertex(mesh.triangle(f)[0]), function.value_at_vertex(mesh.triangle(f)[1]),
          function.value_at_vertex(mesh.triangle(f)[2])}) {
      if (!std::isfinite(value)) continue;
      here.low = std::min(here.low, value);
      here.high = std::max(here.high, value);
    }
  }
  std::vector<double> level(mesh.n_components(), infinity);
  for (Index c = 0; c < mesh.n_components(); ++c) {
    if (!met[c] && range[c].high > range[c].low) level[c] = 0.5 * (range[c].low + range[c].high);
  }
  return level;
}

/// A component so small or narrow that no level meets it gets one pass half way between its extremes.
void add_missed_components(const TriangleMesh& mesh, const SurfaceFunction& function, const IsolineOptions& options,
                           Passes& passes, Progress& progress) {
  const std::vector<double> level = levels_of_missed_components(mesh, function, passes.contours, progress);
  if (std::none_of(level.begin(), level.end(), [](double l) { return l < infinity; })) return;
  std::vector<double> level_of_vertex(mesh.n_vertices(), infinity);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    for (const Index v : mesh.triangle(f)) level_of_vertex[v] = level[mesh.component_of(f)];
  }
  const double zero = 0;
  std::vector<Contour> missed =
      isolines(mesh, MovedLevels(mesh, function, std::move(level_of_vertex)), std::span(&zero, 1), options, progress);
  // component after component, as their passes would be found one by one
  const auto component = [&](const Contour& contour) { return mesh.component_of(contour.points.front().face); };
  std::stable_sort(missed.begin(), missed.end(),
                   [&](const Contour& a, const Contour& b) { return component(a) < component(b); });
  for (Contour& contour : missed) {
    contour.level = level[component(contour)];
    passes.runs.push_back({{static_cast<Index>(passes.contours.size())}, contour.closed});
    passes.contours.push_back(std::move(contour));
  }
}

}  // namespace

std::vector<char> mark_passes(const ContourSet& set, std::span<const double> levels) {
  std::vector<char> keep(set.contours.size(), 0);
  for (std::size_t k = 0; k < set.contours.size(); ++k) {
    const auto place = std::lower_bound(levels.begin(), levels.end(), set.contours[k].level) - levels.begin();
    keep[k] = place % 2 == 0 || set.graph.children[k].empty();
  }
  return keep;
}

Passes choose_passes(const TriangleMesh& mesh, const SurfaceFunction& function, double spacing, Progress& progress,
                     PassLayout layout) {
  Passes passes;
  const ValueRange range = value_range(mesh, function, 0.01 * spacing, progress);
  if (!(range.high > range.low)) return passes;
  const double count = std::max(1.0, std::ceil((range.high - range.low) / spacing - 1e-9));
  if (!(count <= most_passes)) {
    throw Error(ErrorCode::bad_usage, "the spacing is too small for the function's range",
                {.element = "spacing",
                 .value = fmt::format("{} mm makes {:.3g} passes, limit {:.0f}", spacing, count, most_passes)});
  }
  const bool even = layout == PassLayout::even || range.high - range.low <= spacing;
  passes.spacing = even ? (range.high - range.low) / count : spacing;
  std::vector<double> levels;
  for (int k = 1; k < 2 * static_cast<int>(count); ++k) {
    const double level = range.low + 0.5 * k * passes.spacing;
    if (level < range.high) levels.push_back(level);
  }

  const IsolineOptions options{.chord_tolerance = 1e-3 * spacing};
  ContourSet set = contour_set(mesh, function, levels, options, progress);
  const std::vector<char> keep = mark_passes(set, levels);
  const Links links = link_kept(set, keep);

  std::vector<Index> number(set.contours.size(), no_index);
  for (std::size_t k = 0; k < keep.size(); ++k) {
    if (!keep[k]) continue;
    number[k] = static_cast<Index>(passes.contours.size());
    passes.contours.push_back(std::move(set.contours[k]));
  }
  const auto single = [](const std::vector<Index>& list) { return list.size() == 1; };
  for (std::size_t k = 0; k < keep.size(); ++k) {
    if (!keep[k]) continue;
    const bool closed = passes.contours[number[k]].closed;
    const auto continues = [&](Index below, Index above) {
      return single(links.children[below]) && single(links.parents[above]) &&
             passes.contours[number[below]].closed == passes.contours[number[above]].closed;
    };
    if (single(links.parents[k]) && continues(links.parents[k][0], static_cast<Index>(k))) continue;  // inside a run
    Passes::Run& run = passes.runs.emplace_back();
    run.closed = closed;
    for (auto here = static_cast<Index>(k);;) {
      run.contours.push_back(number[here]);
      if (!single(links.children[here]) || !continues(here, links.children[here][0])) break;
      here = links.children[here][0];
    }
  }
  add_missed_components(mesh, function, options, passes, progress);
  return passes;
}

}  // namespace isopath
