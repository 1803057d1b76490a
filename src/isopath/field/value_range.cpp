#include "isopath/field/value_range.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace isopath {
namespace {

/// A part of a face, by the barycentric coordinates of its corners.
struct Part {
  Index face;
  Vec3 corner[3];
  int depth;
};

constexpr int deepest = 24;

class RangeSearch {
 public:
  RangeSearch(const TriangleMesh& mesh, const SurfaceFunction& function, double tolerance)
      : mesh_(mesh), function_(function), tolerance_(tolerance) {}

  ValueRange run() {
    for (Index v = 0; v < mesh_.n_vertices(); ++v) {
      if (mesh_.outgoing(v) != no_index && std::isfinite(function_.value_at_vertex(v)))
        include(function_.value_at_vertex(v));
    }
    if (function_.linear_in_faces()) return range_;
    for (Index f = 0; f < mesh_.n_faces(); ++f) {
      const auto& corners = mesh_.triangle(f);
      const bool reached = std::all_of(corners.begin(), corners.end(),
                                       [&](Index v) { return std::isfinite(function_.value_at_vertex(v)); });
      if (reached) search({f, {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}, 0});
    }
    return range_;
  }

 private:
  void include(double value) {
    range_.low = std::min(range_.low, value);
    range_.high = std::max(range_.high, value);
  }

  void search(const Part& whole) {
    parts_.assign(1, whole);
    while (!parts_.empty()) {
      const Part part = parts_.back();
      parts_.pop_back();
      const Vec3 centre = (part.corner[0] + part.corner[1] + part.corner[2]) / 3;
      const Vec3 place = position_of(mesh_, {part.face, centre});
      double radius = 0;
      for (const Vec3& c : part.corner) radius = std::max(radius, (position_of(mesh_, {part.face, c}) - place).norm());
      const double value = function_.value({part.face, centre});
      include(value);
      const double reach = radius * function_.max_slope();
      const bool may_rise = value + reach > range_.high + tolerance_;
      const bool may_fall = value - reach < range_.low - tolerance_;
      if ((may_rise || may_fall) && part.depth < deepest) divide(part);
    }
  }

  /// In two across the longest side: thin parts become round.
  void divide(const Part& part) {
    int longest = 0;
    double most = -1;
    for (int i = 0; i < 3; ++i) {
      const double side =
          (position_of(mesh_, {part.face, part.corner[i]}) - position_of(mesh_, {part.face, part.corner[(i + 1) % 3]}))
              .norm();
      if (side > most) {
        most = side;
        longest = i;
      }
    }
    const Vec3 a = part.corner[longest];
    const Vec3 b = part.corner[(longest + 1) % 3];
    const Vec3 c = part.corner[(longest + 2) % 3];
    const Vec3 middle = 0.5 * (a + b);
    parts_.push_back({part.face, {a, middle, c}, part.depth + 1});
    parts_.push_back({part.face, {middle, b, c}, part.depth + 1});
  }

  const TriangleMesh& mesh_;
  const SurfaceFunction& function_;
  double tolerance_;
  ValueRange range_;
  std::vector<Part> parts_;
};

}  // namespace

ValueRange value_range(const TriangleMesh& mesh, const SurfaceFunction& function, double tolerance) {
  return RangeSearch(mesh, function, tolerance).run();
}

}  // namespace isopath
