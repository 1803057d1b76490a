#include "isopath/impact/component_spiral.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace isopath {
namespace {

/// The window that the curve changes levels in: so many spacings long for each arm, or this share of the whole curve,
/// so that a curve of many turns is a spiral all round.
constexpr double window_in_spacings = 3;
constexpr double window_in_spacings_an_arm = 2;
constexpr double window_share = 0.005;
/// No more than this of a level's length, and of a turn.
constexpr double widest_window = 0.45;
constexpr double last_turn = 0.9;
/// Where the arms' ends are cut off, as a share of the window.
constexpr double first_cut = 0.1;
constexpr double last_cut = 0.9;

double wrapped(double turn) { return turn - std::round(turn); }

/// A stretch of the curve, with the turn at every point.
struct Stretch {
  SurfaceCurve curve;
  std::vector<double> turn;
};

/// Where a level is crossed, as the spiral of one component sees it.
struct RingFigures {
  double length = 0;
  std::vector<std::pair<double, double>> arcs;  // turn and length of each chord
  std::vector<double> steepness;                // by how much the function is steeper than 1 there
  std::vector<Vec3> positions;
  /// Turn and size, in squares of a spacing, of places between this level and the next where levels are not a spacing
  /// apart, times how much they are off.
  std::vector<std::pair<double, double>> uneven;
};

/// The spiral of one component.
class ComponentSpiral {
 public:
  ComponentSpiral(const SurfaceLinker& linker, const VertexField& function, const TurnAngle& angle,
                  const std::vector<Index>& faces, const std::vector<const Contour*>& rings, double spacing, int arms,
                  const Progress& progress)
      : linker_(linker),
        mesh_(linker.mesh()),
        function_(function),
        angle_(angle),
        faces_(faces),
        spacing_(spacing),
        arms_(arms),
        n_(static_cast<int>(rings.size())),
        progress_(progress),
        height_(mesh_.n_vertices(), infinity),
        turn_(mesh_.n_vertices(), 0.0),
        share_(mesh_.n_vertices(), 0.0),
        crossed_(mesh_.n_faces(), 0) {
    double top = -infinity;
    double area = 0;
    for (const Index f : faces_) {
      for (const Index v : mesh_.triangle(f)) {
        height_[v] = function.value_at_vertex(v) / spacing;
        if (height_[v] < infinity) top = std::max(top, height_[v]);
      }
      area += mesh_.face_area(f);
    }
    top_ = std::min(static_cast<double>(n_), top - 0.02);
    for (const Contour* ring : rings) rings_.push_back(figures_of(*ring));
    find_uneven_places();
    window_length_ =
        std::max((window_in_spacings + window_in_spacings_an_arm * arms) * spacing, window_share * area / spacing);
    choose_phase();
    choose_windows();
  }

  SurfaceCurve run() {
    std::vector<SurfaceCurve> arm(arms_);
    for (int first = 1; first <= arms_; ++first) {
      SurfaceCurve& curve = arm[first - 1];
      append(curve, outer_lane(first));
      int ring = first;
      for (; ring + arms_ <= n_; ring += arms_) {
        progress_.checkpoint();
        append(curve, stretch([&](double share) { return ring - 0.5 + arms_ * share; }));
      }
      append(curve, inner_lane(ring));
    }
    if (arms_ == 1) return std::move(arm[0]);
    arm[1].reverse();
    append(arm[0], {arm[1], {}});
    const SurfacePoint start = arm[0].points.front();
    linker_.extend(arm[0], start);
    return std::move(arm[0]);
  }

 private:
  Stretch outer_lane(int first) {
    return part(stretch([&](double share) { return (0.5 + arms_ * share) * (2 * first - 1) / (2 * arms_ + 1); }),
                first_cut, infinity);
  }
  Stretch inner_lane(int ring) {
    const double last = n_ - arms_ - 0.5;  // the level that the outermost arm comes from
    const double place = (top_ - (ring - 0.5)) / (top_ - last);
    return part(stretch([&](double share) { return top_ - (top_ - last - arms_ * share) * place; }), -infinity,
                last_cut);
  }

