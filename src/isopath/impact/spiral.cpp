#include "isopath/impact/spiral.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "isopath/core/quiet_progress.h"
#include "isopath/impact/moved_levels.h"
#include "isopath/impact/strip.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

/// A closed contour made ready for a strip: starting point first, and once more at the end; long chords divided.
struct Loop {
  double level = 0;
  SurfaceCurve curve;
  std::vector<double> arc;  ///< fraction of the whole length at each point, 0 to 1
};

/// A point of the segment between two points that share a face.
SurfacePoint between(const TriangleMesh& mesh, const SurfacePoint& a, const SurfacePoint& b, double t) {
  const Index face = common_face(mesh, a, b);
  const SurfacePoint in_a = express_in(mesh, a, face);
  const SurfacePoint in_b = express_in(mesh, b, face);
  return {face, (1 - t) * in_a.barycentric + t * in_b.barycentric};
}

/// Points nearer than `shortest` to the last kept one are skipped, chords longer than `longest` divided: a strip needs
/// rungs that are evenly spread, and no more of them than the spacing asks for.
Loop make_ring(const TriangleMesh& mesh, const Contour& contour, const Vec3& start, double shortest, double longest) {
  const SurfaceCurve all = make_curve(mesh, contour.points);
  const SurfaceCurve turned = rotated(all, nearest_index(all, start));
  Loop ring;
  ring.level = contour.level;
  double since_kept = 0;
  for (std::size_t i = 0; i < turned.size(); ++i) {
    const std::size_t next = (i + 1) % turned.size();
    const double chord = (turned.positions[next] - turned.positions[i]).norm();
    if (i == 0 || since_kept >= shortest) {
      ring.curve.add(mesh, turned.points[i]);
      since_kept = 0;
    }
    since_kept += chord;
    const int parts = static_cast<int>(std::ceil(chord / longest));
    for (int k = 1; k < parts; ++k) {
      const double t = static_cast<double>(k) / parts;
      ring.curve.add(mesh, between(mesh, turned.points[i], turned.points[next], t));
      since_kept = chord / parts;
    }
  }
  const SurfacePoint first = ring.curve.points.front();
  ring.curve.add(mesh, first);
  ring.arc.assign(1, 0.0);
  for (std::size_t i = 1; i < ring.curve.size(); ++i) {
    ring.arc.push_back(ring.arc.back() + (ring.curve.positions[i] - ring.curve.positions[i - 1]).norm());
  }
  for (double& a : ring.arc) a /= std::max(ring.arc.back(), 1e-300);
  return ring;
}

/// The point of a rung, a short curve on the surface that rises or falls from one contour to the next, where the
/// function has this level.
SurfacePoint point_at_level(const TriangleMesh& mesh, const SurfaceFunction& function,
                            const std::vector<SurfacePoint>& rung, double level, double tolerance) {
  // the piece of the rung that the level crosses first
  SurfacePoint a = rung.front();
  double f_a = function.value(a) - level;
  SurfacePoint b = a;
  double f_b = f_a;
  for (std::size_t k = 1; k < rung.size() && (f_a > 0) == (f_b > 0); ++k) {
    a = b;
    f_a = f_b;
    b = rung[k];
    f_b = function.value(b) - level;
  }
  if ((f_a > 0) == (f_b > 0)) return std::abs(f_a) < std::abs(f_b) ? a : b;
  double low = 0;
  double high = 1;
  SurfacePoint at = a;
  for (int step = 0; step < 40; ++step) {
    const double t = low + std::clamp(f_a / (f_a - f_b), 0.05, 0.95) * (high - low);
    at = between(mesh, a, b, t);
    const double f = function.value(at) - level;
    if (std::abs(f) <= tolerance) break;
    if ((f > 0) == (f_b > 0)) {
      high = t;
      f_b = f;
    } else {
      low = t;
      f_a = f;
    }
  }
  return at;
}

