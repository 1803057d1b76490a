#include "isopath/contour/face_bisectors.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace isopath {
namespace {

/// Triangles are divided beside the middle, where symmetric parts have their bisectors.
constexpr double division = 0.4871;
/// Each division halves a triangle: this often makes it smaller than coordinates can tell.
constexpr int most_divisions = 44;
/// Fronts of one root that differ by no more than this are taken for parts of the same one, radians.
constexpr double most_turn = 0.2;
constexpr int most_refinements = 12;
constexpr double same_distance_over_size = 1e-10;

FrontTie reversed(FrontTie tie) {
  std::swap(tie.before, tie.after);
  return tie;
}

FaceBisectors::Side reversed(FaceBisectors::Side side) {
  std::reverse(side.begin(), side.end());
  for (FrontTie& tie : side) std::swap(tie.before, tie.after);
  return side;
}

/// Newton's method for the point on the line p + s·n where two fronts are equally far.
bool slide_to_tie(const Front& a, const Front& b, const Vec2& p, const Vec2& n, double reach, Vec2& found) {
  double s = 0;
  for (int k = 0; k < 30; ++k) {
    const Vec2 x = p + s * n;
    const double slope = (a.direction(x) - b.direction(x)).dot(n);
    if (std::abs(slope) < 1e-9) return false;
    const double step = (b.distance(x) - a.distance(x)) / slope;
    s += step;
    if (!(std::abs(s) <= reach)) return false;
    if (std::abs(step) <= 1e-15 * reach) break;
  }
  found = p + s * n;
  return true;
}

/// Newton's method for the point that three fronts are equally far from.
bool slide_to_node(const Front& a, const Front& b, const Front& c, Vec2 p, double reach, Vec2& found) {
  const Vec2 start = p;
  for (int k = 0; k < 40; ++k) {
    const Vec2 row1 = a.direction(p) - b.direction(p);
    const Vec2 row2 = a.direction(p) - c.direction(p);
    const Vec2 rhs(b.distance(p) - a.distance(p), c.distance(p) - a.distance(p));
    const double det = cross(row1, row2);
    if (std::abs(det) < 1e-12) return false;
    const Vec2 step((rhs.x() * row2.y() - rhs.y() * row1.y()) / det, (row1.x() * rhs.y() - row2.x() * rhs.x()) / det);
    p += step;
    if (!((p - start).norm() <= reach)) return false;
    if (step.norm() <= 1e-15 * reach) break;
  }
  found = p;
  return true;
}

}  // namespace

bool BisectorRule::separates(const Front& a, const Front& b, const Vec2& p) const {
  if (by_root) {
    // Two as short ways from one direction are one way, to a point that both roots have: they cannot be told apart
    // where a turn about that point changes the distance by less than distances are compared to.
    const double angle = angle_between(a, b, p);
    return a.root != b.root && 0.5 * angle * angle * a.distance(p) > 4 * same_distance_over_size * size;
  }
  // a front has no direction yet where it starts
  const double start = 1e-9 * size;
  if (!a.straight && (p - a.source).squaredNorm() <= start * start) return false;
  if (!b.straight && (p - b.source).squaredNorm() <= start * start) return false;
  return angle_between(a, b, p) >= min_angle;
}

bool BisectorRule::may_meet(const Front& before, const Front& after, const Vec2& p, const Vec2& along) const {
  // fronts that meet along the walk itself, on an edge that is a bisector, are not apart but for rounding
  return by_root || (before.direction(p) - after.direction(p)).dot(along) > -1e-6 * along.norm();
}

FaceBisectors::FaceBisectors(const ExactFieldData& data, Index face, const BisectorRule& rule)
    : data_(data), fronts_(data, face), rule_(rule), same_distance_(same_distance_over_size * rule.size) {
  // cells of sources inside a face may not reach its sides
  const double slack = 1e-9 * rule.size;
  for (const auto& source : data.sources_in(face)) {
    if (fronts_.contains(0.5 * (source.a + source.b), -slack)) shallowest_ = 3;
  }
}

FaceBisectors::Output FaceBisectors::run(const std::array<Side, 3>& sides) {
  Triangle triangle{{fronts_.corner(0), fronts_.corner(1), fronts_.corner(2)}, sides};
  const std::size_t n = sides[0].size() + sides[1].size() + sides[2].size();
  if (fronts_.flatness() > 1e-9) {
    follow(triangle, 0);
  } else if (n == 2) {  // nothing can be told inside
    Side ties;
    for (const Side& side : sides) ties.insert(ties.end(), side.begin(), side.end());
    emit(ties[0], {}, reversed(ties[1]));
  }
  return std::move(out_);
}

