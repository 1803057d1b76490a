#include "isopath/plan/curve_sources.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/core/segment.h"
#include "isopath/field/exact_field.h"
#include "isopath/mesh/straight_walk.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

constexpr double longest_over_size = 20;

/// The segments of a line, by the face they lie in, to find where it would cross itself.
class SegmentsByFace {
 public:
  explicit SegmentsByFace(const TriangleMesh& mesh) : mesh_(mesh) {}

  /// Adds the segment unless it crosses one that is there already; then the point of the crossing.
  std::optional<SurfacePoint> add_or_meet(const SurfacePoint& a, const SurfacePoint& b) {
    const Index face = common_face(mesh_, a, b);
    const Vec3 from = express_in(mesh_, a, face).barycentric;
    const Vec3 to = express_in(mesh_, b, face).barycentric;
    double first = infinity;
    for (const auto& [p, q] : by_face_[face]) first = std::min(first, crossing(from, to, p, q));
    if (first <= 1) return SurfacePoint{face, (1 - first) * from + first * to};
    by_face_[face].emplace_back(from, to);
    return std::nullopt;
  }

 private:
  /// Fraction of the segment a–b at which it properly crosses p–q, in barycentric coordinates; infinity where it does
  /// not. Segments that only share an end do not cross.
  static double crossing(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q) {
    const auto side = [](const Vec3& s, const Vec3& t, const Vec3& x) {
      return cross(Vec2((t - s).head<2>()), Vec2((x - s).head<2>()));
    };
    constexpr double rounding = 1e-12;  // barycentric coordinates are of the order of one
    const double pa = side(p, q, a);
    const double pb = side(p, q, b);
    const double ap = side(a, b, p);
    const double aq = side(a, b, q);
    const bool apart =
        std::min(std::abs(pa), std::abs(pb)) > rounding && std::min(std::abs(ap), std::abs(aq)) > rounding;
    return apart && (pa > 0) != (pb > 0) && (ap > 0) != (aq > 0) ? pa / (pa - pb) : infinity;
  }

  const TriangleMesh& mesh_;
  std::unordered_map<Index, std::vector<std::pair<Vec3, Vec3>>> by_face_;
};

bool has_boundary(const TriangleMesh& mesh, Index component) {
  const auto& loops = mesh.boundary_loops();
  return std::any_of(loops.begin(), loops.end(), [&](const auto& loop) {
    return mesh.component_of(TriangleMesh::face_of(loop.front())) == component;
  });
}

/// Takes off end points that are one place with the next: no way leads straight on from these.
void trim_ends(const TriangleMesh& mesh, std::vector<SurfacePoint>& line) {
  const auto is_one_place = [&](const SurfacePoint& p, const SurfacePoint& q) {
    return (position_of(mesh, p) - position_of(mesh, q)).norm() <= mesh.tolerance().length;
  };
  for (int end = 0; end < 2; ++end) {
    while (line.size() > 2 && is_one_place(line[line.size() - 2], line.back())) line.pop_back();
    std::reverse(line.begin(), line.end());
  }
}

/// Appends the way straight on, up to where it meets the segments seen so far.
void go_on(const TriangleMesh& mesh, std::vector<SurfacePoint>& line, SegmentsByFace& seen, double longest) {
  const StraightWalk walk = straight_on(mesh, line, longest);
  for (std::size_t i = 1; i < walk.points.size(); ++i) {
    const auto meeting = seen.add_or_meet(walk.points[i - 1], walk.points[i]);
    line.push_back(meeting ? *meeting : walk.points[i]);
    if (meeting) return;
  }
}

std::vector<double> arcs_of(const TriangleMesh& mesh, const std::vector<Index>& loop) {
  std::vector<double> arc = {0};
  for (const Index h : loop) arc.push_back(arc.back() + mesh.edge_length(mesh.edge_of(h)));
  return arc;
}

}  // namespace

std::vector<SurfacePoint> shortest_way(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                       Progress& progress) {
  SourceSet end;
  end.add_point(to);
  // The points are mostly near each other: look nearby first, since a field over all of the part costs more.
  double reach = 2 * (position_of(mesh, from) - position_of(mesh, to)).norm() + mesh.tolerance().length;
  for (;; reach = reach < 4 * mesh.size() ? 4 * reach : infinity) {
    const ExactField field = ExactField::compute(mesh, end, {.stop_distance = reach}, progress);
    // Up to the stop distance the field is exact, beyond it is not.
    if (field.value(from) <= reach) return field.shortest_path(from);
  }
}