  RingFigures figures_of(const Contour& ring) const {
    RingFigures figures;
    for (const SurfacePoint& point : ring.points) {
      figures.positions.push_back(position_of(mesh_, point));
      figures.steepness.push_back(std::max(0.0, slope_in(point.face) - 1));
    }
    for (std::size_t i = 0; i < ring.points.size(); ++i) {
      const std::size_t next = (i + 1) % ring.points.size();
      const double chord = (figures.positions[next] - figures.positions[i]).norm();
      figures.length += chord;
      figures.arcs.emplace_back(turn_at(ring.points[i]), chord);
    }
    return figures;
  }

  /// Levels are where they are to be, and what lies between them need not be even, as beside the axis, where tips are
  /// pulled: a curve that rises there would leave gaps.
  void find_uneven_places() {
    for (const Index f : faces_) {
      const SurfacePoint middle{f, Vec3::Constant(1.0 / 3)};
      const double level = std::floor(function_.value(middle) / spacing_ - 0.5);
      const double off = std::abs(slope_in(f) - 1);
      if (!(level >= 0 && level < n_) || off < 0.02) continue;
      rings_[static_cast<std::size_t>(level)].uneven.emplace_back(
          turn_at(middle), std::min(off, 1.0) * mesh_.face_area(f) / (spacing_ * spacing_));
    }
  }

  /// Levels for each spacing across them.
  double slope_in(Index face) const {
    const Triangle& t = mesh_.triangle(face);
    const Vec3 ab = mesh_.position(t[1]) - mesh_.position(t[0]);
    const Vec3 ac = mesh_.position(t[2]) - mesh_.position(t[0]);
    const double doubled_area = ab.cross(ac).norm();
    const Vec3 across = (height_[t[2]] - height_[t[0]]) * ab - (height_[t[1]] - height_[t[0]]) * ac;
    return doubled_area > 0 ? spacing_ * across.norm() / doubled_area : 1;
  }

  double turn_at(const SurfacePoint& point) const {
    const Triangle& corners = mesh_.triangle(point.face);
    double sum = 0;
    const double base = angle_.turn[corners[0]];
    for (int i = 1; i < 3; ++i) sum += point.barycentric[i] * wrapped(angle_.turn[corners[i]] - base);
    return base + sum;
  }

  /// How much of a level's length lies within each turn from a phase on: at n_turns even steps, and the whole.
  static std::vector<double> arcs_by_turn(const RingFigures& ring, double phase) {
    std::vector<double> along(n_turns + 1, 0.0);
    for (const auto& [turn, length] : ring.arcs) {
      const double off = turn - phase;
      const auto m = static_cast<std::size_t>((off - std::floor(off)) * n_turns);
      along[std::min(m, n_turns - 1) + 1] += length;
    }
    for (std::size_t m = 0; m < n_turns; ++m) along[m + 1] += along[m];
    return along;
  }

  /// The turn from which levels run straightest over the window.
  void choose_phase() {
    std::vector<double> bend(n_turns, 0.0);
    const std::size_t stride = std::max<std::size_t>(1, rings_.size() / 6);
    for (std::size_t k = 0; k < rings_.size(); k += stride) {
      if (k == 0 || rings_[k].length > 3 * window_length_) add_bends(rings_[k], bend);
    }
    for (std::size_t k = 1; k < rings_.size(); ++k) add_dead_ends(rings_[k - 1], rings_[k], bend);
    for (const RingFigures& ring : rings_) add_lost_ways(ring, spacing_, bend);
    const auto best = std::min_element(bend.begin(), bend.end()) - bend.begin();
    phase_ = static_cast<double>(best) / n_turns;
    for (const Index f : faces_) {
      for (const Index v : mesh_.triangle(f)) {
        const double off = angle_.turn[v] - phase_;
        const double turn = off - std::floor(off);
        turn_[v] = turn < 1 - before_window ? turn : turn - 1;
      }
    }
  }