/// True when the segment from p to q needs no division between these two fronts.
bool FaceBisectors::same(const Front& a, const Front& b, const Vec2& p, const Vec2& q) const {
  for (const Vec2& x : {p, q, Vec2(0.5 * (p + q))}) {
    if (rule_.separates(a, b, x)) return false;
    // a third front is first seen where two parts of one meet
    if (angle_between(a, b, x) > most_turn) return false;
  }
  return true;
}

bool FaceBisectors::is_nearest(const Front& front, const Vec2& p) const {
  return std::abs(fronts_.nearest(p).distance(p) - front.distance(p)) <= same_distance_;
}

/// True when p, where two fronts are equally far, lies between what they really reach: a front that is cut off by a
/// vertex is not the nearest on its own side.
bool FaceBisectors::divides(const Front& left, const Front& right, const Vec2& p, const Vec2& to_left) const {
  const Vec2 step = 1e-6 * rule_.size * to_left;
  if (!is_nearest(left, p)) return false;
  if (fronts_.contains(p + step, 0) && !is_nearest(left, p + step)) return false;
  return !fronts_.contains(p - step, 0) || is_nearest(right, p - step);
}

/// Where on the segment a stops being the nearer one of the two; its middle where the fronts do not tell.
double FaceBisectors::tie_parameter(const Vec2& p, const Vec2& q, const Front& a, const Front& b) const {
  const auto difference = [&](double t) {
    const Vec2 x = p + t * (q - p);
    return a.distance(x) - b.distance(x);
  };
  double low = 0;
  double high = 1;
  if (!(difference(0) < 0 && difference(1) > 0)) return 0.5;
  double t = 0.5;
  for (int k = 0; k < 100 && high - low > 1e-16; ++k) {
    const double f = difference(t);
    (f < 0 ? low : high) = t;
    const Vec2 x = p + t * (q - p);
    const double slope = (a.direction(x) - b.direction(x)).dot(q - p);
    const double next = t - f / slope;
    if (next == t) break;
    t = next > low && next < high ? next : 0.5 * (low + high);
  }
  return t;
}

/// Appends the ties from p to q, whose nearest fronts are a and b: where the two are equally far nothing else may be
/// nearer, or the third one divides the segment.
void FaceBisectors::ties_along(const Vec2& p, const Front& a, const Vec2& q, const Front& b, int depth,
                               Side& out) const {
  if (same(a, b, p, q)) {
    if (depth < 3) ties_between_checked(p, a, q, depth, out);
    return;
  }
  const Vec2 along = q - p;
  const bool closed_in = along.norm() <= 1e-11 * rule_.size || depth > 2 * most_divisions;
  const double t = closed_in ? 0.5 : tie_parameter(p, q, a, b);
  Vec2 x = p + t * along;
  const bool equal = std::abs(a.distance(x) - b.distance(x)) <= same_distance_;
  const bool tied = equal && divides(a, b, x, -along.normalized());
  if (equal && !tied && is_nearest(a, x)) x = 0.5 * (p + q);
  const Front c = fronts_.nearest(x);
  if (tied || closed_in) {
    if (equal && rule_.separates(a, b, x) && rule_.may_meet(a, b, x, along)) {
      if (depth < 3) ties_between_checked(p, a, x, depth, out);
      out.push_back({x, a, b});
      if (depth < 3) ties_between_checked(x, b, q, depth, out);
    }
    return;
  }
  ties_along(p, a, x, c, depth + 1, out);
  ties_along(x, c, q, b, depth + 1, out);
}

/// The ties inside a segment that one front seems to hold.
void FaceBisectors::ties_between_checked(const Vec2& p, const Front& a, const Vec2& q, int depth, Side& out) const {
  const Vec2 x = p + division * (q - p);
  const Front c = fronts_.nearest(x);
  if (same(a, c, p, q)) return;
  ties_along(p, a, x, c, depth + 1, out);
  ties_along(x, c, q, a, depth + 1, out);
}

void FaceBisectors::follow(const Triangle& triangle, int depth) {
  Side ties;
  for (const Side& side : triangle.sides) ties.insert(ties.end(), side.begin(), side.end());
  if (depth < shallowest_) return divide(triangle, depth);
  if (ties.empty()) return;
  double longest = 0;
  for (int i = 0; i < 3; ++i) longest = std::max(longest, (triangle.corners[i] - triangle.corners[(i + 1) % 3]).norm());
  if (ties.size() == 1) {  // it starts here, or its angle falls below the least one
    if (!start_at_source(triangle, ties[0]) && longest > rule_.chord_tolerance) divide(triangle, depth);
    return;
  }
  if (ties.size() == 2 && join(ties[0], reversed(ties[1]))) return;
  if (meet_in_node(triangle, ties)) return;
  if (longest > 1e-10 * rule_.size && depth < most_divisions) return divide(triangle, depth);
  for (std::size_t k = 1; k < ties.size(); ++k) emit(ties[0], {}, reversed(ties[k]));
}

