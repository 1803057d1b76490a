#include "isopath/contour/blend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

#include "isopath/contour/paper_blend.h"
#include "isopath/contour/spokes.h"
#include "isopath/core/error.h"
#include "isopath/field/smooth_field.h"
#include "isopath/field/surface_laplacian.h"

namespace isopath {
namespace {

using Entry = std::pair<double, Index>;  // value and vertex; the highest first
using HighestFirst = std::priority_queue<Entry>;

template <class Visit>
void for_neighbours(const TriangleMesh& mesh, Index vertex, const Visit& visit) {
  Index last = no_index;
  for (Index h = mesh.outgoing(vertex); h != no_index;) {
    visit(mesh.to(h), mesh.edge_length(mesh.edge_of(h)));
    last = h;
    h = mesh.next_outgoing(h);
    if (h == mesh.outgoing(vertex)) return;
  }
  if (last != no_index) {
    const Index side = TriangleMesh::prev(last);
    visit(mesh.from(side), mesh.edge_length(mesh.edge_of(side)));
  }
}

/// How high one can stay on the way from the root to each vertex, and by which vertex the way comes there.
struct Flood {
  std::vector<double> level;
  std::vector<Index> from;
  std::vector<Index> lowest;  ///< vertex of the way that has the least value
};

Flood flood_from(const TriangleMesh& mesh, const std::vector<Index>& roots, const std::vector<double>& values) {
  Flood flood{std::vector<double>(values.size(), -infinity), std::vector<Index>(values.size(), no_index),
              std::vector<Index>(values.size(), no_index)};
  HighestFirst open;
  for (const Index root : roots) {
    if (root == no_index) continue;
    flood.level[root] = values[root];
    flood.lowest[root] = root;
    open.emplace(values[root], root);
  }
  std::vector<char> done(values.size(), 0);
  while (!open.empty()) {
    const Index v = open.top().second;
    open.pop();
    if (done[v]) continue;
    done[v] = 1;
    for_neighbours(mesh, v, [&](Index to, double) {
      if (flood.lowest[to] != no_index || !(values[to] < infinity)) return;
      flood.level[to] = std::min(values[to], flood.level[v]);
      flood.lowest[to] = values[to] < flood.level[v] ? to : flood.lowest[v];
      flood.from[to] = v;
      open.emplace(values[to], to);  // inside a top, its summit first
    });
  }
  return flood;
}

/// The largest of `value[q] - fall × distance(q, v)` over all q, by ways along edges.
void spread_down(const TriangleMesh& mesh, double fall, std::vector<double>& value, const Progress& progress) {
  HighestFirst open;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (value[v] > -infinity) open.emplace(value[v], v);
  }
  for (std::size_t n = 0; !open.empty(); ++n) {
    if (n % 4096 == 0) progress.checkpoint();
    const double height = open.top().first;
    const Index v = open.top().second;
    open.pop();
    if (height < value[v]) continue;
    for_neighbours(mesh, v, [&](Index to, double length) {
      if (height - fall * length > value[to]) {
        value[to] = height - fall * length;
        open.emplace(value[to], to);
      }
    });
  }
}

class LeastBlend {
 public:
  LeastBlend(const ExactField& field, const BlendOptions& options, const Progress& progress)
      : field_(field),
        mesh_(field.mesh()),
        distance_(field.vertex_distances()),
        spacing_(options.spacing),
        radius_(options.radius),
        progress_(progress) {}

  BlendedField run() {
    spokes_ = spokes(field_, tolerance_in_spacings * spacing_, progress_);
    find_roots();
    choose_levels();
    find_axis();
    raise_axis();
    BlendedField result;
    result.values.assign(distance_.begin(), distance_.end());
    const std::vector<double> raise = raises();
    for (Index v = 0; v < mesh_.n_vertices(); ++v) {
      if (spokes_[v].end.valid()) result.values[v] += raise[v];
    }
    leave_one_top(mesh_, all_roots(), result.values);
    result.spacing = spacing_;
    result.n_levels = n_levels_;
    result.root = top_root_;
    result.root_of_component = roots_;
    return result;
  }

