#include <algorithm>

#include "isopath/field/exact_field_data.h"

namespace isopath {
namespace {

/// Where the straight way from p (y >= 0) to the window's source crosses the edge; the nearest point of the window
/// where it misses it.
struct Crossing {
  double x;
  double distance;
  Vec2 towards;
};

Crossing cross_window(const Window& w, const Vec2& p) {
  double x = p.x();
  if (w.kind == Window::Kind::point) {
    const double height = p.y() - w.source.y();
    if (height > 0) x += (w.source.x() - p.x()) * (p.y() / height);
    if (x >= w.begin && x <= w.end) return {x, w.offset + (p - w.source).norm(), w.source - p};
  } else {
    if (w.source.y() > 0) x -= w.source.x() / w.source.y() * p.y();
    if (x >= w.begin && x <= w.end) return {x, w.offset + w.source.dot(p), -w.source};
  }
  x = std::clamp(x, w.begin, w.end);
  const Vec2 there(x, 0);
  return {x, w.distance(x) + (p - there).norm(), there - p};
}

void consider_sources(const ExactFieldData& data, Index face, const Vec3& barycentric, WayBack& best) {
  const Vec2 p = data.geometry.in_frame(3 * face, barycentric);
  for (const Index id : data.sources_in(face)) {
    const SourceElement& element = data.sources.elements()[id];
    // A point on an edge or vertex may be stored with a neighbouring face; so may a segment along an edge.
    const Vec2 a = data.geometry.in_frame(3 * face, express_in(data.mesh, element.a, face).barycentric);
    double t = 0;
    Vec2 q = a;
    if (element.kind == SourceElement::Kind::segment) {
      const Vec2 b = data.geometry.in_frame(3 * face, express_in(data.mesh, element.b, face).barycentric);
      const double squared = (b - a).squaredNorm();
      if (squared > 0) t = std::clamp((p - a).dot(b - a) / squared, 0.0, 1.0);
      q = a + t * (b - a);
      // the ends belong to the points there
      if ((t == 0 || t == 1) && best.distance <= (p - q).norm()) continue;
    }
    const double d = (p - q).norm();
    if (d < best.distance) best = {d, id, WayBack::Stop::source, id, t, q - p};
  }
}

void consider_corners(const ExactFieldData& data, Index face, const Vec3& barycentric, WayBack& best) {
  const Vec2 p = data.geometry.in_frame(3 * face, barycentric);
  for (int i = 0; i < 3; ++i) {
    if (barycentric[i] == 1) continue;
    const Index v = data.mesh.triangle(face)[i];
    Vec3 corner = Vec3::Zero();
    corner[i] = 1;
    const Vec2 q = data.geometry.in_frame(3 * face, corner);
    const double d = data.distance[v] + (p - q).norm();
    if (d < best.distance) best = {d, data.root[v], WayBack::Stop::vertex, v, 0, q - p};
  }
}

}  // namespace

WayBack best_way_back(const ExactFieldData& data, Index face, const Vec3& barycentric, const SkippedEdges& skipped) {
  WayBack best;
  consider_sources(data, face, barycentric, best);
  consider_corners(data, face, barycentric, best);
  const auto& geometry = data.geometry;
  for (int i = 0; i < 3; ++i) {
    if (skipped.skip[i]) continue;
    const Index h = 3 * face + i;
    const Index edge = data.mesh.edge_of(h);
    const bool canonical = data.mesh.halfedge_of(edge) == h;
    const Vec2 p = geometry.in_frame(h, barycentric);
    data.for_each_window(edge, [&](const Window& stored) {
      if (stored.halfedge != h) return;
      const Window w = canonical ? stored : stored.flipped(geometry.length(h));
      const Crossing crossing = cross_window(w, p);
      if (crossing.distance < best.distance) {
        best = {crossing.distance, w.root, WayBack::Stop::edge, h, crossing.x, crossing.towards};
      }
    });
  }
  if (best.stop == WayBack::Stop::edge && best.at != 3 * face) {
    // into the frame of half-edge 3·face
    const Vec2 tail = best.at == 3 * face + 1 ? Vec2(geometry.length(3 * face), 0) : geometry.apex(3 * face);
    const Vec2 head = best.at == 3 * face + 1 ? geometry.apex(3 * face) : Vec2(Vec2::Zero());
    const Vec2 axis = (head - tail) / geometry.length(best.at);
    best.towards = axis * best.towards.x() + Vec2(-axis.y(), axis.x()) * best.towards.y();
  }
  return best;
}

}  // namespace isopath
