#include "isopath/contour/medial_axis.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "isopath/contour/face_bisectors.h"
#include "isopath/core/error.h"
#include "isopath/field/exact_field_data.h"

namespace isopath {
namespace {

/// Windows narrower than this, relative to the model, are cracks between others.
constexpr double narrowest_window = 1e-10;

/// Where two windows of an edge meet on a bisector.
struct EdgeTie {
  double x = 0;  // in the edge's canonical frame
  const Window* before = nullptr;
  const Window* after = nullptr;
};

/// Traces the bisectors of a field through all faces.
class BisectorTracer {
 public:
  BisectorTracer(const ExactFieldData& data, const BisectorRule& rule) : data_(data), rule_(rule) {}

  BisectorGraph run(Progress& progress) {
    const TriangleMesh& mesh = data_.mesh;
    find_edge_ties(progress);
    std::vector<FaceBisectors::Output> parts(mesh.n_faces());
    tbb::parallel_for(Index{0}, mesh.n_faces(), [&](Index face) {
      if (face % 32 == 0) progress.checkpoint();  // where sources crowd, a face may take a millisecond
      parts[face] = trace(face);
    });
    std::vector<BisectorPiece> pieces;
    Index n_points = static_cast<Index>(ties_.size()) + mesh.n_vertices();
    for (FaceBisectors::Output& part : parts) {
      for (BisectorPiece& piece : part.pieces) {
        for (Index* id : {&piece.from, &piece.to}) {
          if (*id < 0) *id = n_points + ~*id;
        }
        pieces.push_back(std::move(piece));
      }
      n_points += part.n_points;
    }
    return chain_bisectors(mesh, n_points, std::move(pieces), 1e-9 * rule_.size);
  }

 private:
  /// The windows of an edge that are more than cracks.
  void windows_of(Index edge, std::vector<const Window*>& windows) const {
    windows.clear();
    for (const Window& w : data_.windows.of(edge)) {
      if (w.end - w.begin > narrowest_window * rule_.size) windows.push_back(&w);
    }
    // where rounding left a crack between real fronts, a path along the edge fills it with a longer distance
    const double jump = 1e-9 * rule_.size;
    for (std::size_t k = windows.size(); k-- > 0;) {
      const Window& w = *windows[k];
      const bool above_left = k > 0 && w.distance(w.begin) > windows[k - 1]->distance(w.begin) + jump;
      const bool above_right = k + 1 < windows.size() && w.distance(w.end) > windows[k + 1]->distance(w.end) + jump;
      if (w.filler && (above_left || above_right)) windows.erase(windows.begin() + static_cast<std::ptrdiff_t>(k));
    }
  }

  void find_edge_ties(Progress& progress) {
    const Index n = data_.mesh.n_edges();
    first_tie_.assign(n + 1, 0);
    std::vector<const Window*> windows;
    for (Index edge = 0; edge < n; ++edge) {
      if (edge % 4096 == 0) progress.checkpoint();
      windows_of(edge, windows);
      const FaceFronts fronts(data_, TriangleMesh::face_of(data_.mesh.halfedge_of(edge)));
      for (std::size_t k = 1; k < windows.size(); ++k) add_if_tied(edge, fronts, *windows[k - 1], *windows[k]);
      first_tie_[edge + 1] = ties_.size();
    }
  }

  void add_if_tied(Index edge, const FaceFronts& fronts, const Window& before, const Window& after) {
    // windows that continue each other are the rule: they look the same where they meet
    const Vec2 u = before.direction(before.end);
    const Vec2 v = after.direction(before.end);
    if (rule_.by_root ? before.root == after.root : u.dot(v) > std::cos(0.99 * rule_.min_angle)) return;
    const Index h = data_.mesh.halfedge_of(edge);
    const Front a = fronts.of_window(h, before);
    const Front b = fronts.of_window(h, after);
    const double length = data_.geometry.length(h);
    const Vec2& tail = fronts.corner(h % 3);
    const Vec2 along = (fronts.corner((h % 3 + 1) % 3) - tail) / length;
    double x = std::clamp(before.end, 0.0, length);
    for (int k = 0; k < 4; ++k) {
      const Vec2 p = tail + x * along;
      const double slope = (a.direction(p) - b.direction(p)).dot(along);
      if (std::abs(slope) < 1e-6) break;
      const double better = x + (b.distance(p) - a.distance(p)) / slope;
      if (std::abs(better - before.end) > 1e-7 * rule_.size) break;
      x = std::clamp(better, 0.0, length);
    }
    const Vec2 p = tail + x * along;
    if (std::abs(a.distance(p) - b.distance(p)) > 1e-9 * rule_.size) return;
    if (rule_.separates(a, b, p) && rule_.may_meet(a, b, p, along)) ties_.push_back({x, &before, &after});
  }

