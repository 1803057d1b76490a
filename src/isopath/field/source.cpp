#include "isopath/field/source.h"

#include <fmt/format.h>

#include "isopath/core/error.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {

void SourceSet::add_vertex(const TriangleMesh& mesh, Index vertex) { add_point(point_at_vertex(mesh, vertex)); }

void SourceSet::add_point(const SurfacePoint& point) { elements_.push_back({.a = point, .b = point}); }

Index SourceSet::add_segment(const SurfacePoint& a, const SurfacePoint& b) {
  elements_.push_back({.kind = SourceElement::Kind::segment, .a = a, .b = b});
  return static_cast<Index>(elements_.size()) - 1;
}

void SourceSet::add_polyline(const TriangleMesh& mesh, std::span<const SurfacePoint> points, bool closed) {
  const std::size_t n = points.size();
  if (n == 0) return;
  // elements alternate: point 0, segment 0–1, point 1, …
  const auto first = static_cast<Index>(elements_.size());
  const std::size_t segments = closed && n > 1 ? n : n - 1;
  for (std::size_t i = 0; i < n; ++i) {
    add_point(points[i]);
    if (i >= segments) break;
    const SurfacePoint& next = points[(i + 1) % n];
    const Index face = common_face(mesh, points[i], next);
    if (face == no_index)
      throw Error(ErrorCode::internal, fmt::format("polyline points {} and {} share no face", i, i + 1));
    add_segment(express_in(mesh, points[i], face), express_in(mesh, next, face));
  }
  for (std::size_t i = 0; i < n; ++i) {
    SourceElement& point = elements_[first + 2 * i];
    if (i < segments) point.segment_after = first + static_cast<Index>(2 * i) + 1;
    if (i > 0) point.segment_before = first + static_cast<Index>(2 * i) - 1;
    if (i == 0 && segments == n) point.segment_before = first + static_cast<Index>(2 * n) - 1;
  }
}

void SourceSet::add_halfedges(const TriangleMesh& mesh, std::span<const Index> halfedges, bool closed) {
  std::vector<SurfacePoint> points;
  points.reserve(halfedges.size() + 1);
  for (const Index h : halfedges) points.push_back(point_on_halfedge(h, 0));
  if (!closed && !halfedges.empty()) points.push_back(point_on_halfedge(halfedges.back(), 1));
  add_polyline(mesh, points, closed);
}

SourceSet boundary_source(const TriangleMesh& mesh) {
  SourceSet sources;
  for (const auto& loop : mesh.boundary_loops()) sources.add_halfedges(mesh, loop, true);
  if (sources.empty()) {
    throw Error(ErrorCode::bad_usage, "the surface is closed: it has no boundary to start from",
                {.element = "source boundary", .advice = "give another source, for example vertex:0 or plane:0,0,1,0"});
  }
  return sources;
}

SourceSet boundary_source(const TriangleMesh& mesh, Index loop) {
  const auto n = static_cast<Index>(mesh.boundary_loops().size());
  if (loop < 0 || loop >= n) {
    throw Error(ErrorCode::bad_usage, "there is no such boundary loop",
                {.element = fmt::format("source boundary:{}", loop),
                 .value = fmt::format("{} loops", n),
                 .advice = "loops are numbered from 0, the longest first; 'isopath check' lists them"});
  }
  SourceSet sources;
  sources.add_halfedges(mesh, mesh.boundary_loops()[loop], true);
  return sources;
}

}  // namespace isopath