  /// Adds for every phase how much a level bends in a window that starts there, by its change of direction from one
  /// spacing to the next, and how closely levels are squeezed together.
  void add_bends(const RingFigures& ring, std::vector<double>& bend) const {
    const std::vector<double> along = arcs_by_turn(ring, 0);
    const auto arc_at = [&](double turn) {
      return along[std::min(static_cast<std::size_t>((turn - std::floor(turn)) * n_turns), n_turns)];
    };
    std::vector<std::pair<double, double>> corners;  // where along, and change of direction or steepness
    for (const auto& [turn, weight] : ring.uneven) corners.emplace_back(arc_at(turn), weight);
    const std::size_t n = ring.positions.size();
    Vec3 from = ring.positions.front();
    Vec3 last = Vec3::Zero();
    double way = 0;
    for (std::size_t k = 0; k < 2 * n && way < ring.length + 3 * spacing_; ++k) {
      const std::size_t i = k % n;
      way += ring.arcs[i].second;
      const double arc = arc_at(ring.arcs[i].first);
      if (k < n) corners.emplace_back(arc, ring.steepness[i] * ring.arcs[i].second / spacing_);
      if ((ring.positions[i] - from).norm() < spacing_) continue;
      const Vec3 step = (ring.positions[i] - from).normalized();
      if (!last.isZero(0)) corners.emplace_back(arc, std::acos(std::clamp(step.dot(last), -1.0, 1.0)));
      last = step;
      from = ring.positions[i];
    }
    for (std::size_t p = 0; p < n_turns; ++p) {
      // where a level hurries past, its turns tell places apart too badly
      if (along[p + 1] - along[p] > 0.1 * window_length_) bend[p] += 1;
      const double middle = along[p] + 0.5 * window_length_;
      for (const auto& [arc, change] : corners) {
        double apart = std::fmod(std::abs(arc - middle), ring.length);
        apart = std::min(apart, ring.length - apart);
        bend[p] += change * std::max(0.0, 1 - apart / window_length_);
      }
    }
  }

  double window_of(const RingFigures& ring) const { return std::min(window_length_, widest_window * ring.length); }

  /// Adds for every phase how much longer the level before is over a level's window: it goes into dead ends there,
  /// which the curve would fill with a useless turn while it rises.
  void add_dead_ends(const RingFigures& before, const RingFigures& ring, std::vector<double>& bend) const {
    const std::vector<double> along = arcs_by_turn(ring, 0);
    const std::vector<double> along_before = arcs_by_turn(before, 0);
    const double window = window_of(ring);
    std::size_t end = 0;
    for (std::size_t p = 0; p < n_turns; ++p) {
      end = std::max(end, p);
      while (end < p + n_turns && arc_in(along, end) - arc_in(along, p) < window) ++end;
      const double excess = arc_in(along_before, end) - arc_in(along_before, p) - window - 3 * spacing_;
      bend[p] += std::max(0.0, excess) / spacing_;
    }
  }

  /// Adds for every phase how long a level runs all but along the line that the surface is cut open by: turns hardly
  /// change in narrow arms, and a level that goes over the line and back in one falls to pieces.
  static void add_lost_ways(const RingFigures& ring, double spacing, std::vector<double>& bend) {
    constexpr std::size_t near_cut = n_turns / 64;
    constexpr double usual = 3;  // times the mean of all places
    const std::vector<double> along = arcs_by_turn(ring, 0);
    const auto cut_before = static_cast<std::size_t>(before_window * n_turns);
    for (std::size_t p = 0; p < n_turns; ++p) {
      const std::size_t begin = p + n_turns - cut_before - near_cut;
      const double length = arc_in(along, begin + 2 * near_cut) - arc_in(along, begin);
      bend[p] += std::max(0.0, length - usual * ring.length * 2 * near_cut / n_turns) / spacing;
    }
  }

