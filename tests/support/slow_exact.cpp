#include "support/slow_exact.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <tuple>
#include <utility>

namespace isopath::test {
namespace {

using Real = SlowExact::Real;
using Vec = SlowExact::Vec;
using Space = Eigen::Matrix<Real, 3, 1>;

Real cross(const Vec& a, const Vec& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Beams of a smaller part of their edge are left out: the ways that bend at its ends pass as near.
constexpr Real narrowest = 1e-18L;

Real distance_to_segment(const Vec& p, const Vec& a, const Vec& b) {
  const Real squared = (b - a).squaredNorm();
  const Real t = squared > 0 ? std::clamp((p - a).dot(b - a) / squared, Real(0), Real(1)) : Real(0);
  return (p - a - t * (b - a)).norm();
}

/// Fraction of p q at which the line through `at` with this direction meets it.
Real meet(const Vec& p, const Vec& q, const Vec& at, const Vec& direction) {
  const Real denominator = cross(Vec(q - p), direction);
  return denominator == 0 ? Real(0.5) : std::clamp(cross(Vec(at - p), direction) / denominator, Real(0), Real(1));
}

/// Area of a triangle from its sides, stable for needles (Kahan, "Miscalculating area and angles of a needle-like
/// triangle").
Real area_of_sides(Real a, Real b, Real c) {
  std::array<Real, 3> s = {a, b, c};
  std::sort(s.begin(), s.end(), std::greater<>());
  const Real product =
      (s[0] + (s[1] + s[2])) * (s[2] - (s[0] - s[1])) * (s[2] + (s[0] - s[1])) * (s[0] + (s[1] - s[2]));
  return std::sqrt(std::max(Real(0), product)) / 4;
}

}  // namespace

Real SlowExact::Beam::passage_to(const Vec& at) const {
  if (is_parallel()) return at.x() - along.x() / along.y() * at.y();
  const Real rise = at.y() - from.y();
  return rise > 0 ? from.x() + (at.x() - from.x()) * (-from.y() / rise) : at.x();
}

SlowExact::SlowExact(const TriangleMesh& mesh)
    : mesh_(mesh),
      bends_(mesh.n_vertices(), 0),
      vertex_(mesh.n_vertices(), infinity),
      beams_of_face_(mesh.n_faces()),
      sources_of_face_(mesh.n_faces()) {}

SlowExact::SlowExact(const TriangleMesh& mesh, std::span<const SourceElement> sources) : SlowExact(mesh) {
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    const Space start = mesh.position(mesh.from(h)).cast<Real>();
    const Space along = mesh.position(mesh.to(h)).cast<Real>() - start;
    const Space towards = mesh.position(mesh.from(TriangleMesh::prev(h))).cast<Real>() - start;
    const Real base = along.norm();
    // Of short sides, the difference of two corners knows the direction badly (docs/robustness.md).
    const auto direction = [&](const Space& side) {
      const Real scale = base * side.norm();
      return scale > 0 ? Vec(along.dot(side) / scale, along.cross(side).norm() / scale) : Vec(Vec::Zero());
    };
    const Vec apex = base > 0 ? Vec(towards.norm() * direction(towards)) : Vec(Real(0), towards.norm());
    corners_.push_back({Vec(0, 0), Vec(base, 0), apex});
    sides_.push_back({direction(towards - along), -direction(towards)});
  }
  solve(sources);
}

SlowExact::SlowExact(const TriangleMesh& mesh, std::span<const double> edge_lengths,
                     std::span<const SourceElement> sources)
    : SlowExact(mesh) {
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    const auto length = [&](Index halfedge) { return Real(edge_lengths[mesh.edge_of(halfedge)]); };
    const Real base = length(h);
    const Real right = length(TriangleMesh::next(h));
    const Real left = length(TriangleMesh::prev(h));
    const Real x = (base + (left - right) * (left + right) / base) / 2;
    const Vec apex(x, 2 * area_of_sides(base, right, left) / base);
    corners_.push_back({Vec(0, 0), Vec(base, 0), apex});
    sides_.push_back({(apex - Vec(base, 0)).normalized(), -apex.normalized()});
  }
  solve(sources);
}

/// A point of the half-edge's face in its frame.
Vec SlowExact::place(const SurfacePoint& point, Index halfedge) const {
  const std::array<Vec, 3>& corners = corners_[halfedge];
  Vec at = Vec::Zero();
  for (int i = 0; i < 3; ++i) at += Real(point.barycentric[(halfedge + i) % 3]) * corners[i];
  return at;
}

