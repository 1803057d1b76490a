#include "isopath/impact/lift.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "isopath/core/error.h"

namespace isopath {
namespace {

constexpr std::array<double, 4> heights = {1, 2, 4, 8};  ///< over the clearance
constexpr double untested_height = 1e-3;                 ///< over the clearance
constexpr double longest_arc_step = std::numbers::pi / 12;

double length_through(const Vec3& p, const std::vector<Vec3>& way_points, const Vec3& q) {
  double length = 0;
  Vec3 here = p;
  for (const Vec3& next : way_points) {
    length += (next - here).norm();
    here = next;
  }
  return length + (q - here).norm();
}

/// One end of the move: the point, its normal, and where the tested part of the way begins.
struct Foot {
  Vec3 point;
  Vec3 normal;
  Vec3 start;
};

/// The sphere that the way around the part runs on. Chords between its points that are at most `longest_arc_step`
/// apart keep the clearance from the sphere around the bounding box.
struct Sphere {
  Vec3 centre;
  double radius;

  Sphere(const Box3& bounds, const Foot& p, const Foot& q, double clearance) : centre(bounds.center()) {
    const double inner =
        std::max({0.5 * bounds.diagonal().norm(), (p.point - centre).norm(), (q.point - centre).norm()});
    radius = (inner + clearance) / std::cos(0.5 * longest_arc_step);
  }

  /// Where the ray from a point inside leaves the sphere; `direction` is a unit vector.
  Vec3 exit(const Vec3& from, const Vec3& direction) const {
    const Vec3 out = from - centre;
    const double along = out.dot(direction);
    const double t = -along + std::sqrt(along * along + std::max(0.0, radius * radius - out.squaredNorm()));
    return from + t * direction;
  }

  /// Points strictly between a and b on the great circle through them, on the side of `hint` when they are antipodal.
  std::vector<Vec3> arc(const Vec3& a, const Vec3& b, const Vec3& hint) const {
    const Vec3 u = (a - centre).normalized();
    Vec3 v = (b - centre).normalized();
    const double angle = std::atan2(u.cross(v).norm(), u.dot(v));
    v -= v.dot(u) * u;
    if (v.norm() < 1e-6) v = hint - hint.dot(u) * u;
    if (v.norm() < 1e-6) v = u.unitOrthogonal();
    v.normalize();
    const int steps = static_cast<int>(std::ceil(angle / longest_arc_step));
    std::vector<Vec3> points;
    for (int i = 1; i < steps; ++i) {
      const double t = angle * i / steps;
      points.push_back(centre + radius * (std::cos(t) * u + std::sin(t) * v));
    }
    return points;
  }
};

class LiftFinder {
 public:
  LiftFinder(const SurfaceLocator& surface, const Box3& bounds, const Foot& p, const Foot& q, double clearance)
      : surface_(surface), p_(p), q_(q), clearance_(clearance), sphere_(bounds, p, q, clearance) {}

  LiftPath find() const {
    LiftPath best = hop();
    return best.clear ? best : around();
  }

 private:
  bool free(const Vec3& a, const Vec3& b) const { return !surface_.intersects(a, b); }
  /// The points above a foot, at those heights that can be reached along the normal.
  std::vector<Vec3> retracts(const Foot& foot) const {
    std::vector<Vec3> out;
    for (const double height : heights) {
      const Vec3 above = foot.point + height * clearance_ * foot.normal;
      if (!free(foot.start, above)) break;
      out.push_back(above);
    }
    return out;
  }

  /// The shortest clear hop; unclear when there is none.
  LiftPath hop() const {
    LiftPath best;
    best.length = infinity;
    const std::vector<Vec3> ends = retracts(q_);
    for (const Vec3& a : retracts(p_)) {
      for (const Vec3& b : ends) {
        const double length = length_through(p_.point, {a, b}, q_.point);
        if (length < best.length && free(a, b)) best = {{a, b}, length, true};
      }
    }
    return best;
  }

  /// The way from a foot out to the sphere, outermost point last, and whether it is clear. From each height above the
  /// foot tries the normal, the radius, and the 26 directions to the neighbours in a cubic grid, nearest exit first.
  std::pair<std::vector<Vec3>, bool> way_out(const Foot& foot) const {
    const Vec3 straight = sphere_.exit(foot.point, foot.normal);
    if (free(foot.start, straight)) return {{straight}, true};
    for (const Vec3& above : retracts(foot)) {
      std::vector<Vec3> exits;
      if (!above.isApprox(sphere_.centre)) exits.push_back(sphere_.exit(above, (above - sphere_.centre).normalized()));
      for (int i = 0; i < 27; ++i) {
        const Vec3 direction(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        if (!direction.isZero()) exits.push_back(sphere_.exit(above, direction.normalized()));
      }
      std::stable_sort(exits.begin(), exits.end(), [&](const Vec3& a, const Vec3& b) {
        return (a - above).squaredNorm() < (b - above).squaredNorm();
      });
      for (const Vec3& exit : exits) {
        if (free(above, exit)) return {{above, exit}, true};
      }
    }
    return {{straight}, false};
  }

  LiftPath around() const {
    auto [way, clear_out] = way_out(p_);
    auto [back, clear_in] = way_out(q_);
    const std::vector<Vec3> arc = sphere_.arc(way.back(), back.back(), p_.normal + q_.normal);
    way.insert(way.end(), arc.begin(), arc.end());
    way.insert(way.end(), back.rbegin(), back.rend());
    const double length = length_through(p_.point, way, q_.point);
    return {std::move(way), length, clear_out && clear_in};
  }

  const SurfaceLocator& surface_;
  Foot p_;
  Foot q_;
  double clearance_;
  Sphere sphere_;
};

}  // namespace

LiftPath lift_between(const SurfaceLocator& surface, const Box3& bounds, const Vec3& p, const Vec3& np, const Vec3& q,
                      const Vec3& nq, double clearance) {
  if (!(clearance > 0 && std::isfinite(clearance))) {
    throw Error(ErrorCode::bad_usage, "the clearance of a lift must be a positive length",
                {.element = "clearance", .value = fmt::format("{}", clearance)});
  }
  const double low = untested_height * clearance;
  return LiftFinder(surface, bounds, {p, np, p + low * np}, {q, nq, q + low * nq}, clearance).find();
}

}  // namespace isopath
