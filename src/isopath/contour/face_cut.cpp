#include "isopath/contour/face_cut.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "isopath/core/segment.h"

namespace isopath {

namespace {

// 2^-24 of a face is below the tolerance of any chord; it only stops what rounding could keep going.
constexpr int deepest_chord = 24;
// A level set that runs along an inner edge is searched at 2^14 points, which bounds the time it can take.
constexpr int deepest_division = 14;
// What thinning takes of the chord tolerance.
constexpr double thinning_over_chord = 0.25;

}  // namespace

FaceCutter::FaceCutter(const TriangleMesh& mesh, const SurfaceFunction& function, double chord_tolerance)
    : mesh_(mesh),
      function_(function),
      chord_tolerance_(chord_tolerance),
      max_slope_(function.max_slope()),
      value_tolerance_(1e-10 * mesh.size() * function.max_slope()),
      linear_(function.linear_in_faces()) {}

void FaceCutter::start(Index face) {
  face_ = face;
  monotone_ = linear_ || function_.monotone_in_face(face);
  if (linear_) return;
  const auto& [a, b, c] = mesh_.triangle(face);
  const Vec3 ab = mesh_.position(b) - mesh_.position(a);
  const Vec3 ac = mesh_.position(c) - mesh_.position(a);
  const double length = ab.norm();
  const double along = length > 0 ? ab.dot(ac) / length : 0;
  const double height = length > 0 ? ab.cross(ac).norm() / length : 0;
  plane_ = {Vec2(0, 0), Vec2(length, 0), Vec2(along, height)};
  // Which crossings of a face belong together is decided at the scale of the chord tolerance, no finer.
  const double longest = std::max({length, ac.norm(), (ac - ab).norm()});
  deepest_ = std::clamp(static_cast<int>(std::ceil(std::log2(std::max(16 * longest / chord_tolerance_, 1.0)))), 0,
                        deepest_division);
  to_barycentric_.setZero();
  if (height > 0) {
    to_barycentric_.row(1) = Vec2(1 / length, -along / (length * height));
    to_barycentric_.row(2) = Vec2(0, 1 / height);
    to_barycentric_.row(0) = -to_barycentric_.row(1) - to_barycentric_.row(2);
  }
}

Vec2 FaceCutter::plane(const Vec3& barycentric) const {
  return barycentric[0] * plane_[0] + barycentric[1] * plane_[1] + barycentric[2] * plane_[2];
}

double FaceCutter::value_at(const Vec3& barycentric) const {
  return function_.value({face_, barycentric}) - level_value_;
}

/// The value for signs on inner edges: pushed up by less than the tolerance but more than its rounding, so that an edge
/// on the level set is above it as a whole.
double FaceCutter::biased_at(const Vec3& barycentric) const { return value_at(barycentric) + 0.25 * value_tolerance_; }

FaceCutter::Corner FaceCutter::corner_at(const Vec3& barycentric, bool above) const {
  const double g = biased_at(barycentric);
  return {barycentric, above ? std::max(g, 0.0) : std::min(g, -std::numeric_limits<double>::min()), above};
}

std::pair<Index, Index> FaceCutter::levels_inside(std::span<const double> levels) const {
  if (monotone_) return {0, 0};
  const Vec3 centre = Vec3::Constant(1.0 / 3);
  double radius = 0;
  for (const Vec2& corner : plane_) radius = std::max(radius, (corner - plane(centre)).norm());
  const double value = function_.value({face_, centre});
  const auto first = std::lower_bound(levels.begin(), levels.end(), value - max_slope_ * radius);
  const auto last = std::upper_bound(first, levels.end(), value + max_slope_ * radius);
  return {static_cast<Index>(first - levels.begin()), static_cast<Index>(last - levels.begin())};
}

void FaceCutter::cut(Index level, double level_value, std::span<const Event> events, Output& out) {
  level_value_ = level_value;
  nodes_.clear();
  Sides sides;
  for (const Event& event : events) {
    sides[event.side].push_back({event.parameter, static_cast<Index>(nodes_.size())});
    nodes_.push_back(point_on_halfedge(3 * face_ + event.side, event.parameter).barycentric);
  }
  next_.assign(nodes_.size(), no_index);
  Corners corners;
  for (int i = 0; i < 3; ++i) {
    const double g = function_.value_at_vertex(mesh_.triangle(face_)[i]) - level_value;
    corners[i] = {Vec3::Unit(i), g, g >= 0};
  }
  divide(corners, sides, 0);

  std::vector<Vec3> chain;
  for (Index event = 0; event < static_cast<Index>(events.size()); ++event) {
    if (next_[event] == no_index) continue;
    chain.assign(1, nodes_[event]);
    Index node = event;
    do {
      node = std::exchange(next_[node], no_index);
      chain.push_back(nodes_[node]);
    } while (node >= static_cast<Index>(events.size()));
    emit(level, events[event].crossing, events[node].crossing, chain, out);
  }
  for (Index start = static_cast<Index>(events.size()); start < static_cast<Index>(nodes_.size()); ++start) {
    if (next_[start] == no_index) continue;
    chain.assign(1, nodes_[start]);
    for (Index node = std::exchange(next_[start], no_index); node != start;) {
      chain.push_back(nodes_[node]);
      node = std::exchange(next_[node], no_index);
    }
    chain.push_back(nodes_[start]);
    if (!monotone_) emit(level, no_index, no_index, chain, out);
  }
}

/// Leaves out inner nodes of a chain that lie between others up to a small part of the chord tolerance: dividing a face
/// finely, to tell what is connected, leaves many of them. Keeps what Ramer (1972) and Douglas & Peucker (1973) do.
void FaceCutter::thin(std::vector<Vec3>& chain) const {
  const double most = thinning_over_chord * chord_tolerance_;
  std::vector<char> keep(chain.size(), 0);
  keep.front() = keep.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> stretches{{0, chain.size() - 1}};
  while (!stretches.empty()) {
    const auto [first, last] = stretches.back();
    stretches.pop_back();
    const Vec2 start = plane(chain[first]);
    const Vec2 way = plane(chain[last]) - start;
    double farthest = most;
    std::size_t middle = first;
    for (std::size_t i = first + 1; i < last; ++i) {
      const Vec2 p = plane(chain[i]) - start;
      const double t = way.squaredNorm() > 0 ? std::clamp(p.dot(way) / way.squaredNorm(), 0.0, 1.0) : 0;
      const double distance = (p - t * way).norm();
      if (distance <= farthest) continue;
      farthest = distance;
      middle = i;
    }
    if (middle == first) continue;
    keep[middle] = 1;
    stretches.emplace_back(first, middle);
    stretches.emplace_back(middle, last);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    if (keep[i]) chain[kept++] = chain[i];
  }
  chain.resize(kept);
}

/// Appends one piece: inner nodes of the chain, and between them what the chord tolerance asks for.
void FaceCutter::emit(Index level, Index from, Index to, std::vector<Vec3>& chain, Output& out) const {
  if (chain.size() > 2) thin(chain);
  const auto first = out.points.size();
  if (from == no_index) out.points.push_back({face_, chain.front()});
  const double same = mesh_.tolerance().length;
  Vec3 last = chain.front();
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const bool is_last = i + 1 == chain.size();
    if (!is_last &&
        ((plane(chain[i]) - plane(last)).norm() <= same || (plane(chain[i]) - plane(chain.back())).norm() <= same)) {
      continue;
    }
    if (!linear_) refine(last, chain[i], 0, out.points);
    if (!is_last) out.points.push_back({face_, chain[i]});
    last = chain[i];
  }
  out.pieces.push_back(
      {face_, level, from, to, static_cast<Index>(first), static_cast<Index>(out.points.size() - first)});
}