/// Shortest bent way from the beam's origin to a point of the face it enters, through the beam's part of the edge.
Real SlowExact::shortest_through(const Beam& beam, const Vec& at) const {
  const Real length = length_of(beam.halfedge);
  const Real x = std::clamp(beam.passage_to(at), beam.low * length, beam.high * length);
  return beam.length_to({x, 0}) + (at - Vec(x, 0)).norm();
}

void SlowExact::find_bending_vertices() {
  std::vector<Real> angle(mesh_.n_vertices(), 0);
  for (Index h = 0; h < mesh_.n_halfedges(); ++h) {
    const Vec apex = corners_[h][2];
    angle[mesh_.from(h)] += std::atan2(apex.y(), apex.x());
  }
  // A vertex that is taken in wrongly costs time only.
  for (Index v = 0; v < mesh_.n_vertices(); ++v) {
    bends_[v] = mesh_.is_boundary_vertex(v) || angle[v] > 2 * std::numbers::pi_v<Real> - 1e-6;
  }
  // Rays from a vertex in the same place have no direction to come from.
  for (Index h = 0; h < mesh_.n_halfedges(); ++h) {
    if (length_of(h) == 0) bends_[mesh_.from(h)] = bends_[mesh_.to(h)] = true;
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
    const Vec start = place(a, h);
    const Vec end = place(b, h);
    relax(mesh_.from(h), distance_to_segment(Vec::Zero(), start, end));
    const int opposite = TriangleMesh::prev(h) % 3;
    if (a.barycentric[opposite] == 0 && b.barycentric[opposite] == 0) continue;
    if (start == end) {
      leave(h, {.low = 0, .high = 1, .from = start});
      continue;
    }
    const Vec unit = (end - start).normalized();
    if (unit.x() == 0) continue;
    // The strip of perpendiculars that go down to the edge; x where their feet are the segment's ends.
    const Vec down = unit.x() > 0 ? Vec(unit.y(), -unit.x()) : Vec(-unit.y(), unit.x());
    const Real length = length_of(h);
    const Real x1 = start.x() + start.y() * unit.y() / unit.x();
    const Real x2 = end.x() + end.y() * unit.y() / unit.x();
    leave(h, {.low = std::clamp(std::min(x1, x2) / length, Real(0), Real(1)),
              .high = std::clamp(std::max(x1, x2) / length, Real(0), Real(1)),
              .from = start,
              .along = down});
  }
}

void SlowExact::emit_from_vertex(Index vertex, Real sigma) {
  for (Index h = 0; h < mesh_.n_halfedges(); ++h) {
    if (mesh_.from(h) != vertex) continue;
    const Index opposite = TriangleMesh::next(h);
    leave(opposite, {.low = 0, .high = 1, .from = corners_[opposite][2], .sigma = sigma});
  }
}

void SlowExact::relax_along_edges(Index vertex, Real sigma) {
  for (Index h = 0; h < mesh_.n_halfedges(); ++h) {
    if (mesh_.from(h) == vertex) relax(mesh_.to(h), sigma + length_of(h));
    if (mesh_.to(h) == vertex) relax(mesh_.from(h), sigma + length_of(h));
  }
}

void SlowExact::relax(Index vertex, Real distance) {
  if (distance >= vertex_[vertex]) return;
  vertex_[vertex] = distance;
  queue_.push_back({distance, vertex});
  std::push_heap(queue_.begin(), queue_.end());
}

/// Inside a face the straight way is the shortest, so that a shortest way comes into a face but once.
bool SlowExact::has_passed(Index trail, Index face) const {
  for (; trail != no_index; trail = trail_[trail].before) {
    if (trail_[trail].face == face) return true;
  }
  return false;
}