  FaceBisectors::Output trace(Index face) const {
    std::array<std::vector<const Window*>, 3> windows;
    FaceBisectors bisectors(data_, face, rule_);
    const FaceFronts& fronts = bisectors.fronts();
    std::array<FaceBisectors::Side, 3> sides;
    for (int i = 0; i < 3; ++i) {
      const Index h = 3 * face + i;
      const Index edge = data_.mesh.edge_of(h);
      windows_of(edge, windows[i]);
      if (windows[i].empty()) return {};
      const bool canonical = data_.mesh.halfedge_of(edge) == h;
      if (!canonical) std::reverse(windows[i].begin(), windows[i].end());
      const Vec2 along = (fronts.corner((i + 1) % 3) - fronts.corner(i)) / data_.geometry.length(h);
      for (std::size_t id = first_tie_[edge]; id < first_tie_[edge + 1]; ++id) {
        const EdgeTie& tie = ties_[id];
        const double x = canonical ? tie.x : data_.geometry.length(h) - tie.x;
        Front before = fronts.of_window(h, *tie.before);
        Front after = fronts.of_window(h, *tie.after);
        if (!canonical) std::swap(before, after);
        sides[i].push_back({fronts.corner(i) + x * along, before, after, static_cast<Index>(id)});
      }
      if (!canonical) std::reverse(sides[i].begin(), sides[i].end());
    }
    for (int i = 0; i < 3; ++i) {
      const int next = (i + 1) % 3;
      const Vec2& corner = fronts.corner(next);
      const Front before = fronts.of_window(3 * face + i, *windows[i].back());
      const Front after = fronts.of_window(3 * face + next, *windows[next].front());
      const Vec2 across =
          (corner - fronts.corner(i)).normalized() + (fronts.corner((next + 1) % 3) - corner).normalized();
      if (std::abs(before.distance(corner) - after.distance(corner)) > 1e-9 * rule_.size) continue;
      if (!rule_.separates(before, after, corner) || !rule_.may_meet(before, after, corner, across)) continue;
      const Index id = static_cast<Index>(ties_.size()) + data_.mesh.triangle(face)[next];
      sides[i].push_back({corner, before, after, id});
    }
    return bisectors.run(sides);
  }

  const ExactFieldData& data_;
  BisectorRule rule_;
  std::vector<EdgeTie> ties_;
  std::vector<std::size_t> first_tie_;  // per edge
};

void check_chord_tolerance(double tolerance) {
  if (tolerance >= 0 && tolerance < infinity) return;
  throw Error(ErrorCode::bad_usage, "the chord tolerance of bisectors is not a length",
              {.element = "chord_tolerance",
               .value = fmt::format("{} mm", tolerance),
               .advice = "give 0 for 1e-4 of the model's size"});
}

BisectorRule rule_for(const ExactField& field, double chord_tolerance) {
  const double size = field.geometry().size();
  return {.size = size, .chord_tolerance = chord_tolerance > 0 ? chord_tolerance : 1e-4 * size};
}

}  // namespace

void VoronoiOptions::validate() const { check_chord_tolerance(chord_tolerance); }

void MedialAxisOptions::validate() const {
  check_chord_tolerance(chord_tolerance);
  if (!(min_angle > 0 && min_angle <= std::numbers::pi)) {
    throw Error(ErrorCode::bad_usage, "the least angle of a medial axis is out of range",
                {.element = "min_angle",
                 .value = fmt::format("{} rad", min_angle),
                 .advice = "allowed: above 0, up to half a turn"});
  }
  check_prune_ratio(prune);
}

BisectorGraph voronoi_diagram(const ExactField& field, const VoronoiOptions& options, Progress& progress) {
  options.validate();
  BisectorRule rule = rule_for(field, options.chord_tolerance);
  rule.by_root = true;
  return BisectorTracer(field.data(), rule).run(progress);
}

BisectorGraph medial_axis(const ExactField& field, const MedialAxisOptions& options, Progress& progress) {
  options.validate();
  BisectorRule rule = rule_for(field, options.chord_tolerance);
  rule.min_angle = options.min_angle;
  const BisectorGraph graph = BisectorTracer(field.data(), rule).run(progress);
  return options.prune > 0 ? pruned(field.mesh(), graph, options.prune) : graph;
}

}  // namespace isopath
