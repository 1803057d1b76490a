#include "isopath/impact/min_radius.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

/// The band is drawn to a radius this much larger than asked for: its points stand for arcs.
constexpr double drawn_over_asked = 1.04;
/// Steps between the points of the band, as parts of the radius: coarse first, as tightening spreads from point to
/// point.
constexpr double steps_over_radius[] = {0.4, 0.2, 0.2, 0.14};
constexpr int most_sweeps = 150;
/// An arc of this sag turns by 13 degrees from chord to chord.
constexpr double chord_tolerance_over_radius = 0.006;
/// Places within this of the radius asked for are taken as good.
constexpr double radius_tolerance = 0.02;
/// Near the ends of a stretch radii are measured over less than the window, down to this share of it.
constexpr double least_arm = 0.3;
/// What does not come round is tried with so many times longer legs.
constexpr int most_tries = 3;

struct Node {
  SurfacePoint at;
  Vec3 position = Vec3::Zero();
  MoveKind kind = MoveKind::cover;  ///< of the move that arrives
};

SurfacePoint on_chord(const TriangleMesh& mesh, const SurfacePoint& a, const SurfacePoint& b, double t) {
  const Index face = common_face(mesh, a, b);
  if (face == no_index) return t < 0.5 ? a : b;
  return {face, (1 - t) * express_in(mesh, a, face).barycentric + t * express_in(mesh, b, face).barycentric};
}

/// A stretch of a curve on the surface with arc length as parameter.
class WalkedStretch {
 public:
  WalkedStretch(const TriangleMesh& mesh, std::vector<Node> nodes) : mesh_(mesh), nodes_(std::move(nodes)) {
    arc_.push_back(0);
    for (std::size_t i = 1; i < nodes_.size(); ++i)
      arc_.push_back(arc_.back() + (nodes_[i].position - nodes_[i - 1].position).norm());
  }

  std::size_t size() const { return nodes_.size(); }
  double length() const { return arc_.back(); }
  double arc(std::size_t i) const { return arc_[i]; }
  const Node& node(std::size_t i) const { return nodes_[i]; }
  /// The first node behind an arc.
  std::size_t behind(double arc) const {
    const auto above = std::upper_bound(arc_.begin(), arc_.end(), arc);
    return std::min(static_cast<std::size_t>(above - arc_.begin()), arc_.size() - 1);
  }

  Node at(double arc) const {
    const std::size_t i = std::max<std::size_t>(behind(arc), 1);
    const double step = arc_[i] - arc_[i - 1];
    const double t = step > 0 ? std::clamp((arc - arc_[i - 1]) / step, 0.0, 1.0) : 1;
    if (t == 1) return nodes_[i];
    if (t == 0) return {nodes_[i - 1].at, nodes_[i - 1].position, nodes_[i].kind};
    const SurfacePoint point = on_chord(mesh_, nodes_[i - 1].at, nodes_[i].at, t);
    return {point, position_of(mesh_, point), nodes_[i].kind};
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<Node> nodes_;
  std::vector<double> arc_;
};

/// A vector in the tangent plane, of the length it has in space: so a straight way over an edge stays straight.
Vec3 laid_flat(const Vec3& v, const Vec3& normal) {
  const Vec3 flat = v - normal.dot(v) * normal;
  const double length = flat.norm();
  return length > 1e-9 * v.norm() ? Vec3(v.norm() / length * flat) : Vec3(Vec3::Zero());
}

/// Turn of the way from a over b to c in the tangent plane, and the mean length of its two parts.
struct Turn {
  Vec3 before = Vec3::Zero();
  Vec3 behind = Vec3::Zero();
  double angle = 0;
  double step = 0;
  double radius() const { return angle > 0 ? step / (2 * std::sin(0.5 * angle)) : infinity; }
};

Turn turn_at(const TriangleMesh& mesh, const Node& a, const Node& b, const Node& c) {
  const Vec3 sum = mesh.face_normal(a.at.face) + mesh.face_normal(b.at.face) + mesh.face_normal(c.at.face);
  const Vec3 normal = sum.norm() > 1e-6 ? Vec3(sum.normalized()) : mesh.face_normal(b.at.face);
  Turn turn;
  turn.before = laid_flat(b.position - a.position, normal);
  turn.behind = laid_flat(c.position - b.position, normal);
  turn.step = 0.5 * (turn.before.norm() + turn.behind.norm());
  turn.angle = std::atan2(turn.before.cross(turn.behind).norm(), turn.before.dot(turn.behind));
  return turn;
}

/// An interval of arc that turns too tightly, and its worst place.
struct Tight {
  double from = 0;
  double to = 0;
  TightPlace worst;
};

std::vector<Tight> tight_intervals(const TriangleMesh& mesh, const WalkedStretch& stretch, double from, double to,
                                   double radius, const Progress& progress) {
  std::vector<Tight> found;
  const double window = radius_window * radius;
  for (std::size_t i = stretch.behind(from); i < stretch.size() && stretch.arc(i) <= to; ++i) {
    if (i % 4096 == 0) progress.checkpoint();
    const double s = stretch.arc(i);
    const double arm = std::min({window, s, stretch.length() - s});
    if (arm < least_arm * window) continue;
    const double here = turn_at(mesh, stretch.at(s - arm), stretch.node(i), stretch.at(s + arm)).radius();
    if (here >= (1 - radius_tolerance) * radius) continue;
    if (found.empty() || s - found.back().to > window) found.push_back({s, s, {stretch.node(i).position, here}});
    found.back().to = s;
    if (here < found.back().worst.radius) found.back().worst = {stretch.node(i).position, here};
  }
  return found;
}

class BandTightener {
 public:
  BandTightener(const SurfaceLinker& linker, double radius, const Progress& progress)
      : linker_(linker), mesh_(linker.mesh()), radius_(radius), progress_(progress) {}