/// Takes a beam, given in the frame of the half-edge it leaves its face by, over to the next face.
void SlowExact::leave(Index halfedge, Beam beam) {
  const Index twin = mesh_.twin(halfedge);
  if (twin == no_index || beam.high - beam.low < narrowest) return;
  if (beam.is_parallel() ? beam.along.y() >= 0 : beam.from.y() < 0) return;
  const Real length = length_of(halfedge);
  // From a corner that lies on the opposite edge a beam is a half-turn; from beside the edge it is nothing.
  const bool from_edge = !beam.is_parallel() && beam.from.y() == 0;
  if (from_edge && (beam.from.x() <= beam.low * length || beam.from.x() >= beam.high * length)) return;
  beam.halfedge = twin;
  beam.from = Vec(length, 0) - beam.from;
  beam.along = -beam.along;
  std::tie(beam.low, beam.high) = std::pair(1 - beam.high, 1 - beam.low);
  // Along the edge the beam's length grows by at most 1 per length. So when the way over the start is shorter at the
  // beam's far side, it is so everywhere in the beam; likewise for the end.
  const Real low = beam.low * length;
  const Real high = beam.high * length;
  const Real over_start = vertex_[mesh_.from(twin)] + high;
  const Real over_end = vertex_[mesh_.to(twin)] + length - low;
  if (beam.length_to({high, 0}) > over_start * (1 + 1e-12) || beam.length_to({low, 0}) > over_end * (1 + 1e-12)) return;
  if (has_passed(beam.trail, TriangleMesh::face_of(twin))) return;
  trail_.push_back({TriangleMesh::face_of(halfedge), beam.trail});
  beam.trail = static_cast<Index>(trail_.size()) - 1;
  const Real nearest = beam.is_parallel() ? std::min(beam.length_to({low, 0}), beam.length_to({high, 0}))
                                          : beam.length_to({std::clamp(beam.from.x(), low, high), 0});
  queue_.push_back({nearest, no_index, beam});
  std::push_heap(queue_.begin(), queue_.end());
}

void SlowExact::follow(const Beam& beam) {
  const Index h = beam.halfedge;
  beams_of_face_[TriangleMesh::face_of(h)].push_back(beam);
  const std::array<Vec, 3>& corners = corners_[h];
  relax(mesh_.from(TriangleMesh::prev(h)), shortest_through(beam, corners[2]));
  const Real low = beam.low * corners[1].x();
  const Real high = beam.high * corners[1].x();
  const Real split = beam.passage_to(corners[2]);
  for (int side = 0; side < 2; ++side) {
    const Vec start = side == 0 ? corners[1] : corners[2];
    const Vec end = side == 0 ? corners[2] : corners[0];
    if (side == 0 ? split >= high : split <= low) continue;
    const auto meeting = [&](Real x) { return meet(start, end, {x, 0}, beam.direction_through({x, 0})); };
    Beam child = beam;
    child.low = side == 0 ? meeting(high) : (split < high ? 0 : meeting(high));
    child.high = side == 1 ? meeting(low) : (split > low ? 1 : meeting(low));
    // All on one line: the half-turn from a corner on the edge (see leave) goes on as one.
    if (corners[2].y() == 0 && beam.from.y() == 0 && !beam.is_parallel()) {
      child.low = 0;
      child.high = 1;
    }
    const Vec& axis = sides_[h][side];
    const Vec offset = beam.from - start;
    child.from = {axis.dot(offset), cross(axis, offset)};
    child.along = {axis.dot(beam.along), cross(axis, beam.along)};
    leave(side == 0 ? TriangleMesh::next(h) : TriangleMesh::prev(h), child);
  }
}

void SlowExact::solve(std::span<const SourceElement> sources) {
  find_bending_vertices();
  for (const SourceElement& source : sources) {
    add_point(source.a);
    if (source.kind == SourceElement::Kind::segment) {
      add_point(source.b);
      add_segment(source.a, source.b);
    }
  }
  run();
  result_.assign(vertex_.begin(), vertex_.end());
}

void SlowExact::run() {
  while (!queue_.empty()) {
    std::pop_heap(queue_.begin(), queue_.end());
    const Event event = queue_.back();
    queue_.pop_back();
    if (event.vertex == no_index) {
      follow(event.beam);
    } else if (event.key <= vertex_[event.vertex]) {
      relax_along_edges(event.vertex, event.key);
      if (bends_[event.vertex]) emit_from_vertex(event.vertex, event.key);
    }
  }
}

double SlowExact::distance(const SurfacePoint& point) const {
  const Support support = support_of(mesh_, point);
  if (support.kind == Support::Kind::vertex) return result_[support.index];
  std::vector<SurfacePoint> places = {point};
  if (support.kind == Support::Kind::edge && mesh_.twin(support.index) != no_index) {
    places.push_back(express_in(mesh_, point, TriangleMesh::face_of(mesh_.twin(support.index))));
  }
  Real best = infinity;
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
  return static_cast<double>(best);
}

}  // namespace isopath::test