class SpiralBuilder {
 public:
  SpiralBuilder(const SurfaceLinker& linker, const SurfaceFunction& function, const Progress& progress)
      : linker_(linker), function_(function), progress_(progress) {}

  SurfaceCurve take() { return std::move(curve_); }

  /// Walks a contour whole, from its point nearest to a place.
  void walk_whole(const Contour& contour, const Vec3& from) {
    const SurfaceCurve ring = closed_from(linker_.mesh(), contour, from);
    for (const SurfacePoint& point : ring.points) extend(point);
  }

  Vec3 end() const { return curve_.positions.back(); }

  /// One turn from the contour the curve has come to, to the next one.
  bool turn(const Contour& from, const Contour& to, int splits) {
    const double gap = std::abs(to.level - from.level);
    const double shortest = 0.15 * gap;
    const double longest = 0.5 * gap;
    const Loop p = make_ring(linker_.mesh(), from, end(), shortest, longest);
    const Loop q = make_ring(linker_.mesh(), to, end(), shortest, longest);
    const Strip strip = least_strip(p.curve.positions, q.curve.positions, gap, 6 * gap, progress_);
    if (strip.empty()) return splits > 0 && turn_in_two(from, to, splits - 1);
    std::vector<std::optional<SurfacePoint>> at(strip.size());
    const auto find = [&](std::size_t k, bool plain) {
      const auto& [i, j] = strip[k];
      const double share = 0.5 * (p.arc[i] + q.arc[j]);
      if (at[k] || share <= 0 || share >= 1) return;
      const SurfacePoint& from_p = p.curve.points[i];
      const SurfacePoint& to_q = q.curve.points[j];
      const auto rung = plain ? linker_.plain_link(from_p, to_q, 8 * gap) : linker_.link(from_p, to_q, 8 * gap);
      if (!rung) return;
      const double level = (1 - share) * p.level + share * q.level;
      at[k] = point_at_level(linker_.mesh(), function_, rung->points, level, 1e-4 * gap);
    };
    tbb::parallel_for(std::size_t{0}, strip.size(), [&](std::size_t k) { find(k, true); });
    for (std::size_t k = 0; k < strip.size(); ++k) {
      find(k, false);  // what takes a field of its own
      if (at[k]) extend(*at[k]);
    }
    extend(q.curve.points.front());
    return true;
  }

 private:
  void extend(const SurfacePoint& to) {
    progress_.checkpoint();
    linker_.extend(curve_, to);
  }

  bool turn_in_two(const Contour& from, const Contour& to, int splits) {
    const double level = 0.5 * (from.level + to.level);
    QuietProgress quiet(progress_);
    for (const Contour& middle : contours_beside(linker_.mesh(), function_, from, level, quiet)) {
      if (!middle.closed) continue;
      const SurfaceCurve before = curve_;
      if (turn(from, middle, splits) && turn(middle, to, splits)) return true;
      curve_ = before;
    }
    return false;
  }

  const SurfaceLinker& linker_;
  const SurfaceFunction& function_;
  const Progress& progress_;
  SurfaceCurve curve_;
};

}  // namespace

SurfaceCurve spiral(const SurfaceLinker& linker, const SurfaceFunction& function,
                    std::span<const Contour* const> contours, const Vec3& start, const Progress& progress) {
  SpiralBuilder builder(linker, function, progress);
  builder.walk_whole(*contours.front(), start);
  bool whole = true;  // the last contour was walked all round
  for (std::size_t k = 1; k < contours.size(); ++k) {
    if (builder.turn(*contours[k - 1], *contours[k], 2)) {
      whole = false;
      continue;
    }
    if (!whole) builder.walk_whole(*contours[k - 1], builder.end());
    builder.walk_whole(*contours[k], builder.end());
    whole = true;
  }
  if (!whole) builder.walk_whole(*contours.back(), builder.end());
  return builder.take();
}

}  // namespace isopath