  /// The stretch between two arcs, drawn tight; its ends, and the directions there, stay.
  std::vector<Node> tightened(const WalkedStretch& stretch, double from, double to) const {
    std::vector<Node> nodes = cut_out(stretch, from, to);
    for (const double step : steps_over_radius) {
      std::vector<Node> band = sampled(WalkedStretch(mesh_, std::move(nodes)), step * radius_);
      sweep(band);
      nodes = joined(band);
    }
    return thinned(nodes);
  }

 private:
  static std::vector<Node> cut_out(const WalkedStretch& stretch, double from, double to) {
    std::vector<Node> nodes = {stretch.at(from)};
    for (std::size_t i = stretch.behind(from); i < stretch.size() && stretch.arc(i) < to; ++i)
      nodes.push_back(stretch.node(i));
    nodes.push_back(stretch.at(to));
    return nodes;
  }

  static std::vector<Node> sampled(const WalkedStretch& part, double step) {
    const int n = std::max(6, static_cast<int>(std::ceil(part.length() / step)));
    std::vector<Node> band;
    for (int i = 0; i <= n; ++i) band.push_back(part.at(part.length() * i / n));
    return band;
  }

  /// Each point goes towards the middle of its neighbours as far as the turn it has is too large, again and again,
  /// back and forth.
  void sweep(std::vector<Node>& band) const {
    const auto n = static_cast<int>(band.size());
    for (int k = 0; k < most_sweeps; ++k) {
      progress_.checkpoint();
      double worst = 0;
      for (int j = 2; j + 2 < n; ++j) {
        const int i = k % 2 == 0 ? j : n - 1 - j;
        worst = std::max(worst, tighten(band[i - 1], band[i], band[i + 1]));
      }
      if (worst <= 1.005) break;
    }
  }

  /// Returns by how much the turn was too large.
  double tighten(const Node& before, Node& node, const Node& behind) const {
    const Turn turn = turn_at(mesh_, before, node, behind);
    const double allowed = 2 * std::asin(std::min(1.0, turn.step / (2 * drawn_over_asked * radius_)));
    if (turn.angle <= allowed) return 1;
    const Vec3 to_middle = 0.5 * (turn.behind - turn.before);
    const double share = std::sin(0.5 * allowed) / std::sin(0.5 * turn.angle);
    const Vec3 goal = node.position + (1 - share) * to_middle;
    const NearestPoint there = linker_.locator().nearest(goal, turn.step + mesh_.tolerance().length);
    // not to the other side of a thin wall
    if (there.at.valid() && mesh_.face_normal(there.at.face).dot(mesh_.face_normal(node.at.face)) > 0) {
      node.at = there.at;
      node.position = position_of(mesh_, there.at);
    }
    return turn.angle / allowed;
  }

  std::vector<Node> joined(const std::vector<Node>& band) const {
    std::vector<Node> nodes = {band.front()};
    for (std::size_t i = 1; i < band.size(); ++i) {
      SurfaceCurve way;
      way.add(mesh_, nodes.back().at);
      linker_.extend(way, band[i].at);
      for (std::size_t k = 1; k < way.size(); ++k) nodes.push_back({way.points[k], way.positions[k], band[i].kind});
    }
    return nodes;
  }

  /// Without the points that legs and arcs do not need: each that is left out lies within the tolerance of the chord
  /// in its face.
  std::vector<Node> thinned(const std::vector<Node>& nodes) const {
    std::vector<Node> kept = {nodes.front()};
    for (std::size_t i = 0; i + 1 < nodes.size();) {
      std::size_t next = i + 1;
      while (next + 1 < nodes.size() && may_skip(nodes, i, next + 1)) ++next;
      kept.push_back(nodes[next]);
      i = next;
    }
    return kept;
  }

  bool may_skip(const std::vector<Node>& nodes, std::size_t from, std::size_t to) const {
    const Vec3& a = nodes[from].position;
    const Vec3 chord = nodes[to].position - a;
    if (nodes[to].kind != nodes[from + 1].kind || common_face(mesh_, nodes[from].at, nodes[to].at) == no_index)
      return false;
    for (std::size_t i = from + 1; i < to; ++i) {
      const Vec3 way = nodes[i].position - a;
      const double t = chord.squaredNorm() > 0 ? std::clamp(way.dot(chord) / chord.squaredNorm(), 0.0, 1.0) : 0;
      if ((way - t * chord).norm() > chord_tolerance_over_radius * radius_) return false;
    }
    return true;
  }

