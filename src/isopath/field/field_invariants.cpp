#include "isopath/field/field_invariants.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/exact_field_data.h"

namespace isopath {
namespace {

[[noreturn]] void fail(const EdgeOfField& edge, std::size_t window, std::string what, std::string value) {
  throw Error(ErrorCode::internal, std::move(what),
              {.element = fmt::format("edge {}, window {}", edge.edge, window), .value = std::move(value)});
}

/// Twice the snap width: one for each of two windows that meet.
double same_place(const EdgeOfField& edge) { return 2 * std::max(1e-11 * edge.length, 2e-14 * edge.size); }

void expect_same_distance(const EdgeOfField& edge, std::size_t window, const char* where, double a, double b,
                          double error) {
  const double tolerance = 1e-9 * std::min(a, b) + 1e-11 * edge.size + same_place(edge) + error;
  if (std::abs(a - b) <= tolerance) return;
  fail(edge, window, fmt::format("windows of an exact field disagree on the distance {}", where),
       fmt::format("{:.17g} and {:.17g} mm", a, b));
}

void verify_window(const EdgeOfField& edge, std::size_t i, const Window& w) {
  const double rounding = 1e-11 * edge.size;
  const double least = w.min_distance();
  if (!(least >= -rounding && std::isfinite(w.distance(w.begin)) && std::isfinite(w.distance(w.end))))
    fail(edge, i, "a window of an exact field has an impossible distance", fmt::format("{} mm", least));
  if (!(w.begin < w.end)) fail(edge, i, "a window of an exact field is empty", fmt::format("{} to {}", w.begin, w.end));
  if (w.root < 0 || w.root >= edge.n_roots)
    fail(edge, i, "a window of an exact field has no root", fmt::format("{} of {} sources", w.root, edge.n_roots));
  if (w.kind == Window::Kind::line && !(std::abs(w.source.norm() - 1) <= 1e-9))
    fail(edge, i, "a straight front has no unit direction", fmt::format("{} {}", w.source.x(), w.source.y()));
  if (w.halfedge == no_index) return;
  if (w.halfedge != edge.halfedge && w.halfedge != edge.twin)
    fail(edge, i, "a window of an exact field goes into a face elsewhere", fmt::format("half-edge {}", w.halfedge));
  // The face that it enters is at y > 0 of the half-edge's frame, so the front comes from y <= 0.
  const double y =
      (w.halfedge == edge.halfedge ? 1 : -1) * (w.kind == Window::Kind::point ? w.source.y() : -w.source.y());
  const double slack = w.kind == Window::Kind::point ? rounding : 1e-9;
  if (y > slack) fail(edge, i, "a window of an exact field has its source ahead", fmt::format("{} beyond the edge", y));
}

}  // namespace

void verify_edge_windows(const EdgeOfField& edge, std::span<const Window> windows) {
  const bool reached = edge.distance_at_start < infinity || edge.distance_at_end < infinity;
  if (windows.empty()) {
    if (reached && edge.length > same_place(edge))
      fail(edge, 0, "a reached edge of an exact field has no windows", fmt::format("{} mm long", edge.length));
    return;
  }
  const auto expect_same_place = [&](std::size_t i, double expected, double found) {
    if (std::abs(found - expected) <= same_place(edge)) return;
    fail(edge, i, found > expected ? "windows leave a gap on an edge" : "windows overlap on an edge",
         fmt::format("{:.17g} to {:.17g} of {:.17g} mm", expected, found, edge.length));
  };
  // The distance so far, and what it may be off.
  double distance = edge.distance_at_start;
  double error = windows[0].error;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const Window& w = windows[i];
    verify_window(edge, i, w);
    expect_same_place(i, i == 0 ? 0 : windows[i - 1].end, w.begin);
    expect_same_distance(edge, i, i == 0 ? "at a vertex" : "where they meet", distance, w.distance(w.begin),
                         error + w.error);
    distance = w.distance(w.end);
    error = w.error;
  }
  expect_same_place(windows.size() - 1, windows.back().end, edge.length);
  expect_same_distance(edge, windows.size() - 1, "at a vertex", distance, edge.distance_at_end, 2 * error);
}

void verify_windows(const ExactFieldData& data) {
  const TriangleMesh& mesh = data.mesh;
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    const Index h = mesh.halfedge_of(e);
    // Where both ends are reached, all points between are as near as the farther end and the edge together.
    const double start = data.distance[mesh.from(h)];
    const double end = data.distance[mesh.to(h)];
    if (data.reach < infinity && !(std::max(start, end) + data.geometry.length(h) <= data.reach)) continue;
    verify_edge_windows({.edge = e,
                         .halfedge = h,
                         .twin = mesh.twin(h),
                         .length = data.geometry.length(h),
                         .distance_at_start = start,
                         .distance_at_end = end,
                         .size = data.geometry.size(),
                         .n_roots = static_cast<Index>(data.sources.elements().size())},
                        data.windows.of(e));
  }
}

void ExactField::verify() const { verify_windows(*data_); }

}  // namespace isopath