  /// An entry of arcs_by_turn, going on after a whole turn.
  static double arc_in(const std::vector<double>& along, std::size_t m) {
    return along[m % n_turns] + static_cast<double>(m / n_turns) * along[n_turns];
  }

  /// How much of its rise a level has done at each turn: in proportion to the length it has gone, over the window. A
  /// level is never ahead of the one before, so that they do not part.
  void choose_windows() {
    const auto widest = static_cast<std::size_t>(last_turn * n_turns);
    for (const RingFigures& ring : rings_) {
      const std::vector<double> along = arcs_by_turn(ring, phase_);
      const double window = std::max(std::min(window_of(ring), along[widest]), 1e-9 * ring.length);
      std::vector<double> share(n_turns + 1);
      for (std::size_t m = 0; m <= n_turns; ++m) {
        share[m] = m >= widest ? 1 : std::min(1.0, along[m] / window);
        if (!shares_.empty()) share[m] = std::min(share[m], shares_.back()[m]);
      }
      shares_.push_back(std::move(share));
    }
    for (const Index f : faces_) {
      for (const Index v : mesh_.triangle(f)) {
        const double x = share_before(height_[v], turn_[v]);
        share_[v] = x * x * (3 - 2 * x);
      }
    }
  }

  /// Share of the window that lies before a turn, at a height; even along the level.
  double share_before(double height, double turn) const {
    if (!(height < infinity) || turn <= 0) return 0;
    const auto between = [](const std::vector<double>& table, double place) {
      const auto m = std::min(static_cast<std::size_t>(place), table.size() - 2);
      const double t = std::min(1.0, place - static_cast<double>(m));
      return (1 - t) * table[m] + t * table[m + 1];
    };
    const double level = std::clamp(height - 0.5, 0.0, static_cast<double>(n_ - 1));
    const auto k = std::min(static_cast<std::size_t>(level), shares_.size() - 1);
    const std::size_t next = std::min(k + 1, shares_.size() - 1);
    const double t = level - static_cast<double>(k);
    return (1 - t) * between(shares_[k], turn * n_turns) + t * between(shares_[next], turn * n_turns);
  }

  bool is_open(Index face) const {
    const Triangle& t = mesh_.triangle(face);
    if (angle_.hole[face]) return false;
    for (int i = 0; i < 3; ++i) {
      if (!(height_[t[i]] < infinity) || std::abs(turn_[t[i]] - turn_[t[(i + 1) % 3]]) > 0.5) return false;
    }
    return true;
  }

  /// The longest curve along which the height is what `level` says of the share of the window, in the order of turns,
  /// on the surface cut open a little before the window.
  template <class Level>
  Stretch stretch(const Level& level) {
    const auto above = [&](Index v) { return height_[v] >= level(share_[v]); };
    std::vector<Index> cut;
    for (const Index f : faces_) {
      const Triangle& t = mesh_.triangle(f);
      if ((above(t[0]) == above(t[1]) && above(t[1]) == above(t[2])) || !is_open(f)) continue;
      crossed_[f] = 1;
      cut.push_back(f);
    }
    // the edge by which the curve enters a face with the larger values on its left, and the one by which it leaves
    const auto enters = [&](Index f) {
      for (Index h = 3 * f;; ++h) {
        if (above(mesh_.from(h)) && !above(mesh_.to(h))) return h;
      }
    };
    const auto leaves = [&](Index f) {
      for (Index h = 3 * f;; ++h) {
        if (!above(mesh_.from(h)) && above(mesh_.to(h))) return h;
      }
    };
    const auto next_over = [&](Index h) {
      const Index twin = mesh_.twin(h);
      const Index f = twin == no_index ? no_index : TriangleMesh::face_of(twin);
      return f != no_index && crossed_[f] ? f : no_index;
    };
    Stretch best;
    double longest = -1;
    for (const Index seed : cut) {
      if (crossed_[seed] != 1) continue;
      Index first = seed;
      for (Index f = next_over(enters(seed)); f != no_index && f != seed; f = next_over(enters(f))) first = f;
      Stretch chain;
      add_crossing(chain, enters(first), level);
      for (Index f = first; f != no_index && crossed_[f] == 1; f = next_over(leaves(f))) {
        crossed_[f] = 2;
        add_crossing(chain, leaves(f), level);
      }
      const double length = length_of(chain.curve);
      if (length > longest) {
        longest = length;
        best = std::move(chain);
      }
    }
    for (const Index f : cut) crossed_[f] = 0;
    if (!best.curve.empty() && best.turn.front() > best.turn.back()) {
      best.curve.reverse();
      std::reverse(best.turn.begin(), best.turn.end());
    }
    return best;
  }

