#include "support/slow_exact.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <tuple>
#include <utility>

namespace isopath::test {
namespace {

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const double squared = (b - a).squaredNorm();
  const double t = squared > 0 ? std::clamp((p - a).dot(b - a) / squared, 0.0, 1.0) : 0.0;
  return (p - a - t * (b - a)).norm();
}

/// Fraction of p q at which the line through `at` with this direction meets it.
double meet(const Vec2& p, const Vec2& q, const Vec2& at, const Vec2& direction) {
  const double denominator = cross(Vec2(q - p), direction);
  return denominator == 0 ? 0.5 : std::clamp(cross(Vec2(at - p), direction) / denominator, 0.0, 1.0);
}

/// Area of a triangle from its sides, stable for needles (Kahan, "Miscalculating area and angles of a needle-like
/// triangle").
double area_of_sides(double a, double b, double c) {
  std::array<double, 3> s = {a, b, c};
  std::sort(s.begin(), s.end(), std::greater<>());
  const double product =
      (s[0] + (s[1] + s[2])) * (s[2] - (s[0] - s[1])) * (s[2] + (s[0] - s[1])) * (s[0] + (s[1] - s[2]));
  return 0.25 * std::sqrt(std::max(0.0, product));
}

}  // namespace

double SlowExact::Beam::passage_to(const Vec2& at) const {
  if (is_parallel()) return at.x() - along.x() / along.y() * at.y();
  const double rise = at.y() - from.y();
  return rise > 0 ? from.x() + (at.x() - from.x()) * (-from.y() / rise) : at.x();
}

SlowExact::SlowExact(const TriangleMesh& mesh, std::span<const SourceElement> sources)
    : SlowExact(mesh, mesh.edge_lengths(), sources) {}

SlowExact::SlowExact(const TriangleMesh& mesh, std::span<const double> edge_lengths,
                     std::span<const SourceElement> sources)
    : mesh_(mesh),
      edge_length_(edge_lengths.begin(), edge_lengths.end()),
      bends_(mesh.n_vertices(), 0),
      vertex_(mesh.n_vertices(), infinity),
      beams_of_face_(mesh.n_faces()),
      sources_of_face_(mesh.n_faces()) {
  find_bending_vertices();
  for (const SourceElement& source : sources) {
    add_point(source.a);
    if (source.kind == SourceElement::Kind::segment) {
      add_point(source.b);
      add_segment(source.a, source.b);
    }
  }
  run();
}

/// Corners of the half-edge's face, in its frame: start, end, opposite.
std::array<Vec2, 3> SlowExact::corners_from(Index halfedge) const {
  const double base = length_of(halfedge);
  const double right = length_of(TriangleMesh::next(halfedge));
  const double left = length_of(TriangleMesh::prev(halfedge));
  const double x = 0.5 * (base + (left - right) * (left + right) / base);
  return {Vec2(0, 0), Vec2(base, 0), Vec2(x, 2 * area_of_sides(base, right, left) / base)};
}

/// A point of the half-edge's face in its frame.
Vec2 SlowExact::place(const SurfacePoint& point, Index halfedge) const {
  const std::array<Vec2, 3> corners = corners_from(halfedge);
  Vec2 at = Vec2::Zero();
  for (int i = 0; i < 3; ++i) at += point.barycentric[(halfedge + i) % 3] * corners[i];
  return at;
}

/// Shortest bent way from the beam's origin to a point of the face it enters, through the beam's part of the edge.
double SlowExact::shortest_through(const Beam& beam, const Vec2& at) const {
  const double length = length_of(beam.halfedge);
  const double x = std::clamp(beam.passage_to(at), beam.low * length, beam.high * length);
  return beam.length_to({x, 0}) + (at - Vec2(x, 0)).norm();
}

