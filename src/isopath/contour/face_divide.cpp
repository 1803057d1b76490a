// How a face with an ambiguous or hidden level set is divided: the 1-to-4 subdivision of the paper's chapter 5, with
// crossings on the new edges found by a search that cannot miss one of a function of bounded slope.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "isopath/contour/face_cut.h"
#include "isopath/core/segment.h"

namespace isopath {

void FaceCutter::divide(const Corners& corners, const Sides& sides, int depth) {
  const std::size_t n_crossings = sides[0].size() + sides[1].size() + sides[2].size();
  if (must_split(corners, n_crossings, depth)) {
    split(corners, sides, depth);
  } else if (n_crossings > 0) {
    link(corners, sides);
  }
}

bool FaceCutter::must_split(const Corners& corners, std::size_t n_crossings, int depth) const {
  if (linear_ || depth >= deepest_) return false;
  return n_crossings > 2 || (!monotone_ && may_hide_loop(corners, depth));
}

/// Whether a loop could lie inside: the level must be in reach of the centre, and as a loop goes round an extremum,
/// ascents that all point one way speak against it. These samples are trusted only where the triangle is already small.
bool FaceCutter::may_hide_loop(const Corners& corners, int depth) const {
  const Vec3 centre = (corners[0].barycentric + corners[1].barycentric + corners[2].barycentric) / 3;
  double radius = 0;
  for (const Corner& corner : corners) {
    radius = std::max(radius, (plane(corner.barycentric) - plane(centre)).norm());
  }
  if (radius <= chord_tolerance_ || std::abs(value_at(centre)) > max_slope_ * radius) return false;
  if (depth < 3) return true;
  std::array<Vec3, 4> ascents;
  for (int i = 0; i < 3; ++i) ascents[i] = function_.slope({face_, corners[i].barycentric}).ascent;
  ascents[3] = function_.slope({face_, centre}).ascent;
  const Vec3 mean = ascents[0] + ascents[1] + ascents[2] + ascents[3];
  return std::any_of(ascents.begin(), ascents.end(), [&](const Vec3& ascent) { return ascent.dot(mean) <= 0; });
}

void FaceCutter::split(const Corners& corners, const Sides& sides, int depth) {
  std::array<Corner, 3> middle;
  std::array<Side, 3> first;
  std::array<Side, 3> second;
  for (int i = 0; i < 3; ++i) {
    for (const Mark& mark : sides[i]) {
      if (mark.parameter < 0.5) {
        first[i].push_back({2 * mark.parameter, mark.node});
      } else {
        second[i].push_back({2 * mark.parameter - 1, mark.node});
      }
    }
    const Vec3 centre = (corners[i].barycentric + corners[(i + 1) % 3].barycentric) / 2;
    middle[i] = corner_at(centre, corners[i].above != (first[i].size() % 2 == 1));
  }
  const auto reversed = [](Side side) {
    std::reverse(side.begin(), side.end());
    for (Mark& mark : side) mark.parameter = 1 - mark.parameter;
    return side;
  };
  const Side cut0 = find_crossings(middle[0], middle[2], depth + 1);  // cuts off corner 0, and so on
  const Side cut1 = find_crossings(middle[1], middle[0], depth + 1);
  const Side cut2 = find_crossings(middle[2], middle[1], depth + 1);
  divide({corners[0], middle[0], middle[2]}, {first[0], cut0, second[2]}, depth + 1);
  divide({corners[1], middle[1], middle[0]}, {first[1], cut1, second[0]}, depth + 1);
  divide({corners[2], middle[2], middle[1]}, {first[2], cut2, second[1]}, depth + 1);
  divide({middle[0], middle[1], middle[2]}, {reversed(cut1), reversed(cut2), reversed(cut0)}, depth + 1);
}

/// Joins the crossings around a triangle. Two leave no choice; more are matched by the sign of the centre: the side
/// that it is not on is cut off in single stretches, which never cross.
void FaceCutter::link(const Corners& corners, const Sides& sides) {
  std::vector<Index> around;
  for (const Side& side : sides) {
    for (const Mark& mark : side) around.push_back(mark.node);
  }
  const std::size_t n = around.size();
  const bool centre_above =
      n > 2 && value_at((corners[0].barycentric + corners[1].barycentric + corners[2].barycentric) / 3) >= 0;
  for (std::size_t i = 0; i < n; ++i) {
    const bool rises = (i % 2 == 0) != corners[0].above;
    // Counter-clockwise the stretch after a fall is below and ends with a rise; walked with the larger values on the
    // left, a piece comes from a fall and goes to a rise.
    if (!rises) next_[around[i]] = around[centre_above ? (i + 1) % n : (i + n - 1) % n];
  }
}

/// The crossings of an inner edge of a triangle of this depth. They are separated at all points that deeper triangles
/// could have as corners, so that the parity of crossings tells the sign of those.
FaceCutter::Side FaceCutter::find_crossings(const Corner& a, const Corner& b, int depth) {
  Side out;
  find_between(a, b, {0, 1}, {a.value, b.value}, depth, out);
  return out;
}

void FaceCutter::find_between(const Corner& a, const Corner& b, std::array<double, 2> t, std::array<double, 2> g,
                              int depth, Side& out) {
  const bool differ = (g[0] >= 0) != (g[1] >= 0);
  const double length = (t[1] - t[0]) * (plane(b.barycentric) - plane(a.barycentric)).norm();
  if (!differ && (depth >= deepest_ || std::abs(g[0]) + std::abs(g[1]) > max_slope_ * length)) return;
  if (depth >= deepest_) {
    const double root = bisect(a.barycentric, b.barycentric, t[0], g[0], t[1], g[1]);
    out.push_back({root, static_cast<Index>(nodes_.size())});
    nodes_.push_back(mix(a.barycentric, b.barycentric, root));
    next_.push_back(no_index);
    return;
  }
  const double middle = (t[0] + t[1]) / 2;
  const double g_middle = biased_at(mix(a.barycentric, b.barycentric, middle));
  // A level set that runs along the edge is above it by the bias.
  if (!differ && std::max({std::abs(g[0]), std::abs(g_middle), std::abs(g[1])}) <= value_tolerance_) return;
  find_between(a, b, {t[0], middle}, {g[0], g_middle}, depth + 1, out);
  find_between(a, b, {middle, t[1]}, {g_middle, g[1]}, depth + 1, out);
}

/// The parameter in [t0, t1] where the value is zero; the signs at the ends differ. Regula falsi in the Illinois
/// variant (Dowell & Jarratt 1971), with a bisection now and then for kinks.
double FaceCutter::bisect(const Vec3& a, const Vec3& b, double t0, double g0, double t1, double g1) const {
  if (std::abs(g0) <= value_tolerance_) return t0;
  if (std::abs(g1) <= value_tolerance_) return t1;
  const bool above0 = g0 >= 0;
  int side = 0;  // the end that the step before moved: an end that stays twice counts half
  for (int i = 0; i < 200; ++i) {
    double t = i % 4 == 3 ? (t0 + t1) / 2 : t0 + (t1 - t0) * (g0 / (g0 - g1));
    if (!(t > t0 && t < t1)) t = (t0 + t1) / 2;
    if (t <= t0 || t >= t1) break;
    const double g = value_at(mix(a, b, t));
    if (std::abs(g) <= value_tolerance_) return t;
    if ((g >= 0) == above0) {
      t0 = t;
      g0 = g;
      if (side == -1) g1 /= 2;
      side = -1;
    } else {
      t1 = t;
      g1 = g;
      if (side == 1) g0 /= 2;
      side = 1;
    }
  }
  return (t0 + t1) / 2;
}

}  // namespace isopath