  template <class Level>
  void add_crossing(Stretch& chain, Index h, const Level& level) const {
    const Index canonical = mesh_.halfedge_of(mesh_.edge_of(h));
    const double from = height_[mesh_.from(canonical)] - level(share_[mesh_.from(canonical)]);
    const double to = height_[mesh_.to(canonical)] - level(share_[mesh_.to(canonical)]);
    double t = std::clamp(from / (from - to), 0.0, 1.0);
    // on the vertex exactly, so that what comes next shares a face with it
    if (std::min(t, 1 - t) < 1e-9) t = std::round(t);
    chain.curve.add(mesh_, point_on_halfedge(canonical, t));
    chain.turn.push_back((1 - t) * turn_[mesh_.from(canonical)] + t * turn_[mesh_.to(canonical)]);
  }

  /// What lies between two shares of the window.
  Stretch part(Stretch whole, double from, double to) const {
    std::size_t begin = 0;
    std::size_t end = whole.turn.size();
    for (std::size_t i = 0; i < whole.turn.size(); ++i) {
      const double share = share_before(function_.value(whole.curve.points[i]) / spacing_, whole.turn[i]);
      if (share < from) begin = i + 1;
      if (share > to) end = std::min(end, i);
    }
    end = std::max(begin, end);
    const auto cut = [&](auto& values) {
      values.resize(end);
      values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(begin));
    };
    cut(whole.curve.points);
    cut(whole.curve.positions);
    cut(whole.turn);
    return whole;
  }

  void append(SurfaceCurve& curve, const Stretch& more) const {
    if (more.curve.empty()) return;
    linker_.extend(curve, more.curve.points.front());
    curve.points.insert(curve.points.end(), more.curve.points.begin() + 1, more.curve.points.end());
    curve.positions.insert(curve.positions.end(), more.curve.positions.begin() + 1, more.curve.positions.end());
  }

  static constexpr std::size_t n_turns = 1024;
  static constexpr double before_window = 0.05;  // turns: where the surface is cut open
  const SurfaceLinker& linker_;
  const TriangleMesh& mesh_;
  const VertexField& function_;
  const TurnAngle& angle_;
  const std::vector<Index>& faces_;
  double spacing_;
  int arms_;
  int n_;  // levels
  const Progress& progress_;
  double top_ = 0;
  double window_length_ = 0;
  double phase_ = 0;
  std::vector<RingFigures> rings_;
  std::vector<std::vector<double>> shares_;  // of every level, at even steps of the turn
  std::vector<double> height_;               // in spacings
  std::vector<double> turn_;                 // from the window's start
  std::vector<double> share_;                // of the rise that is done there
  std::vector<char> crossed_;
};

}  // namespace

SurfaceCurve component_spiral(const SurfaceLinker& linker, const VertexField& function, const TurnAngle& angle,
                              const std::vector<Index>& faces, const std::vector<const Contour*>& rings,
                              const ComponentSpiralOptions& options, const Progress& progress) {
  return ComponentSpiral(linker, function, angle, faces, rings, options.spacing, options.arms, progress).run();
}

}  // namespace isopath