void SlowExact::find_bending_vertices() {
  std::vector<double> angle(mesh_.n_vertices(), 0);
  for (Index h = 0; h < mesh_.n_halfedges(); ++h) {
    const Vec2 apex = corners_from(h)[2];
    angle[mesh_.from(h)] += std::atan2(apex.y(), apex.x());
  }
  // A vertex that is taken in wrongly costs time only.
  for (Index v = 0; v < mesh_.n_vertices(); ++v) {
    bends_[v] = mesh_.is_boundary_vertex(v) || angle[v] > 2 * std::numbers::pi - 1e-6;
  }
}

void SlowExact::add_point(const SurfacePoint& point) {
  const Support support = support_of(mesh_, point);
  if (support.kind == Support::Kind::vertex) {
    relax(support.index, 0);
    emit_from_vertex(support.index, 0);
    return;
  }
  add_in_face(point, point);
  if (support.kind != Support::Kind::edge) return;
  if (const Index twin = mesh_.twin(support.index); twin != no_index) {
    const SurfacePoint there = express_in(mesh_, point, TriangleMesh::face_of(twin));
    add_in_face(there, there);
  }
}

void SlowExact::add_segment(const SurfacePoint& a, const SurfacePoint& b) {
  add_in_face(a, b);
  for (int i = 0; i < 3; ++i) {
    const Index twin = mesh_.twin(3 * a.face + (i + 1) % 3);
    if (a.barycentric[i] != 0 || b.barycentric[i] != 0 || twin == no_index) continue;
    const Index beside = TriangleMesh::face_of(twin);
    add_in_face(express_in(mesh_, a, beside), express_in(mesh_, b, beside));
  }
}

/// Beams of one source out of one face. The ends of a segment are added as points by themselves.
void SlowExact::add_in_face(const SurfacePoint& a, const SurfacePoint& b) {
  sources_of_face_[a.face].push_back({a, b});
  for (Index h = 3 * a.face; h < 3 * a.face + 3; ++h) {
    const Vec2 start = place(a, h);
    const Vec2 end = place(b, h);
    relax(mesh_.from(h), distance_to_segment(Vec2::Zero(), start, end));
    const int opposite = TriangleMesh::prev(h) % 3;
    if (a.barycentric[opposite] == 0 && b.barycentric[opposite] == 0) continue;
    if (start == end) {
      leave(h, {.low = 0, .high = 1, .from = start});
      continue;
    }
    const Vec2 unit = (end - start).normalized();
    if (unit.x() == 0) continue;
    // The strip of perpendiculars that go down to the edge; x where their feet are the segment's ends.
    const Vec2 down = unit.x() > 0 ? Vec2(unit.y(), -unit.x()) : Vec2(-unit.y(), unit.x());
    const double length = length_of(h);
    const double x1 = start.x() + start.y() * unit.y() / unit.x();
    const double x2 = end.x() + end.y() * unit.y() / unit.x();
    leave(h, {.low = std::clamp(std::min(x1, x2) / length, 0.0, 1.0),
              .high = std::clamp(std::max(x1, x2) / length, 0.0, 1.0),
              .from = start,
              .along = down});
  }
}

void SlowExact::emit_from_vertex(Index vertex, double sigma) {
  for (Index h = 0; h < mesh_.n_halfedges(); ++h) {
    if (mesh_.from(h) == vertex) {
      relax(mesh_.to(h), sigma + length_of(h));
      const Index opposite = TriangleMesh::next(h);
      leave(opposite, {.low = 0, .high = 1, .from = corners_from(opposite)[2], .sigma = sigma});
    }
    if (mesh_.to(h) == vertex) relax(mesh_.from(h), sigma + length_of(h));
  }
}

void SlowExact::relax(Index vertex, double distance) {
  if (distance >= vertex_[vertex]) return;
  vertex_[vertex] = distance;
  queue_.push_back({distance, vertex});
  std::push_heap(queue_.begin(), queue_.end());
}

