#include "isopath/field/source_fronts.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "isopath/field/source_faces.h"

namespace isopath {
namespace {

constexpr double half_pi = std::numbers::pi / 2;
/// So many are started by one thread at a time.
constexpr Index elements_at_a_time = 1024;

/// Clips [low, high] to where f0 + slope·x >= 0.
void clip(double f0, double slope, double& low, double& high) {
  if (slope == 0) {
    if (f0 < 0) high = low;
    return;
  }
  const double x = -f0 / slope;
  if (slope > 0) {
    low = std::max(low, x);
  } else {
    high = std::min(high, x);
  }
}

bool on_edge(const SourceElement& segment, Index& halfedge) {
  for (int i = 0; i < 3; ++i) {
    if (segment.a.barycentric[i] == 0 && segment.b.barycentric[i] == 0) {
      halfedge = 3 * segment.a.face + (i + 1) % 3;
      return true;
    }
  }
  return false;
}

class FrontBuilder {
 public:
  FrontBuilder(const TriangleMesh& mesh, const IntrinsicGeometry& geometry) : mesh_(mesh), geometry_(geometry) {}

  /// All but points at vertices.
  void start(std::span<const SourceElement> elements, Index id) {
    if (elements[id].kind == SourceElement::Kind::segment) {
      start_segment(elements[id], id);
    } else {
      start_point(elements, id);
    }
  }
  std::vector<SourceFronts::Front> take() { return std::move(fronts_); }

 private:
  void start_segment(const SourceElement& element, Index id);
  void start_segment_in_face(const SourceElement& element, Index id, Index face);
  void start_point(std::span<const SourceElement> elements, Index id);
  void start_point_in_face(std::span<const SourceElement> elements, Index id, Index face);
  std::vector<Vec2> segment_directions(std::span<const SourceElement> elements, Index id, Index halfedge) const;
  void insert_leaving(Index halfedge, const Window& window) { fronts_.push_back({halfedge, window}); }

  const TriangleMesh& mesh_;
  const IntrinsicGeometry& geometry_;
  std::vector<SourceFronts::Front> fronts_;
};

/// Vertices that hold points, one after the other: several points of a path may meet in one.
class VertexSources {
 public:
  VertexSources(const TriangleMesh& mesh, const IntrinsicGeometry& geometry)
      : mesh_(mesh), geometry_(geometry), source_at_(mesh.n_vertices(), no_index) {}

  void start(std::span<const SourceElement> elements, Index id, Index vertex);
  std::vector<SourceFronts::Vertex> take() { return std::move(vertices_); }

 private:
  std::vector<BlockedArc> served_by_segments(std::span<const SourceElement> elements, Index id, Index vertex) const;