 private:
  /// Spokes may overshoot the axis by so much.
  static constexpr double tolerance_in_spacings = 0.005;
  /// Levels may be farther apart by this share where that saves some.
  static constexpr double spare = 0.005;
  /// The widest gap along the axis, in spacings, and how far the function is raised for it at most: a little less than
  /// to the next level, so that none flickers where the axis is level.
  static constexpr double axis_gap = 1.03;
  static constexpr double highest_pull = 0.485;
  static constexpr double most_for_needles = 0.12;
  static constexpr double most_pull = highest_pull + most_for_needles;
  /// How steeply what is raised falls off along the axis: steeper than the distance itself, or a single pull would
  /// reach as far as that rises.
  static constexpr double axis_fall = 1.5;
  /// An island that is farther than this from the rest, in spacings, stays one: to raise the way takes two passes over
  /// it for every level, to join a ring by a joint costs less than two spacings.
  static constexpr double longest_way = 2;
  /// How far what is raised beyond pulls is smoothed, and how much lower that may leave it in either round.
  static constexpr double smoothing_in_spacings = 0.25;
  static constexpr double most_smoothed_off[] = {0.2, 0.1};

  /// The vertex farthest from the sources; of several as far, the one nearest to their middle.
  void find_roots() {
    roots_.assign(mesh_.n_components(), no_index);
    std::vector<double> longest(mesh_.n_components(), 0.0);
    for (Index f = 0; f < mesh_.n_faces(); ++f) {
      for (const Index v : mesh_.triangle(f)) {
        if (spokes_[v].end.valid())
          longest[mesh_.component_of(f)] = std::max(longest[mesh_.component_of(f)], spokes_[v].length);
      }
    }
    std::vector<Vec3> sum(mesh_.n_components(), Vec3::Zero());
    std::vector<double> count(mesh_.n_components(), 0.0);
    const auto is_top = [&](Index c, Index v) {
      return spokes_[v].end.valid() && distance_[v] >= longest[c] - 0.05 * spacing_;
    };
    const auto for_tops = [&](const auto& visit) {
      for (Index f = 0; f < mesh_.n_faces(); ++f) {
        const Index c = mesh_.component_of(f);
        for (const Index v : mesh_.triangle(f)) {
          if (is_top(c, v)) visit(c, v);
        }
      }
    };
    for_tops([&](Index c, Index v) {
      sum[c] += mesh_.position(v);
      ++count[c];
    });
    for (Index f = 0; f < mesh_.n_faces(); ++f) {  // where no vertex lies near the top
      const Index c = mesh_.component_of(f);
      if (count[c] > 0) continue;
      for (const Index v : mesh_.triangle(f)) {
        if (distance_[v] < infinity && (roots_[c] == no_index || distance_[v] > distance_[roots_[c]])) roots_[c] = v;
      }
    }
    for_tops([&](Index c, Index v) {
      const Vec3 middle = sum[c] / count[c];
      const auto off = [&](Index u) { return (mesh_.position(u) - middle).squaredNorm(); };
      if (roots_[c] == no_index || off(v) < off(roots_[c])) roots_[c] = v;
    });
    height_ = 0;
    for (std::size_t c = 0; c < longest.size(); ++c) {
      if (longest[c] > height_) {
        height_ = longest[c];
        top_root_ = roots_[c];
      }
    }
    if (!(height_ > 0)) throw Error(ErrorCode::no_plan, "the source reaches nothing that could be blended");
  }

  /// A little less than the spacing may make fewer levels, where long parts of the axis are just too high for the last
  /// one: what levels cost is the area over their spacing, and by how much the last one next to the axis is nearer than
  /// a spacing, times the axis' length.
  void choose_levels() {
    std::vector<double> area(mesh_.n_vertices(), 0.0);
    double whole = 0;
    for (Index f = 0; f < mesh_.n_faces(); ++f) {
      for (const Index v : mesh_.triangle(f)) {
        area[v] += mesh_.face_area(f) / 3;
        whole += spokes_[v].end.valid() ? mesh_.face_area(f) / 3 : 0;
      }
    }
    double least = infinity;
    double best = spacing_;
    for (double spacing = (1 + spare) * spacing_; spacing > 0.8 * spacing_; spacing -= 0.0025 * spacing_) {
      double cost = whole / spacing;
      for (Index v = 0; v < mesh_.n_vertices(); ++v) {
        if (!spokes_[v].end.valid() || spokes_[v].length - distance_[v] > spacing) continue;
        const double levels = spokes_[v].length / spacing;
        const double level = std::max(0.0, 1 - 2 * spokes_[v].axis_slope);  // elsewhere tips lie at all places
        cost += level * area[v] / spacing * (std::floor(levels + 0.5 + highest_pull) - levels);
      }
      if (cost < least) {
        least = cost;
        best = spacing;
      }
    }
    spacing_ = best;
    n_levels_ = std::max(1, static_cast<int>(std::ceil(height_ / spacing_ + highest_pull - 0.5)));
  }