std::vector<SurfacePoint> geodesic_through(const TriangleMesh& mesh, const SurfacePoint& a, const SurfacePoint& b,
                                           Progress& progress) {
  if (mesh.component_of(a.face) != mesh.component_of(b.face)) {
    throw Error(ErrorCode::bad_usage, "the two points lie on different components of the mesh");
  }
  if (!((position_of(mesh, a) - position_of(mesh, b)).norm() > mesh.tolerance().length)) {
    throw Error(ErrorCode::bad_usage, "the two points are one place on the surface",
                {.advice = "give two that lie apart"});
  }
  std::vector<SurfacePoint> line = shortest_way(mesh, a, b, progress);
  trim_ends(mesh, line);
  SegmentsByFace seen(mesh);
  for (std::size_t i = 1; i < line.size(); ++i) seen.add_or_meet(line[i - 1], line[i]);
  const double longest = (has_boundary(mesh, mesh.component_of(a.face)) ? longest_over_size : 1) * mesh.size();
  for (int end = 0; end < 2; ++end) {
    progress.checkpoint();
    go_on(mesh, line, seen, longest);
    std::reverse(line.begin(), line.end());
  }
  return line;
}

Vec3 cut_normal(double angle, double tilt) {
  const Vec3 left(-std::sin(angle), std::cos(angle), 0);
  return std::cos(tilt) * left - std::sin(tilt) * Vec3::UnitZ();
}

BoundaryPlace nearest_on_boundary(const TriangleMesh& mesh, const Vec3& point) {
  const auto& loops = mesh.boundary_loops();
  if (loops.empty()) {
    throw Error(ErrorCode::bad_usage, "the mesh is closed: it has no boundary",
                {.advice = "use 'auto', 'cut:...' or 'geodesic:...'"});
  }
  BoundaryPlace best{.distance = infinity};
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const std::vector<double> arc = arcs_of(mesh, loops[k]);
    for (std::size_t i = 0; i < loops[k].size(); ++i) {
      const Vec3& tail = mesh.position(mesh.from(loops[k][i]));
      const Vec3& head = mesh.position(mesh.to(loops[k][i]));
      const double t = nearest_on_segment(tail, head, point);
      const double distance = (mix(tail, head, t) - point).norm();
      if (distance >= best.distance) continue;
      const double share = ((1 - t) * arc[i] + t * arc[i + 1]) / arc.back();
      best = {static_cast<Index>(k), share < 1 ? share : 0, distance};
    }
  }
  return best;
}

std::vector<SurfacePoint> boundary_segment(const TriangleMesh& mesh, Index loop, double from, double to) {
  if (!std::isfinite(from) || !std::isfinite(to) || from == to) {
    throw Error(ErrorCode::bad_usage, "the segment of the boundary has no length",
                {.advice = "give two shares of the loop's length that differ; 0,1 is all of it"});
  }
  const std::vector<Index>& edges = mesh.boundary_loops()[loop];
  const std::vector<double> arc = arcs_of(mesh, edges);
  const bool whole = std::abs(to - from) >= 1;
  const double start = (from - std::floor(from)) * arc.back();
  const double part = whole ? 1 : to - from - std::floor(to - from);
  double rest = part * arc.back();
  const double zero = mesh.tolerance().length;

  auto i = static_cast<std::size_t>(std::upper_bound(arc.begin(), arc.end(), start) - arc.begin()) - 1;
  i = std::min(i, edges.size() - 1);
  double at = start - arc[i];
  std::vector<SurfacePoint> points;
  const auto add = [&](std::size_t edge, double mm) {
    const double length = arc[edge + 1] - arc[edge];
    const double t = mm <= zero ? 0 : length - mm <= zero ? 1 : mm / length;
    points.push_back(point_on_halfedge(edges[edge], t));
  };
  add(i, at);
  if (arc[i + 1] - arc[i] - at <= zero) {  // it starts at the edge's end
    at = 0;
    i = (i + 1) % edges.size();
  }
  for (;;) {
    const double left = arc[i + 1] - arc[i] - at;
    if (rest <= left + zero) break;
    rest -= left;
    points.push_back(point_on_halfedge(edges[i], 1));
    at = 0;
    i = (i + 1) % edges.size();
  }
  add(i, std::min(at + rest, arc[i + 1] - arc[i]));
  return points;
}

}  // namespace isopath