  const SurfaceLinker& linker_;
  const TriangleMesh& mesh_;
  double radius_;
  const Progress& progress_;
};

/// Tight intervals with legs on both sides to draw on, those that meet made one.
std::vector<Tight> with_legs(std::vector<Tight> tight, double legs, double length) {
  std::vector<Tight> merged;
  for (Tight& t : tight) {
    t.from = std::max(0.0, t.from - legs);
    t.to = std::min(length, t.to + legs);
    if (!merged.empty() && t.from <= merged.back().to) {
      merged.back().to = std::max(merged.back().to, t.to);
    } else {
      merged.push_back(t);
    }
  }
  return merged;
}

/// The nodes of a stretch with every tight interval drawn round.
std::vector<Node> rounded(const SurfaceLinker& linker, std::vector<Node> nodes, double radius, double legs,
                          const Progress& progress) {
  const TriangleMesh& mesh = linker.mesh();
  const WalkedStretch stretch(mesh, std::move(nodes));
  const BandTightener tightener(linker, radius, progress);
  std::vector<Node> whole;
  std::size_t next = 0;
  for (const Tight& tight :
       with_legs(tight_intervals(mesh, stretch, 0, infinity, radius, progress), legs * radius, stretch.length())) {
    for (; next < stretch.size() && stretch.arc(next) < tight.from; ++next) whole.push_back(stretch.node(next));
    const std::vector<Node> band = tightener.tightened(stretch, tight.from, tight.to);
    whole.insert(whole.end(), band.begin(), band.end());
    while (next < stretch.size() && stretch.arc(next) <= tight.to) ++next;
  }
  for (; next < stretch.size(); ++next) whole.push_back(stretch.node(next));
  return whole;
}

/// Maximal runs of points on the surface: from the first index to before the second.
std::vector<std::pair<std::size_t, std::size_t>> runs_on_surface(const ImpactCurve& curve) {
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  for (std::size_t i = 0; i < curve.points.size();) {
    if (!curve.points[i].at.valid()) {
      ++i;
      continue;
    }
    std::size_t end = i + 1;
    while (end < curve.points.size() && curve.points[end].kind != MoveKind::lift) ++end;
    runs.emplace_back(i, end);
    i = end;
  }
  return runs;
}

std::vector<Node> nodes_of(const ImpactCurve& curve, std::size_t first, std::size_t end) {
  std::vector<Node> nodes;
  for (std::size_t i = first; i < end; ++i) {
    const ImpactPoint& p = curve.points[i];
    // the turn at a point that comes twice is that between its neighbours
    if (!nodes.empty() && p.position == nodes.back().position && i + 1 < end) continue;
    nodes.push_back({p.at, p.position, p.kind});
  }
  return nodes;
}

void validate_radius(double radius) {
  if (radius > 0 && std::isfinite(radius)) return;
  throw Error(ErrorCode::bad_usage, "must be a positive length in mm",
              {.element = "min radius", .value = fmt::format("{}", radius)});
}

}  // namespace

std::vector<TightPlace> tight_places(const TriangleMesh& mesh, const ImpactCurve& curve, double radius,
                                     const Progress& progress) {
  validate_radius(radius);
  std::vector<TightPlace> places;
  for (const auto& [first, end] : runs_on_surface(curve)) {
    const WalkedStretch stretch(mesh, nodes_of(curve, first, end));
    for (const Tight& tight : tight_intervals(mesh, stretch, 0, infinity, radius, progress))
      places.push_back(tight.worst);
  }
  return places;
}

std::vector<TightPlace> keep_min_radius(const SurfaceLinker& linker, const SmoothNormals& normals, ImpactCurve& curve,
                                        double radius, const Progress& progress) {
  validate_radius(radius);
  ImpactCurve whole;
  std::size_t next = 0;
  for (const auto& [first, end] : runs_on_surface(curve)) {
    whole.points.insert(whole.points.end(), curve.points.begin() + next, curve.points.begin() + first);
    next = end;
    const ImpactPoint start = curve.points[first];
    std::vector<Node> nodes = nodes_of(curve, first, end);
    for (int legs = 3, k = 0; k < most_tries; ++k, legs *= 2)
      nodes = rounded(linker, std::move(nodes), radius, legs, progress);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (i == 0) {
        whole.points.push_back(start);
      } else if (nodes[i].position != nodes[i - 1].position || i + 1 == nodes.size()) {
        whole.points.push_back({nodes[i].kind, nodes[i].at, nodes[i].position, normals.at(nodes[i].at), start.piece});
      }
    }
  }
  whole.points.insert(whole.points.end(), curve.points.begin() + next, curve.points.end());
  curve = std::move(whole);
  return tight_places(linker.mesh(), curve, radius, progress);
}

}  // namespace isopath