  /// The vertices next to the axis, and what the function is to be there.
  void find_axis() {
    crest_.assign(mesh_.n_vertices(), -infinity);
    axis_.assign(mesh_.n_vertices(), -infinity);
    for (Index v = 0; v < mesh_.n_vertices(); ++v) {
      const Spoke& spoke = spokes_[v];
      if (!spoke.end.valid() || own_pull(v) == 0) continue;  // where fronts hardly differ, spokes end anywhere
      double longest = 0;
      for_neighbours(mesh_, v, [&](Index, double length) { longest = std::max(longest, length); });
      if (spoke.length - distance_[v] > 3 * longest) continue;
      crest_[v] = spoke.length + own_pull(v);
      axis_[v] = crest_[v] - axis_fall * (spoke.length - distance_[v]);
    }
  }

  /// The next level is to cross the axis half a gap farther along it than where the gap to the level before, or to the
  /// boundary's corner, is as wide as allowed, and by what rounding takes off the tip besides: the distance has grown
  /// only by the axis' slope there.
  double own_pull(Index v) const {
    const double slope = spokes_[v].axis_slope;
    // needles lose most; along a slope, a pull of more than half a level lets none flicker
    const double highest = highest_pull + std::min(1.5 * slope, most_for_needles);
    double pull = 0;
    for (int round = 0; round < 3; ++round)
      pull = std::clamp(0.5 - slope * (0.5 * axis_gap - rounded_off(spokes_[v], pull)), 0.0, highest);
    return spacing_ * pull;
  }

  /// What rounding takes off a tip that is pulled by so much, in spacings. The axis leaves the fronts by the angle
  /// whose sine is its slope; the pull ends in half a gap, or at the boundary, so that levels turn towards the tip.
  double rounded_off(const Spoke& spoke, double pull) const {
    const double between = std::asin(std::clamp(spoke.axis_slope, 0.01, 1.0));
    const double steepness = pull / std::clamp(spoke.length / spacing_, 0.2, 0.5 * axis_gap);
    const double turned = std::atan(steepness / (1 + steepness) * std::tan(std::min(between, 1.5)));
    return radius_ / spacing_ * (1 / std::sin(std::max(between - turned, 0.01)) - 1);
  }

  /// Those of the components and of the islands that stay.
  std::vector<Index> all_roots() const {
    std::vector<Index> all = roots_;
    all.insert(all.end(), islands_.begin(), islands_.end());
    return all;
  }

  /// Raises the axis where it falls on a short way to a root, island by island, and spreads what is raised.
  void raise_axis() {
    const double noise = 0.1 * spacing_;
    for (int round = 0; round < 50; ++round) {
      wanted_ = axis_;
      spread_down(mesh_, axis_fall, wanted_, progress_);
      std::vector<double> height(wanted_.size());
      for (Index v = 0; v < mesh_.n_vertices(); ++v)
        height[v] = crest_[v] > -infinity ? std::max({crest_[v], wanted_[v], distance_[v]}) : distance_[v];
      const Flood flood = flood_from(mesh_, all_roots(), height);
      std::vector<Index> top(height.size(), no_index);  // of each island, at the lowest vertex of the way there
      for (Index v = 0; v < mesh_.n_vertices(); ++v) {
        if (flood.lowest[v] == no_index || height[v] - flood.level[v] <= noise) continue;
        Index& best = top[flood.lowest[v]];
        if (best == no_index || height[v] > height[best]) best = v;
      }
      bool changed = false;
      for (const Index summit : top) {
        if (summit != no_index) changed = join_island(flood, height, summit) || changed;
      }
      if (!changed) return;
    }
  }