/// Joins two ties by their bisector. Both have their left front in `before`. False when no bisector runs between them.
bool FaceBisectors::join(const FrontTie& from, const FrontTie& to) {
  std::vector<FrontTie> inner;
  if (!refine(from, to, 0, inner)) return false;
  emit(from, inner, to);
  return true;
}

bool FaceBisectors::refine(const FrontTie& from, const FrontTie& to, int depth, std::vector<FrontTie>& inner) const {
  const double chord = (to.at - from.at).norm();
  if (chord <= 1e-9 * rule_.size || depth == most_refinements) return true;
  FrontTie found;
  if (!middle(from, to, found)) return false;
  const double bend = (found.at - 0.5 * (from.at + to.at)).norm();
  if (bend <= rule_.chord_tolerance) {
    if (bend > 0.1 * rule_.chord_tolerance) inner.push_back(found);
    return true;
  }
  if (!refine(from, found, depth + 1, inner)) return false;
  inner.push_back(found);
  return refine(found, to, depth + 1, inner);
}

/// A point of the bisector across the middle of a chord, from the fronts of its ends.
bool FaceBisectors::middle(const FrontTie& from, const FrontTie& to, FrontTie& found) const {
  const Vec2 along = to.at - from.at;
  const double chord = along.norm();
  const Vec2 across = Vec2(-along.y(), along.x()) / chord;
  const Vec2 centre = 0.5 * (from.at + to.at);
  const std::array<std::pair<const Front*, const Front*>, 4> pairs{
      {{&from.before, &from.after}, {&to.before, &to.after}, {&from.before, &to.after}, {&to.before, &from.after}}};
  for (const auto& [left, right] : pairs) {
    if (!slide_to_tie(*left, *right, centre, across, chord, found.at)) continue;
    if (!fronts_.contains(found.at, 1e-12 * rule_.size) || !rule_.separates(*left, *right, found.at)) continue;
    if (!divides(*left, *right, found.at, across)) continue;
    found.before = *left;
    found.after = *right;
    return true;
  }
  // neither end's fronts reach here: look for others across the chord
  double reach = 0.5 * chord;
  while (reach > 1e-3 * chord &&
         !(fronts_.contains(centre + reach * across, 0) && fronts_.contains(centre - reach * across, 0)))
    reach *= 0.5;
  const Vec2 left = centre + reach * across;
  const Vec2 right = centre - reach * across;
  if (!fronts_.contains(left, 0) || !fronts_.contains(right, 0)) return false;
  Side ties;
  ties_along(left, fronts_.nearest(left), right, fronts_.nearest(right), 0, ties);
  if (ties.size() != 1) return false;
  found = ties[0];
  return true;
}

/// All ties of a triangle meet in one point that three of their fronts are equally far from.
bool FaceBisectors::meet_in_node(const Triangle& triangle, const Side& ties) {
  for (const FrontTie& tie : ties) {
    if (meet_at(tie.at, ties)) {
      return connect_to(tie, ties);
    }
  }
  Vec2 centre = Vec2::Zero();
  for (const FrontTie& tie : ties) centre += tie.at / static_cast<double>(ties.size());
  const Front& a = ties[0].before;
  const Front& b = ties[0].after;
  const Front* third = nullptr;
  double most = 0;
  for (const FrontTie& tie : ties) {
    for (const Front* c : {&tie.before, &tie.after}) {
      const double area =
          std::abs(cross(a.direction(centre) - b.direction(centre), a.direction(centre) - c->direction(centre)));
      if (area <= most) continue;
      most = area;
      third = c;
    }
  }
  double reach = 0;
  for (const Vec2& corner : triangle.corners) reach = std::max(reach, 2 * (corner - centre).norm());
  FrontTie node{.before = a, .after = b};
  if (third == nullptr || !slide_to_node(a, b, *third, centre, reach, node.at)) return false;
  for (int i = 0; i < 3; ++i) {
    const Vec2 along = triangle.corners[(i + 1) % 3] - triangle.corners[i];
    if (cross(along, node.at - triangle.corners[i]) < -1e-11 * rule_.size * along.norm()) return false;
  }
  if (!fronts_.contains(node.at, 1e-11 * rule_.size)) return false;
  if (!is_nearest(a, node.at) || !meet_at(node.at, ties)) return false;
  node.id = ~out_.n_points;
  if (!connect_to(node, ties)) return false;
  ++out_.n_points;
  return true;
}

