#include "isopath/mesh/straight_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

constexpr double full_turn = 2 * std::numbers::pi;
/// Barycentric coordinates below this are rounding: the end of a walk lies on the edge.
constexpr double least_share = 1e-13;

Vec2 unit_at(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// A triangle laid out in the plane by one of its half-edges: origin at its tail, x along it, the face above. Side i is
/// the half-edge from corner i to corner i + 1; side 0 is that half-edge.
struct Layout {
  Layout(const TriangleMesh& mesh, Index halfedge)
      : side{halfedge, TriangleMesh::next(halfedge), TriangleMesh::prev(halfedge)} {
    const Vec3& origin = mesh.position(mesh.from(halfedge));
    const Vec3 to_head = mesh.position(mesh.to(halfedge)) - origin;
    const Vec3 to_apex = mesh.position(mesh.from(side[2])) - origin;
    const double width = to_head.norm();
    along = to_head / width;
    corner = {Vec2::Zero(), Vec2(width, 0), Vec2(along.dot(to_apex), along.cross(to_apex).norm())};
  }
  const Vec2& head(int i) const { return corner[(i + 1) % 3]; }
  double width() const { return corner[1].x(); }
  /// At corner 0.
  double angle() const { return std::atan2(corner[2].y(), corner[2].x()); }

  std::array<Index, 3> side;
  std::array<Vec2, 3> corner;
  Vec3 along;
};

/// A place on a half-edge, and the way from there into its face: a direction in the half-edge's layout.
struct Ray {
  Index halfedge = no_index;
  double at = 0;  ///< mm from the tail
  Vec2 direction = Vec2::UnitY();
};

/// Follows a straight way from triangle to triangle. Steps give the ray into the next one, none at the end.
class Walker {
 public:
  Walker(const TriangleMesh& mesh, const SurfacePoint& from, double longest)
      : mesh_(mesh), zero_(mesh.tolerance().length), rest_(longest) {
    walk_.points.push_back(from);
  }

  StraightWalk run(const Vec3& reference, double turn, double longest) {
    std::optional<Ray> ray = start(reference, turn);
    // Triangles without extent are passed without getting on; more of them in a row than there are is a circle.
    for (Index idle = 0; ray && rest_ > 0 && idle <= mesh_.n_faces();) {
      const double before = rest_;
      const Layout layout(mesh_, ray->halfedge);
      const Vec2 at(ray->at, 0);
      // From a vertex every way leaves through the side opposite, also one along an edge.
      const int exit = ray->at == 0 || cross(ray->direction, layout.corner[2] - at) > 0 ? 1 : 2;
      ray = leave(layout, at, ray->direction, exit);
      idle = before - rest_ > zero_ ? 0 : idle + 1;
    }
    walk_.length = longest - rest_;
    return std::move(walk_);
  }

 private:
  std::optional<Ray> start(const Vec3& reference, double turn);
  std::optional<Ray> start_in_face(const Layout& layout, double angle);
  std::optional<Ray> start_on_edge(const Layout& layout, double angle);
  std::optional<Ray> turn_at_vertex(Index halfedge, double angle, double turn);
  std::optional<Ray> leave(const Layout& layout, const Vec2& at, const Vec2& direction, int exit);
  std::optional<Ray> pass_vertex(const Layout& layout, int corner, const Vec2& direction);
  void end_inside(const Layout& layout, const Vec2& end);
  std::optional<Ray> stop_at_boundary() {
    walk_.at_boundary = true;
    return std::nullopt;
  }

  const TriangleMesh& mesh_;
  double zero_;
  double rest_;  // of the length
  StraightWalk walk_;
};

std::optional<Ray> Walker::start(const Vec3& reference, double turn) {
  const SurfacePoint& from = walk_.points.front();
  const Support support = support_of(mesh_, from);
  Index h = 3 * from.face;
  if (support.kind == Support::Kind::edge) h = support.index;
  while (support.kind == Support::Kind::vertex && mesh_.from(h) != support.index) ++h;
  const Layout layout(mesh_, h);
  const Vec2 in_plane(layout.along.dot(reference), mesh_.face_normal(from.face).cross(layout.along).dot(reference));
  if (!in_plane.allFinite() || in_plane.isZero(0)) {
    throw Error(ErrorCode::bad_usage, "a walk over the surface needs a direction in the face it starts in");
  }
  const double angle = std::atan2(in_plane.y(), in_plane.x());
  if (support.kind == Support::Kind::face) return start_in_face(layout, angle + turn);
  if (support.kind == Support::Kind::edge) return start_on_edge(layout, angle + turn);
  return turn_at_vertex(h, angle, turn);
}

std::optional<Ray> Walker::start_in_face(const Layout& layout, double angle) {
  const Vec3& share = walk_.points.front().barycentric;
  const Vec2 at = share[1] * layout.corner[1] + share[2] * layout.corner[2];
  const Vec2 direction = unit_at(angle);
  for (int i = 0; i < 3; ++i) {
    const bool tail_on_the_right = cross(direction, layout.corner[i] - at) <= 0;
    if (tail_on_the_right && cross(direction, layout.head(i) - at) > 0) return leave(layout, at, direction, i);
  }
  return std::nullopt;  // a triangle without area
}

std::optional<Ray> Walker::start_on_edge(const Layout& layout, double angle) {
  const Index h = layout.side[0];
  const double at = walk_.points.front().barycentric[TriangleMesh::next(h) % 3] * layout.width();
  const Vec2 direction = unit_at(angle);
  if (direction.y() >= 0) return Ray{h, at, direction};
  const Index g = mesh_.twin(h);
  if (g == no_index) return stop_at_boundary();
  return Ray{g, layout.width() - at, -direction};
}

/// From the direction that lies `angle` to the left of an outgoing half-edge, turns by `turn` in scaled angles.
std::optional<Ray> Walker::turn_at_vertex(Index halfedge, double angle, double turn) {
  const Index first = mesh_.outgoing(mesh_.from(halfedge));
  double total = 0;
  double before = 0;
  Index h = first;
  do {
    if (h == halfedge) before = total;
    total += Layout(mesh_, h).angle();
    h = mesh_.next_outgoing(h);
  } while (h != no_index && h != first);
  // At a boundary there is no way round that a full turn could stand for: angles are true there.
  const bool open = h == no_index;
  const double round = open ? std::max(full_turn, total) : total;
  double rest = before + angle + (open ? 1 : total / full_turn) * turn;
  rest -= round * std::floor(rest / round);
  if (open && rest > total) return stop_at_boundary();
  for (h = first;;) {
    const double corner = Layout(mesh_, h).angle();
    const Index next = mesh_.next_outgoing(h);
    // Rounding may leave a bit beyond the last corner.
    if (rest <= corner || next == no_index || next == first) return Ray{h, 0, unit_at(std::min(rest, corner))};
    rest -= corner;
    h = next;
  }
}

/// Goes from `at` in the triangle to where it leaves through a side, and over it.
std::optional<Ray> Walker::leave(const Layout& layout, const Vec2& at, const Vec2& direction, int exit) {
  const Vec2& tail = layout.corner[exit];
  const Vec2& head = layout.head(exit);
  const double right = -cross(direction, tail - at);
  const double left = cross(direction, head - at);
  const double t = std::clamp(right + left > 0 ? right / (right + left) : 1.0, 0.0, 1.0);
  const Vec2 crossing = tail + t * (head - tail);
  const double step = std::max(0.0, (crossing - at).dot(direction));
  if (step >= rest_) {
    end_inside(layout, at + rest_ * direction);
    rest_ = 0;
    return std::nullopt;
  }
  rest_ -= step;
  const double width = (head - tail).norm();
  if (t * width <= zero_) return pass_vertex(layout, exit, direction);
  if ((1 - t) * width <= zero_) return pass_vertex(layout, (exit + 1) % 3, direction);
  walk_.points.push_back(point_on_halfedge(layout.side[exit], t));
  const Index g = mesh_.twin(layout.side[exit]);
  if (g == no_index) return stop_at_boundary();
  const Vec2 along = (head - tail) / width;
  return Ray{g, (1 - t) * width, Vec2(-along.dot(direction), std::max(0.0, cross(direction, along)))};
}

std::optional<Ray> Walker::pass_vertex(const Layout& layout, int corner, const Vec2& direction) {
  const Index outgoing = layout.side[corner];
  const Index vertex = mesh_.from(outgoing);
  const SurfacePoint& last = walk_.points.back();
  const Support support = support_of(mesh_, last);
  if (support.kind != Support::Kind::vertex || support.index != vertex) {
    walk_.points.push_back(point_at_vertex(mesh_, vertex));
  }
  if (mesh_.is_boundary_vertex(vertex)) return stop_at_boundary();
  const Vec2 side = layout.head(corner) - layout.corner[corner];
  const double backwards = std::atan2(cross(side, -direction), side.dot(-direction));
  return turn_at_vertex(outgoing, std::clamp(backwards, 0.0, Layout(mesh_, outgoing).angle()), std::numbers::pi);
}

void Walker::end_inside(const Layout& layout, const Vec2& end) {
  const Vec2& apex = layout.corner[2];
  const double share = apex.y() > 0 ? std::clamp(end.y() / apex.y(), 0.0, 1.0) : 0.0;
  const double x = (end.x() - share * apex.x()) / layout.width();
  Vec3 shares = Vec3(1 - x - share, x, share).cwiseMax(0);
  for (double& s : shares) s = s < least_share ? 0 : s;
  shares /= shares.sum();
  SurfacePoint point{TriangleMesh::face_of(layout.side[0]), Vec3::Zero()};
  for (int i = 0; i < 3; ++i) point.barycentric[layout.side[i] % 3] = shares[i];
  walk_.points.push_back(point);
}

}  // namespace

StraightWalk straight_walk(const TriangleMesh& mesh, const SurfacePoint& from, const Vec3& reference, double turn,
                           double longest) {
  if (!(longest > 0) || longest == infinity || !std::isfinite(turn)) {
    throw Error(ErrorCode::bad_usage, "a walk over the surface needs a finite length above 0 and a finite turn");
  }
  return Walker(mesh, from, longest).run(reference, turn, longest);
}

StraightWalk straight_on(const TriangleMesh& mesh, const std::vector<SurfacePoint>& line, double longest) {
  const Vec3 back =
      line.size() < 2 ? Vec3(Vec3::Zero()) : position_of(mesh, line[line.size() - 2]) - position_of(mesh, line.back());
  if (!(back.norm() > mesh.tolerance().length)) {
    throw Error(ErrorCode::bad_usage, "a line that goes straight on needs a last segment with a length");
  }
  const Index face = common_face(mesh, line[line.size() - 2], line.back());
  return straight_walk(mesh, express_in(mesh, line.back(), face), back, std::numbers::pi, longest);
}

}  // namespace isopath