  /// True where the island is another round's concern: it has become a root, or its way was raised.
  bool join_island(const Flood& flood, const std::vector<double>& height, Index summit) {
    // only a level in between makes an island; the way lies midway to the next one, so that none runs along it
    const double levels = std::round(height[summit] / spacing_);
    if (flood.level[summit] >= (levels - 0.5) * spacing_) return false;
    const double level = std::min(height[summit], levels * spacing_);
    std::vector<Index> way;  // what lies lower
    double length = 0;
    for (Index v = summit; v != no_index; v = flood.from[v]) {
      if (height[v] < level) {
        way.push_back(v);
        if (flood.from[v] != no_index) length += (mesh_.position(v) - mesh_.position(flood.from[v])).norm();
      } else if (!way.empty() && flood.level[v] >= level) {
        break;
      }
    }
    if (length > longest_way * spacing_) {
      islands_.push_back(summit);
      return true;
    }
    bool raised = false;
    for (const Index v : way) {
      raised = raised || axis_[v] < level;
      axis_[v] = std::max(axis_[v], level);
      // a way of single vertices zigzags about the axis
      for_neighbours(mesh_, v, [&](Index to, double) {
        if (crest_[to] > -infinity) axis_[to] = std::max(axis_[to], level);
      });
    }
    return raised;
  }

  /// Pulls are what they are, and what is raised besides is smoothed: neighbouring spokes may end at different
  /// branches of the axis, and levels would have kinks where they do.
  std::vector<double> raises() const {
    std::vector<double> pull(mesh_.n_vertices(), 0.0);
    std::vector<double> more(mesh_.n_vertices(), 0.0);
    std::vector<double> free(mesh_.n_vertices(), 1.0);
    for (Index v = 0; v < mesh_.n_vertices(); ++v) {
      if (mesh_.is_boundary_vertex(v) || distance_[v] == 0) free[v] = 0;
      if (!spokes_[v].end.valid()) continue;
      pull[v] = handed_down(v, own_pull(v));
      more[v] = std::max(0.0, raise_at(v) - pull[v]);
    }
    const SurfaceLaplacian laplacian = surface_laplacian(mesh_, progress_);
    const DiffusionOptions options{
        .width = smoothing_in_spacings * spacing_, .steps = 2, .local = free, .conserve_volume = false};
    for (const double most : most_smoothed_off) {
      const std::vector<double> smooth = diffused(laplacian, more, options, progress_);
      // ways may not fall below the level they lead over, which is half a spacing lower
      for (Index v = 0; v < mesh_.n_vertices(); ++v) more[v] = std::max(smooth[v], more[v] - most * spacing_);
    }
    for (Index v = 0; v < mesh_.n_vertices(); ++v) pull[v] += more[v];
    return pull;
  }

  double raise_at(Index v) const {
    const Spoke& spoke = spokes_[v];
    const Triangle& corners = mesh_.triangle(spoke.end.face);
    double wanted = 0;
    for (int i = 0; i < 3; ++i) {
      // corners beside the axis stand for their own spokes' ends on it
      wanted += spoke.end.barycentric[i] * std::max(wanted_[corners[i]], crest_[corners[i]]);
    }
    const double raise = std::max(0.0, wanted - spoke.length);
    // a pull at a spoke that ends anywhere is meant for a branch nearby
    if (raise <= most_pull * spacing_ && own_pull(v) == 0) return 0;
    return handed_down(v, raise);
  }

  /// A pull ends half a spacing from the axis, so that it moves no level there; what is raised by more is spread wide.
  double handed_down(Index v, double raise) const {
    const Spoke& spoke = spokes_[v];
    const double band = std::min(spoke.length, pull_width() + 3 * std::max(0.0, raise - most_pull * spacing_));
    // level at the rim of the band, where a kink would show on triangles, and even from there to the axis
    constexpr double rim = 0.3;
    const double t = std::max(0.0, 1 - (spoke.length - distance_[v]) / band);
    return raise * (t < rim ? t * t / rim : 2 * t - rim) / (2 - rim);
  }
  double pull_width() const { return 0.55 * axis_gap * spacing_; }