/// Takes a beam, given in the frame of the half-edge it leaves its face by, over to the next face.
void SlowExact::leave(Index halfedge, Beam beam) {
  const Index twin = mesh_.twin(halfedge);
  if (twin == no_index || beam.high - beam.low < 1e-15) return;
  if (beam.is_parallel() ? beam.along.y() >= 0 : beam.from.y() <= 0) return;
  const double length = length_of(halfedge);
  beam.halfedge = twin;
  beam.from = Vec2(length, 0) - beam.from;
  beam.along = -beam.along;
  std::tie(beam.low, beam.high) = std::pair(1 - beam.high, 1 - beam.low);
  // Along the edge the beam's length grows by at most 1 per length. So when the way over the start is shorter at the
  // beam's far side, it is so everywhere in the beam; likewise for the end.
  const double low = beam.low * length;
  const double high = beam.high * length;
  const double over_start = vertex_[mesh_.from(twin)] + high;
  const double over_end = vertex_[mesh_.to(twin)] + length - low;
  if (beam.length_to({high, 0}) > over_start * (1 + 1e-12) || beam.length_to({low, 0}) > over_end * (1 + 1e-12)) return;
  const double nearest = beam.is_parallel() ? std::min(beam.length_to({low, 0}), beam.length_to({high, 0}))
                                            : beam.length_to({std::clamp(beam.from.x(), low, high), 0});
  queue_.push_back({nearest, no_index, beam});
  std::push_heap(queue_.begin(), queue_.end());
}

void SlowExact::follow(const Beam& beam) {
  const Index h = beam.halfedge;
  beams_of_face_[TriangleMesh::face_of(h)].push_back(beam);
  const std::array<Vec2, 3> corners = corners_from(h);
  relax(mesh_.from(TriangleMesh::prev(h)), shortest_through(beam, corners[2]));
  const double low = beam.low * corners[1].x();
  const double high = beam.high * corners[1].x();
  const double split = beam.passage_to(corners[2]);
  for (int side = 0; side < 2; ++side) {
    const Vec2 start = side == 0 ? corners[1] : corners[2];
    const Vec2 end = side == 0 ? corners[2] : corners[0];
    if (side == 0 ? split >= high : split <= low) continue;
    const auto meeting = [&](double x) { return meet(start, end, {x, 0}, beam.direction_through({x, 0})); };
    Beam child = beam;
    child.low = side == 0 ? meeting(high) : (split < high ? 0 : meeting(high));
    child.high = side == 1 ? meeting(low) : (split > low ? 1 : meeting(low));
    const Vec2 axis = (end - start).normalized();
    const Vec2 offset = beam.from - start;
    child.from = {axis.dot(offset), cross(axis, offset)};
    child.along = {axis.dot(beam.along), cross(axis, beam.along)};
    leave(side == 0 ? TriangleMesh::next(h) : TriangleMesh::prev(h), child);
  }
}

void SlowExact::run() {
  while (!queue_.empty()) {
    std::pop_heap(queue_.begin(), queue_.end());
    const Event event = queue_.back();
    queue_.pop_back();
    if (event.vertex == no_index) {
      follow(event.beam);
    } else if (bends_[event.vertex] && event.key <= vertex_[event.vertex]) {
      emit_from_vertex(event.vertex, event.key);
    }
  }
}

double SlowExact::distance(const SurfacePoint& point) const {
  const Support support = support_of(mesh_, point);
  if (support.kind == Support::Kind::vertex) return vertex_[support.index];
  std::vector<SurfacePoint> places = {point};
  if (support.kind == Support::Kind::edge && mesh_.twin(support.index) != no_index) {
    places.push_back(express_in(mesh_, point, TriangleMesh::face_of(mesh_.twin(support.index))));
  }
  double best = infinity;
  for (const SurfacePoint& there : places) {
    const Index first = 3 * there.face;
    for (Index h = first; h < first + 3; ++h) best = std::min(best, vertex_[mesh_.from(h)] + place(there, h).norm());
    for (const InFace& source : sources_of_face_[there.face]) {
      best = std::min(best, distance_to_segment(place(there, first), place(source.a, first), place(source.b, first)));
    }
    for (const Beam& beam : beams_of_face_[there.face]) {
      best = std::min(best, shortest_through(beam, place(there, beam.halfedge)));
    }
  }
  return best;
}

}  // namespace isopath::test
