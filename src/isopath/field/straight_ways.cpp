#include "isopath/field/straight_ways.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "isopath/field/source_faces.h"

namespace isopath {
namespace {

/// A ray that misses a vertex by less than this share of the way still reaches it: on grids many do, up to rounding.
constexpr double grazing = 1e-9;

/// The corner across a half-edge from its face, in the plane of its ends.
Vec2 unfolded(const TriangleMesh& mesh, Index twin, const Vec2& tail, const Vec2& head) {
  const double inverse = 1 / mesh.edge_length(mesh.edge_of(twin));
  const double from_tail = mesh.edge_length(mesh.edge_of(TriangleMesh::next(twin)));
  const double from_head = mesh.edge_length(mesh.edge_of(TriangleMesh::prev(twin)));
  const Vec2 edge = head - tail;
  const double along = 0.5 * (inverse * inverse * (from_tail - from_head) * (from_tail + from_head) + 1);
  const double to_foot = along / inverse;
  const double across = inverse * std::sqrt(std::max(0.0, (from_tail - to_foot) * (from_tail + to_foot)));
  return tail + along * edge + across * Vec2(edge.y(), -edge.x());
}

/// How far the second point lies left of the ray through the first; what is too little to count.
struct Turn {
  double by;
  double slack;
  bool is_left() const { return by > slack; }
  bool is_left_or_on() const { return by >= -slack; }
};
template <bool parallel>
Turn turn(const Vec2& right, const Vec2& left) {
  if (parallel) return {right.x() - left.x(), grazing * (std::abs(right.y()) + std::abs(left.y()))};
  return {cross(right, left), grazing * std::abs(right.dot(left))};
}

/// The corners of a face in its plane, with the origin and the direction of the x axis given in space.
std::array<Vec2, 3> laid_out(const TriangleMesh& mesh, Index face, const Vec3& origin, const Vec3& along) {
  const Vec3 x = along.normalized();
  const Vec3 y = mesh.face_normal(face).cross(x);
  std::array<Vec2, 3> corners;
  for (int i = 0; i < 3; ++i) {
    const Vec3 p = mesh.position(mesh.triangle(face)[i]) - origin;
    corners[i] = Vec2(p.dot(x), p.dot(y));
  }
  return corners;
}

}  // namespace

/// Lets rays go out through an edge of the face that the start is in, those that reach it.
void StraightWays::leave(Beam beam) {
  const auto is_left = [&](const Vec2& right, const Vec2& left) {
    return parallel_ ? turn<true>(right, left).is_left() : turn<false>(right, left).is_left();
  };
  if (!is_left(beam.tail, beam.head)) return;  // seen from the side or from outside
  if (!is_left(beam.tail, beam.right)) beam.right = beam.tail;
  if (!is_left(beam.left, beam.head)) beam.left = beam.head;
  if (is_left(beam.right, beam.left)) beams_.push_back(beam);
}

template <bool parallel>
void StraightWays::enter(const Beam& beam) {
  const Index twin = mesh_.twin(beam.halfedge);
  if (twin == no_index) return;
  const Vec2 apex = unfolded(mesh_, twin, beam.tail, beam.head);
  const Turn from_right = turn<parallel>(beam.right, apex);
  const Turn to_left = turn<parallel>(apex, beam.left);
  if (from_right.is_left_or_on() && to_left.is_left_or_on()) {
    const Index vertex = mesh_.from(TriangleMesh::prev(twin));
    ways_.push_back({static_cast<std::uint32_t>(vertex), parallel ? std::max(0.0, apex.y()) : apex.norm()});
  }
  if (from_right.is_left()) {
    beams_.push_back({TriangleMesh::next(twin), beam.tail, apex, beam.right, to_left.is_left() ? apex : beam.left});
  }
  if (to_left.is_left()) {
    beams_.push_back({TriangleMesh::prev(twin), apex, beam.head, from_right.is_left() ? apex : beam.right, beam.left});
  }
}

template <bool parallel>
void StraightWays::follow(std::size_t most_faces) {
  for (std::size_t k = 0; k < std::min(beams_.size(), most_faces); ++k) {
    const Beam beam = beams_[k];
    enter<parallel>(beam);
  }
  beams_.clear();
}

std::span<const StraightWays::Way> StraightWays::from_vertex(Index vertex, std::size_t most_faces) {
  ways_.clear();
  parallel_ = false;
  const Index start = mesh_.outgoing(vertex);
  for (Index h = start; h != no_index;) {
    const Index across = TriangleMesh::next(h);
    const double to_tail = mesh_.edge_length(mesh_.edge_of(h));
    const double to_head = mesh_.edge_length(mesh_.edge_of(TriangleMesh::prev(h)));
    const double length = mesh_.edge_length(mesh_.edge_of(across));
    const double x = to_tail > 0 ? 0.5 * (to_tail + (to_head - length) * (to_head + length) / to_tail) : 0;
    const Vec2 tail(to_tail, 0);
    const Vec2 head(x, std::sqrt(std::max(0.0, (to_head - x) * (to_head + x))));
    leave({across, tail, head, tail, head});
    h = mesh_.next_outgoing(h);
    if (h == start) break;
  }
  follow<false>(most_faces);
  return ways_;
}

void StraightWays::add_point(const SourceElement& element, Index face) {
  const Vec3 along = mesh_.position(mesh_.triangle(face)[1]) - mesh_.position(mesh_.triangle(face)[0]);
  const std::array<Vec2, 3> corners = laid_out(mesh_, face, position_of(mesh_, element.a), along);
  for (int i = 0; i < 3; ++i) {
    const Vec2& tail = corners[i];
    const Vec2& head = corners[(i + 1) % 3];
    ways_.push_back({static_cast<std::uint32_t>(mesh_.triangle(face)[i]), tail.norm()});
    leave({3 * face + i, tail, head, tail, head});
  }
}

void StraightWays::add_segment(const SourceElement& element, Index face, bool reversed) {
  const Vec3 a = position_of(mesh_, reversed ? element.b : element.a);
  const Vec3 along = position_of(mesh_, reversed ? element.a : element.b) - a;
  const double length = along.norm();
  if (!(length > 0)) return;
  const std::array<Vec2, 3> corners = laid_out(mesh_, face, a, along);
  for (int i = 0; i < 3; ++i) {
    const Vec2& tail = corners[i];
    const Vec2& head = corners[(i + 1) % 3];
    if (tail.x() >= 0 && tail.x() <= length && tail.y() >= -grazing * length) {
      ways_.push_back({static_cast<std::uint32_t>(mesh_.triangle(face)[i]), std::abs(tail.y())});
    }
    Beam beam{3 * face + i, tail, head, Vec2(length, 0), Vec2(0, 0)};
    // what lies behind the segment is met by no ray
    if ((tail.y() < 0) != (head.y() < 0)) {
      const Vec2 cut = tail + tail.y() / (tail.y() - head.y()) * (head - tail);
      if (tail.y() < 0) beam.right.x() = std::min(length, cut.x());
      if (head.y() < 0) beam.left.x() = std::max(0.0, cut.x());
    } else if (tail.y() < 0) {
      continue;
    }
    leave(beam);
  }
}

std::span<const StraightWays::Way> StraightWays::from_element(const SourceElement& element, std::size_t most_faces) {
  ways_.clear();
  parallel_ = element.kind == SourceElement::Kind::segment;
  for (const Index face : faces_of(mesh_, element)) {
    if (parallel_) {
      add_segment(element, face, false);
      add_segment(element, face, true);
      follow<true>(most_faces);
    } else {
      add_point(element, face);
    }
  }
  follow<false>(most_faces);
  return ways_;
}

}  // namespace isopath