  const ExactField& field_;
  const TriangleMesh& mesh_;
  std::span<const double> distance_;
  double spacing_;
  double radius_;
  const Progress& progress_;
  std::vector<Spoke> spokes_;
  std::vector<Index> roots_;
  std::vector<Index> islands_;  // their tops
  Index top_root_ = no_index;
  double height_ = 0;
  int n_levels_ = 0;
  std::vector<double> crest_;   // wanted at the ends of spokes through vertices next to the axis, else minus infinity
  std::vector<double> axis_;    // wanted at these vertices themselves
  std::vector<double> wanted_;  // the same, spread over all vertices
};

void check_boundary(const ExactField& field) {
  const TriangleMesh& mesh = field.mesh();
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (!mesh.is_boundary_vertex(v) || field.vertex_distances()[v] <= 1e-6 * mesh.size()) continue;
    throw Error(ErrorCode::no_plan, "blending needs the whole boundary as source",
                {.element = fmt::format("boundary vertex {}", v),
                 .value = fmt::format("distance {:.6g} mm", field.vertex_distances()[v]),
                 .advice = "give --source boundary, or plan without --blend"});
  }
}

}  // namespace

void BlendOptions::validate() const {
  if (!(spacing > 0 && std::isfinite(spacing))) {
    throw Error(ErrorCode::bad_usage, "must be a positive length in mm",
                {.element = "option spacing", .value = fmt::format("{}", spacing)});
  }
  if (!(radius >= 0 && std::isfinite(radius))) {
    throw Error(ErrorCode::bad_usage, "must be a length in mm, or 0 for sharp corners",
                {.element = "option radius", .value = fmt::format("{}", radius)});
  }
}

void leave_one_top(const TriangleMesh& mesh, const std::vector<Index>& root_of_component, std::vector<double>& values) {
  const Flood tops = flood_from(mesh, root_of_component, values);
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (tops.lowest[v] != no_index) values[v] = tops.level[v];
  }
  // hollows are the tops of what is left when seen from below
  std::vector<double> below(values.size());
  std::vector<Index> floor;
  for (std::size_t v = 0; v < values.size(); ++v) {
    below[v] = values[v] < infinity ? -values[v] : infinity;
    if (values[v] == 0) floor.push_back(static_cast<Index>(v));
  }
  const Flood hollows = flood_from(mesh, floor, below);
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (hollows.lowest[v] != no_index) values[v] = -hollows.level[v];
  }
}

BlendedField blend(const ExactField& field, const BlendOptions& options, const Progress& progress) {
  options.validate();
  check_boundary(field);
  if (options.form == BlendForm::paper) {
    BlendedField result = paper_blend(field.mesh(), options.spacing, progress);
    leave_one_top(field.mesh(), result.root_of_component, result.values);
    return result;
  }
  return LeastBlend(field, options, progress).run();
}

int levels_to_keep(const TriangleMesh& mesh, std::span<const double> values, double spacing) {
  constexpr double slack_share = 1e-3;
  std::vector<std::pair<double, double>> widths;  // of the way over the whole range at a face's slope, and its area
  double area = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const Triangle& t = mesh.triangle(f);
    const Vec3 ab = mesh.position(t[1]) - mesh.position(t[0]);
    const Vec3 ac = mesh.position(t[2]) - mesh.position(t[0]);
    const Vec3 normal = ab.cross(ac);
    const double b = values[t[1]] - values[t[0]];
    const double c = values[t[2]] - values[t[0]];
    if (!(normal.squaredNorm() > 0) || !std::isfinite(b + c)) continue;
    const double slope = (c * ab - b * ac).norm() / normal.norm();
    widths.emplace_back(slope > 0 ? 1 / slope : infinity, mesh.face_area(f));
    area += mesh.face_area(f);
  }
  std::sort(widths.begin(), widths.end(), std::greater<>());
  double beyond = 0;
  for (const auto& [width, face_area] : widths) {
    beyond += face_area;
    if (beyond > slack_share * area && width < infinity)
      return std::max(1, static_cast<int>(std::ceil(width / spacing - 0.02)));
  }
  return 1;
}

std::vector<double> blend_between(const ExactField& a, const ExactField& b) {
  if (&a.mesh() != &b.mesh()) throw Error(ErrorCode::bad_usage, "the fields to blend are of different meshes");
  std::vector<double> values;
  for (Index v = 0; v < a.mesh().n_vertices(); ++v) {
    const double from_a = a.vertex_distances()[v];
    const double sum = from_a + b.vertex_distances()[v];
    values.push_back(sum < infinity ? from_a / sum : infinity);
  }
  return values;
}

}  // namespace isopath
