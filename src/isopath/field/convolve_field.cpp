#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/smooth_field.h"
#include "isopath/field/smooth_field_checks.h"

namespace isopath {
namespace {

/// The vertices near another one and their distances from it. Kept between calls, so that each costs no more than what
/// it finds.
class Disc {
 public:
  explicit Disc(const TriangleMesh& mesh, const IntrinsicGeometry& geometry)
      : mesh_(mesh), geometry_(geometry), distance_(static_cast<std::size_t>(mesh.n_vertices()), infinity) {}

  struct Near {
    Index vertex;
    double distance;
  };

  /// All vertices nearer than the radius, the centre first.
  const std::vector<Near>& around(Index centre, double radius) {
    for (const Near& near : found_) distance_[near.vertex] = infinity;
    found_.clear();
    radius_ = radius;
    meet(centre, 0);
    if (mesh_.outgoing(centre) == no_index) return found_;
    for (Index h = mesh_.outgoing(centre); h != no_index;) {
      look_through(h);
      h = mesh_.next_outgoing(h);
      if (h == mesh_.outgoing(centre)) break;
    }
    go_along_edges();
    for (Near& near : found_) near.distance = distance_[near.vertex];
    return found_;
  }

 private:
  /// Light from the centre through part of a half-edge, into the half-edge's face: the centre in its frame, at y <= 0,
  /// and two points that bound the rays.
  struct Beam {
    Index halfedge;
    Vec2 centre;
    Vec2 left, right;
  };

  void meet(Index vertex, double distance) {
    if (distance >= radius_ || distance >= distance_[vertex]) return;
    if (distance_[vertex] == infinity) found_.push_back({vertex, distance});
    distance_[vertex] = distance;
  }

  /// Follows all straight ways that leave the centre between the two edges of a face.
  void look_through(Index out) {
    const Index far = TriangleMesh::next(out);
    meet(mesh_.from(far), geometry_.length(out));
    meet(mesh_.to(far), geometry_.length(TriangleMesh::prev(out)));
    if (mesh_.twin(far) == no_index) return;
    const Index h = mesh_.twin(far);
    const Vec2 apex = geometry_.apex(far);
    const double length = geometry_.length(h);
    beams_.push_back({h, Vec2(length - apex.x(), -apex.y()), Vec2(0, 0), Vec2(length, 0)});
    while (!beams_.empty()) {
      const Beam beam = beams_.back();
      beams_.pop_back();
      cross(beam);
    }
  }

  void cross(const Beam& beam) {
    const Vec2 apex = geometry_.apex(beam.halfedge);
    const Vec2 to_apex = apex - beam.centre;
    // above the half-edge, its start is on the left of rays that go up
    const double from_left = cross_of(to_apex, beam.left - beam.centre);
    const double from_right = cross_of(beam.right - beam.centre, to_apex);
    if (from_left >= 0 && from_right >= 0) meet(mesh_.from(TriangleMesh::prev(beam.halfedge)), to_apex.norm());
    const Index right_side = TriangleMesh::next(beam.halfedge);  // from the end up to the corner
    const Index left_side = TriangleMesh::prev(beam.halfedge);   // from the corner down to the start
    if (from_left > 0) pass_on(beam, left_side, apex, Vec2::Zero(), beam.left, from_right > 0 ? apex : beam.right);
    if (from_right > 0) {
      const Vec2 end(geometry_.length(beam.halfedge), 0);
      pass_on(beam, right_side, end, apex, from_left > 0 ? apex : beam.left, beam.right);
    }
  }

  static double cross_of(const Vec2& a, const Vec2& b) { return isopath::cross(a, b); }

  /// The part of a beam between two bounds leaves through a side that runs from `start` to `end`.
  void pass_on(const Beam& beam, Index side, const Vec2& start, const Vec2& end, const Vec2& left, const Vec2& right) {
    const Index h = mesh_.twin(side);
    if (h == no_index || distance_to(beam.centre, start, end) >= radius_) return;
    const double length = geometry_.length(h);
    if (!(length > 0)) return;
    const Vec2 along = (start - end) / length;  // the twin's direction
    const auto in_frame = [&](const Vec2& p) { return Vec2((p - end).dot(along), isopath::cross(along, p - end)); };
    beams_.push_back({h, in_frame(beam.centre), in_frame(left), in_frame(right)});
  }

  static double distance_to(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 along = b - a;
    const double squared = along.squaredNorm();
    const double t = squared > 0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0;
    return (a + t * along - p).norm();
  }

  void go_along_edges() {
    using Entry = std::pair<double, Index>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (const Near& near : found_) queue.push({distance_[near.vertex], near.vertex});
    while (!queue.empty()) {
      const double distance = queue.top().first;
      const Index vertex = queue.top().second;
      queue.pop();
      if (distance > distance_[vertex]) continue;
      const auto step = [&](Index other, double length) {
        if (!(distance + length < std::min(radius_, distance_[other]))) return;
        meet(other, distance + length);
        queue.push({distance + length, other});
      };
      for (Index h = mesh_.outgoing(vertex); h != no_index;) {
        step(mesh_.to(h), geometry_.length(h));
        const Index back = TriangleMesh::prev(h);  // the only half-edge of an edge on the boundary may arrive here
        step(mesh_.from(back), geometry_.length(back));
        h = mesh_.next_outgoing(h);
        if (h == mesh_.outgoing(vertex)) break;
      }
    }
  }

  const TriangleMesh& mesh_;
  const IntrinsicGeometry& geometry_;
  double radius_ = 0;
  std::vector<double> distance_;
  std::vector<Near> found_;
  std::vector<Beam> beams_;
};

double kernel(double distance, double radius) {
  const double t = 1 - (distance / radius) * (distance / radius);
  return t * t;
}

}  // namespace

std::vector<double> convolved(const TriangleMesh& mesh, const SurfaceLaplacian& laplacian,
                              std::span<const double> values, const ConvolutionOptions& options,
                              const Progress& progress) {
  if (!(options.radius > 0 && options.radius < infinity)) {
    throw Error(ErrorCode::bad_usage, "the radius of smoothing is not a positive length",
                {.element = "radius", .value = fmt::format("{} mm", options.radius)});
  }
  check_smoothing(laplacian, values, options.local, options.conserve_volume);
  const IntrinsicGeometry geometry(mesh);
  std::vector<double> result(values.begin(), values.end());
  tbb::parallel_for(tbb::blocked_range<Index>(0, mesh.n_vertices(), 512), [&](const tbb::blocked_range<Index>& range) {
    Disc disc(mesh, geometry);
    for (Index v = range.begin(); v < range.end(); ++v) {
      const double radius = options.radius * (options.local.empty() ? 1 : options.local[v]);
      if (!(radius > 0) || !std::isfinite(values[v])) continue;
      progress.checkpoint();
      double sum = 0;
      double weights = 0;
      for (const auto& [vertex, distance] : disc.around(v, radius)) {
        if (!std::isfinite(values[vertex])) continue;
        const double weight = laplacian.area[vertex] * kernel(distance, radius);
        // differences to the value itself, so that a constant stays what it is to the last digit
        sum += weight * (values[vertex] - values[v]);
        weights += weight;
      }
      if (weights > 0) result[v] = values[v] + sum / weights;
    }
  });
  if (options.conserve_volume) restore_volume(laplacian, values, result);
  return result;
}

}  // namespace isopath