/// Adds points between a and b until the chords keep to the level set. The level set from a to b has to cross every
/// line square to the chord between them, to the right of a point that is above and to the left of one below.
void FaceCutter::refine(const Vec3& a, const Vec3& b, int depth, std::vector<SurfacePoint>& points) const {
  const Vec2 along = plane(b) - plane(a);
  const double length = along.norm();
  if (depth >= deepest_chord || length <= chord_tolerance_ || max_slope_ <= 0) return;
  double worst = 0;
  Vec3 from;
  double g = 0;
  // A middle point alone would miss an S.
  for (const double t : {0.5, 0.25, 0.75}) {
    const Vec3 sample = mix(a, b, t);
    const double off = value_at(sample);
    if (std::abs(off) > worst * (1 + 1e-6)) {
      worst = std::abs(off);
      from = sample;
      g = off;
    }
  }
  if (worst <= 0.5 * chord_tolerance_ * max_slope_) return;
  const Vec2 right(along.y() / length, -along.x() / length);
  Vec3 found;
  if (!project(from, g, to_barycentric_ * (g > 0 ? right : Vec2(-right)), found)) return;
  refine(a, found, depth + 1, points);
  points.push_back({face_, found});
  refine(found, b, depth + 1, points);
}

/// Goes from a point off the level, in `direction` (barycentric, of unit length in the face), to the first point on it.
bool FaceCutter::project(const Vec3& from, double g, const Vec3& direction, Vec3& found) const {
  double limit = infinity;
  for (int i = 0; i < 3; ++i) {
    if (direction[i] < 0) limit = std::min(limit, from[i] / -direction[i]);
  }
  if (!(limit > 0) || limit == infinity) return false;
  const auto at = [&](double s) { return Vec3((from + s * direction).cwiseMax(0)); };
  const bool above = g > 0;
  double s = 0;
  double step = std::abs(g) / max_slope_;  // cannot jump over the level, and is exact for a distance
  for (int i = 0; i < 100; ++i) {
    const double ahead = std::min(s + step, limit);
    const double g_ahead = value_at(at(ahead));
    if (std::abs(g_ahead) <= value_tolerance_) {
      found = at(ahead);
      return true;
    }
    if ((g_ahead > 0) != above) {
      found = mix(at(s), at(ahead), bisect(at(s), at(ahead), 0, g, 1, g_ahead));
      return std::abs(value_at(found)) <= 10 * value_tolerance_;
    }
    if (ahead == limit) return false;
    s = ahead;
    g = g_ahead;
    step = 2 * std::abs(g) / max_slope_;
  }
  return false;
}

}  // namespace isopath
