#include "isopath/contour/spokes.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "isopath/core/error.h"

namespace isopath {
namespace {

/// A straight way over the surface, unfolded from face to face; goes on as far as it is asked for.
class StraightWay {
 public:
  StraightWay(const TriangleMesh& mesh, const SurfacePoint& start, const Vec3& direction) : mesh_(mesh) {
    enter(start.face, start.barycentric, direction, 0, -1);
  }

  /// How far the way leads, up to `length`.
  double reach(double length) {
    while (!ended_ && pieces_.back().end < length) go_on();
    return std::min(length, pieces_.back().end);
  }
  /// The point at a length that was reached, and the direction there.
  SurfacePoint at(double length) const {
    const Piece& piece = piece_at(length);
    Vec3 b = (piece.barycentric + (length - piece.start) * piece.change).cwiseMax(0);
    return {piece.face, b / b.sum()};
  }
  const Vec3& direction(double length) const { return piece_at(length).direction; }

 private:
  struct Piece {
    Index face;
    Vec3 barycentric;  // at the start
    Vec3 change;       // of the coordinates, per mm
    Vec3 direction;    // unit, in space
    double start;      // lengths along the way
    double end;
    int leaves_at;  // corner opposite the edge it leaves by
  };

  const Piece& piece_at(double length) const {
    const auto after = std::upper_bound(pieces_.begin() + 1, pieces_.end(), length,
                                        [](double value, const Piece& piece) { return value < piece.start; });
    return *(after - 1);
  }

  /// `opposite` is the corner opposite the edge that it comes in by, -1 where it starts.
  void enter(Index face, const Vec3& barycentric, const Vec3& direction, double start, int opposite) {
    const Triangle& corners = mesh_.triangle(face);
    const Vec3 ab = mesh_.position(corners[1]) - mesh_.position(corners[0]);
    const Vec3 ac = mesh_.position(corners[2]) - mesh_.position(corners[0]);
    const Vec3 normal = ab.cross(ac);
    const double squared = normal.squaredNorm();
    if (!(squared > 0)) {
      ended_ = true;
      if (pieces_.empty()) pieces_.push_back({face, barycentric, Vec3::Zero(), direction, start, start, 0});
      return;
    }
    Vec3 change;
    change[1] = normal.dot(direction.cross(ac)) / squared;
    change[2] = normal.dot(ab.cross(direction)) / squared;
    change[0] = -change[1] - change[2];
    double length = infinity;
    int leaves_at = 0;
    for (int i = 0; i < 3; ++i) {
      if (!(change[i] < 0) || i == opposite) continue;
      const double t = std::max(0.0, barycentric[i]) / -change[i];
      if (t < length) {
        length = t;
        leaves_at = i;
      }
    }
    if (length == infinity) {
      ended_ = true;
      length = 0;
    }
    pieces_.push_back({face, barycentric, change, direction, start, start + length, leaves_at});
    if (pieces_.size() > most_faces) ended_ = true;
  }

  void go_on() {
    const Piece last = pieces_.back();
    const Index out = TriangleMesh::next(3 * last.face + last.leaves_at);
    const Index in = mesh_.twin(out);
    if (in == no_index) {
      ended_ = true;
      return;
    }
    const Vec3 edge = (mesh_.position(mesh_.to(out)) - mesh_.position(mesh_.from(out))).stableNormalized();
    const Index face = TriangleMesh::face_of(in);
    const Vec3 inwards = mesh_.face_normal(last.face).cross(edge);
    const Vec3 onwards = mesh_.face_normal(face).cross(-edge);
    const double along = last.direction.dot(edge);
    const double across = std::max(0.0, -last.direction.dot(inwards));
    Vec3 direction = along * edge + across * onwards;
    if (!(direction.squaredNorm() > 0)) {
      ended_ = true;
      return;
    }
    direction.normalize();
    const Vec3 b = (last.barycentric + (last.end - last.start) * last.change).cwiseMax(0);
    const double head = b[TriangleMesh::next(out) % 3];
    const double tail = b[out % 3];
    const double t = head + tail > 0 ? head / (head + tail) : 0.5;
    Vec3 entry = Vec3::Zero();
    entry[in % 3] = t;
    entry[TriangleMesh::next(in) % 3] = 1 - t;
    enter(face, entry, direction, last.end, TriangleMesh::prev(in) % 3);
  }

  static constexpr std::size_t most_faces = 100000;
  const TriangleMesh& mesh_;
  std::vector<Piece> pieces_;
  bool ended_ = false;
};

Spoke spoke_from(const ExactField& field, const SurfacePoint& point, double tolerance) {
  const ExactField::Nearest start = field.nearest(point);
  if (!(start.distance < infinity)) return {};
  if (start.towards_source.isZero(0)) return {};
  StraightWay way(field.mesh(), point, -start.towards_source);
  const auto too_long = [&](double t) { return start.distance + t - field.value(way.at(t)) > tolerance; };
  // the distance grows by no more than the way, so that what is too long stays so
  double low = 0;
  double high = 4 * tolerance;
  bool met = false;
  while (!met) {
    const double reached = way.reach(high);
    met = too_long(reached);
    if (!met) low = reached;
    if (reached < high) {
      high = reached;
      break;
    }
    if (!met) high *= 2;
  }
  if (!met) return {start.distance + low, way.at(low), 1};
  while (high - low > 0.25 * tolerance) {
    const double middle = 0.5 * (low + high);
    (too_long(middle) ? high : low) = middle;
  }
  Spoke spoke{start.distance + low, way.at(low), 1};
  const double beyond = way.reach(high + 2 * tolerance);
  const Vec3 other = -field.nearest(way.at(beyond)).towards_source;
  spoke.axis_slope = std::min(1.0, 0.5 * (way.direction(beyond) + other).norm());
  return spoke;
}

}  // namespace

std::vector<Spoke> spokes(const ExactField& field, double tolerance, const Progress& progress) {
  if (!(tolerance > 0 && tolerance < infinity)) {
    throw Error(ErrorCode::bad_usage, "must be a positive length in mm",
                {.element = "tolerance", .value = fmt::format("{}", tolerance)});
  }
  const TriangleMesh& mesh = field.mesh();
  std::vector<Spoke> result(mesh.n_vertices());
  tbb::parallel_for(Index{0}, mesh.n_vertices(), [&](Index v) {
    if (v % 256 == 0) progress.checkpoint();
    const Index h = mesh.outgoing(v);
    if (h == no_index || field.vertex_distances()[v] == 0) return;
    // a way that starts at a vertex has no single face: beside it, the spoke is as good as the same
    constexpr double aside = 0.01;
    Vec3 barycentric = Vec3::Constant(aside);
    barycentric[h % 3] = 1 - 2 * aside;
    result[v] = spoke_from(field, {TriangleMesh::face_of(h), barycentric}, tolerance);
  });
  return result;
}

}  // namespace isopath