  const TriangleMesh& mesh_;
  const IntrinsicGeometry& geometry_;
  std::vector<Index> source_at_;  ///< per vertex: index into vertices_, or none
  std::vector<SourceFronts::Vertex> vertices_;
};

void FrontBuilder::start_segment(const SourceElement& element, Index id) {
  Index h = no_index;
  start_segment_in_face(element, id, element.a.face);
  if (!on_edge(element, h)) return;
  const double length = geometry_.length(h);
  const double xa = geometry_.in_frame(h, element.a.barycentric).x();
  const double xb = geometry_.in_frame(h, element.b.barycentric).x();
  Window window;
  window.kind = Window::Kind::line;
  window.begin = std::clamp(std::min(xa, xb), 0.0, length);
  window.end = std::clamp(std::max(xa, xb), 0.0, length);
  window.source = Vec2(0, -1);
  window.root = id;
  window.filler = true;  // the two faces beside it are served directly
  insert_leaving(h, window);
  if (mesh_.twin(h) != no_index) {
    const Index other = TriangleMesh::face_of(mesh_.twin(h));
    SourceElement mirrored = element;
    mirrored.a = express_in(mesh_, element.a, other);
    mirrored.b = express_in(mesh_, element.b, other);
    start_segment_in_face(mirrored, id, other);
  }
}

void FrontBuilder::start_segment_in_face(const SourceElement& element, Index id, Index face) {
  Index own_edge = no_index;
  on_edge(element, own_edge);
  for (Index h = 3 * face; h < 3 * face + 3; ++h) {
    if (own_edge != no_index && mesh_.edge_of(own_edge) == mesh_.edge_of(h)) continue;
    const Vec2 a = geometry_.in_frame(h, element.a.barycentric);
    const Vec2 b = geometry_.in_frame(h, element.b.barycentric);
    const double segment_length = (b - a).norm();
    if (segment_length == 0) continue;
    const Vec2 along = (b - a) / segment_length;
    for (const Vec2& travel : {Vec2(-along.y(), along.x()), Vec2(along.y(), -along.x())}) {
      if (!(travel.y() < 0)) continue;  // the front must leave the face through this edge
      Window window;
      window.kind = Window::Kind::line;
      window.begin = 0;
      window.end = geometry_.length(h);
      clip(-a.dot(along), along.x(), window.begin, window.end);
      clip(b.dot(along), -along.x(), window.begin, window.end);
      clip(-a.dot(travel), travel.x(), window.begin, window.end);
      if (!(window.begin < window.end)) continue;
      window.source = travel;
      window.offset = -a.dot(travel);
      window.root = id;
      insert_leaving(h, window);
    }
  }
}

std::vector<Vec2> FrontBuilder::segment_directions(std::span<const SourceElement> elements, Index id,
                                                   Index halfedge) const {
  const SourceElement& point = elements[id];
  const Support support = support_of(mesh_, point.a);
  std::vector<Vec2> directions;
  for (const Index s : {point.segment_before, point.segment_after}) {
    if (s == no_index) continue;
    // the segment leaves the point towards its other end
    const SourceElement& segment = elements[s];
    const bool before = s == point.segment_before;
    const SurfacePoint& near_end = before ? segment.b : segment.a;
    const SurfacePoint& far_end = before ? segment.a : segment.b;
    if (segment.a.face == TriangleMesh::face_of(halfedge)) {
      directions.push_back(
          (geometry_.in_frame(halfedge, far_end.barycentric) - geometry_.in_frame(halfedge, near_end.barycentric))
              .normalized());
      continue;
    }
    // in the face across the edge that carries the point: through the edge's frame into ours
    Index here = support.index;
    if (TriangleMesh::face_of(here) != TriangleMesh::face_of(halfedge)) here = mesh_.twin(here);
    const Index there = mesh_.twin(here);
    if (there == no_index || TriangleMesh::face_of(there) != segment.a.face) continue;
    const Vec2 d = geometry_.in_frame(there, far_end.barycentric) - geometry_.in_frame(there, near_end.barycentric);
    Vec2 in_edge_frame = -d;
    Vec3 tail = Vec3::Zero();
    Vec3 head = Vec3::Zero();
    tail[here % 3] = 1;
    head[TriangleMesh::next(here) % 3] = 1;
    const Vec2 x_axis = (geometry_.in_frame(halfedge, head) - geometry_.in_frame(halfedge, tail)).normalized();
    directions.push_back((x_axis * in_edge_frame.x() + Vec2(-x_axis.y(), x_axis.x()) * in_edge_frame.y()).normalized());
  }
  return directions;
}

void FrontBuilder::start_point(std::span<const SourceElement> elements, Index id) {
  const Support support = support_of(mesh_, elements[id].a);
  if (support.kind == Support::Kind::vertex) return;
  for (const Index face : faces_of(mesh_, elements[id])) start_point_in_face(elements, id, face);
  if (support.kind == Support::Kind::edge) {
    Window window;
    window.end = geometry_.length(support.index);
    window.source = Vec2(geometry_.in_frame(support.index, elements[id].a.barycentric).x(), 0);
    window.root = id;
    window.filler = true;
    insert_leaving(support.index, window);
  }
}

void FrontBuilder::start_point_in_face(std::span<const SourceElement> elements, Index id, Index face) {
  const SurfacePoint point = express_in(mesh_, elements[id].a, face);
  const Support support = support_of(mesh_, point);
  for (Index h = 3 * face; h < 3 * face + 3; ++h) {
    if (support.kind == Support::Kind::edge && support.index == h) continue;
    Window window;
    window.end = geometry_.length(h);
    window.source = geometry_.in_frame(h, point.barycentric);
    window.root = id;
    for (const Vec2& segment : segment_directions(elements, id, h)) {
      clip(segment.dot(window.source), -segment.x(), window.begin, window.end);
    }
    // Beside the edge many directions pass within a rounding error.
    window.begin = std::max(window.begin - geometry_.rounding(), 0.0);
    window.end = std::min(window.end + geometry_.rounding(), geometry_.length(h));
    if (window.begin < window.end) insert_leaving(h, window);
  }
}

std::vector<BlockedArc> VertexSources::served_by_segments(std::span<const SourceElement> elements, Index id,
                                                          Index vertex) const {
  std::vector<BlockedArc> arcs;
  double start = 0;
  Index h = mesh_.outgoing(vertex);
  do {
    for (const Index s : {elements[id].segment_before, elements[id].segment_after}) {
      if (s == no_index) continue;
      const SourceElement& segment = elements[s];
      const bool before = s == elements[id].segment_before;
      const SurfacePoint& far_end = before ? segment.a : segment.b;
      Index carrier = no_index;
      const bool along_edge = on_edge(segment, carrier);
      if (along_edge && mesh_.edge_of(carrier) == mesh_.edge_of(h)) {
        arcs.push_back({start, half_pi});
      } else if (along_edge && mesh_.edge_of(carrier) == mesh_.edge_of(TriangleMesh::prev(h)) &&
                 mesh_.twin(TriangleMesh::prev(h)) == no_index) {
        arcs.push_back({start + geometry_.angle_at_tail(h), half_pi});
      } else if (!along_edge && segment.a.face == TriangleMesh::face_of(h)) {
        const Vec2 d = geometry_.in_frame(h, far_end.barycentric);
        arcs.push_back({start + std::atan2(d.y(), d.x()), half_pi});
      }
    }
    start += geometry_.angle_at_tail(h);
    h = mesh_.next_outgoing(h);
  } while (h != no_index && h != mesh_.outgoing(vertex));
  return arcs;
}

void VertexSources::start(std::span<const SourceElement> elements, Index id, Index vertex) {
  if (source_at_[vertex] == no_index) {
    source_at_[vertex] = static_cast<Index>(vertices_.size());
    vertices_.push_back({vertex, id, served_by_segments(elements, id, vertex)});
    return;
  }
  SourceFronts::Vertex& shared = vertices_[source_at_[vertex]];
  shared.root = id;
  shared.blocked.clear();  // several elements meet: let the envelope choose
}

/// The fronts of all elements of a kind, in their order.
void add_fronts(const TriangleMesh& mesh, const IntrinsicGeometry& geometry, std::span<const SourceElement> elements,
                SourceElement::Kind kind, std::vector<SourceFronts::Front>& fronts, const Progress& progress) {
  const auto n = static_cast<Index>(elements.size());
  std::vector<std::vector<SourceFronts::Front>> parts((n + elements_at_a_time - 1) / elements_at_a_time);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t k) {
    progress.checkpoint();
    FrontBuilder builder(mesh, geometry);
    const Index first = static_cast<Index>(k) * elements_at_a_time;
    for (Index id = first; id < std::min(n, first + elements_at_a_time); ++id) {
      if (elements[id].kind == kind) builder.start(elements, id);
    }
    parts[k] = builder.take();
  });
  for (const auto& part : parts) fronts.insert(fronts.end(), part.begin(), part.end());
}

}  // namespace

SourceFronts source_fronts(const TriangleMesh& mesh, const IntrinsicGeometry& geometry, const SourceSet& sources,
                           Progress& progress) {
  const auto elements = sources.elements();
  SourceFronts fronts;
  // Straight fronts first: where a point's circle only ties with them, the segment keeps the root.
  for (const SourceElement::Kind kind : {SourceElement::Kind::segment, SourceElement::Kind::point})
    add_fronts(mesh, geometry, elements, kind, fronts.fronts, progress);
  VertexSources vertices(mesh, geometry);
  for (Index id = 0; id < static_cast<Index>(elements.size()); ++id) {
    if (elements[id].kind != SourceElement::Kind::point) continue;
    const Support support = support_of(mesh, elements[id].a);
    if (support.kind == Support::Kind::vertex) vertices.start(elements, id, support.index);
  }
  fronts.vertices = vertices.take();
  return fronts;
}

}  // namespace isopath