bool FaceBisectors::meet_at(const Vec2& node, const Side& ties) const {
  const double d = ties[0].before.distance(node);
  for (const FrontTie& tie : ties) {
    if (std::abs(tie.before.distance(node) - d) > same_distance_) return false;
    if (std::abs(tie.after.distance(node) - d) > same_distance_) return false;
  }
  return true;
}

bool FaceBisectors::connect_to(FrontTie node, const Side& ties) {
  std::vector<std::vector<FrontTie>> ways(ties.size());
  for (std::size_t k = 0; k < ties.size(); ++k) {
    node.before = ties[k].before;
    node.after = ties[k].after;
    const Vec2 along = node.at - ties[k].at;
    const double chord = along.norm();
    if (chord > 1e-5 * rule_.size) {  // the fronts must reach as far as the node
      const Vec2 across = Vec2(-along.y(), along.x()) / chord;
      const Vec2 close = node.at - 1e-5 * rule_.size / chord * along;
      Vec2 found;
      if (slide_to_tie(node.before, node.after, close, across, 1e-5 * rule_.size, found) &&
          !divides(node.before, node.after, found, across))
        return false;
    }
    if (ties[k].id != node.id && !refine(ties[k], node, 0, ways[k])) return false;
  }
  for (std::size_t k = 0; k < ties.size(); ++k) {
    node.before = ties[k].before;
    node.after = ties[k].after;
    if (ties[k].id != node.id) emit(ties[k], ways[k], node);
  }
  return true;
}

/// A bisector that begins where two segments of a source meet inside the face.
bool FaceBisectors::start_at_source(const Triangle& triangle, const FrontTie& tie) {
  for (const auto& source : data_.sources_in(fronts_.face())) {
    if (source.squared_length > 0 || tie.before.distance(source.a) > same_distance_ ||
        tie.after.distance(source.a) > same_distance_)
      continue;
    bool inside = true;
    for (int i = 0; i < 3; ++i) {
      const Vec2& corner = triangle.corners[i];
      inside = inside && cross(triangle.corners[(i + 1) % 3] - corner, source.a - corner) >= 0;
    }
    if (!inside) continue;
    FrontTie start = tie;
    start.at = source.a;
    start.id = ~out_.n_points;
    if (!join(tie, start)) continue;
    ++out_.n_points;
    return true;
  }
  return false;
}

void FaceBisectors::divide(const Triangle& triangle, int depth) {
  std::array<Vec2, 3> m;
  std::array<Front, 3> at;
  std::array<Side, 3> first;
  std::array<Side, 3> second;
  for (int i = 0; i < 3; ++i) {
    const Vec2& start = triangle.corners[i];
    const Vec2 along = triangle.corners[(i + 1) % 3] - start;
    m[i] = start + division * along;
    at[i] = fronts_.nearest(m[i]);
    for (const FrontTie& tie : triangle.sides[i]) {
      const double t = (tie.at - start).dot(along) / along.squaredNorm();
      (t < division ? first : second)[i].push_back(tie);
    }
  }
  std::array<Side, 3> inner;  // from m[i] to the one before
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 2) % 3;
    ties_along(m[i], at[i], m[k], at[k], 0, inner[i]);
    for (FrontTie& tie : inner[i]) tie.id = ~out_.n_points++;
  }
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 2) % 3;
    follow({{triangle.corners[i], m[i], m[k]}, {first[i], inner[i], second[k]}}, depth + 1);
  }
  follow({{m[0], m[1], m[2]}, {reversed(inner[1]), reversed(inner[2]), reversed(inner[0])}}, depth + 1);
}

void FaceBisectors::emit(const FrontTie& from, const std::vector<FrontTie>& inner, const FrontTie& to) {
  BisectorPiece& piece = out_.pieces.emplace_back(BisectorPiece{from.id, to.id, {}});
  const auto append = [&](const FrontTie& tie) {
    piece.points.push_back({fronts_.surface_point(tie.at),
                            tie.before.distance(tie.at),
                            angle_between(tie.before, tie.after, tie.at),
                            {tie.before.root, tie.after.root}});
  };
  append(from);
  for (const FrontTie& tie : inner) append(tie);
  append(to);
}

}  // namespace isopath
