#include "isopath/mesh/surface_locator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "isopath/core/segment.h"

namespace isopath {
namespace {

constexpr Index leaf_size = 4;
constexpr int n_bins = 16;
/// Binned halving ends in a median split below this depth, so no stack is ever longer than this plus the 31 halvings
/// of an `Index` worth of triangles.
constexpr int depth_of_median_splits = 64;
constexpr int stack_size = depth_of_median_splits + 32;

double half_area(const Box3& box) {
  if (box.isEmpty()) return 0;
  const Vec3 d = box.sizes();
  return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
}

struct OnTriangle {
  Vec3 barycentric;
  double squared_distance;
};

/// Nearest point on the side from corner i to the next one.
OnTriangle nearest_on_side(const std::array<Vec3, 3>& p, int i, const Vec3& q) {
  const int j = (i + 1) % 3;
  const double t = nearest_on_segment(p[i], p[j], q);
  OnTriangle out{Vec3::Zero(), (p[i] + t * (p[j] - p[i]) - q).squaredNorm()};
  out.barycentric[i] = 1 - t;
  out.barycentric[j] = t;
  return out;
}

/// Nearest point on a triangle that may be a sliver, a segment or a point.
///
/// The point is compared with the three planes through the sides and the normal, which stays well conditioned for
/// far points and slivers, unlike products of dot products. A triangle lower than 1e-12 of its longest side has no
/// normal worth the name; then its sides stand for it, at an error below its height, which the tolerance rule calls
/// zero.
OnTriangle nearest_on_triangle(const std::array<Vec3, 3>& p, const Vec3& q) {
  const std::array<Vec3, 3> side = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  const Vec3 normal = side[0].cross(side[1]);
  const double normal2 = normal.squaredNorm();
  const double longest2 = std::max({side[0].squaredNorm(), side[1].squaredNorm(), side[2].squaredNorm()});
  const bool flat = normal2 <= 1e-24 * longest2 * longest2;
  OnTriangle best{Vec3::Zero(), infinity};
  Vec3 area;
  for (int i = 0; i < 3; ++i) {
    area[(i + 2) % 3] = flat ? -1 : normal.cross(side[i]).dot(q - p[i]);
    if (area[(i + 2) % 3] > 0) continue;
    const OnTriangle candidate = nearest_on_side(p, i, q);
    if (candidate.squared_distance < best.squared_distance) best = candidate;
  }
  if (area.minCoeff() > 0) {
    best.barycentric = area / area.sum();
    const double height = normal.dot(q - p[0]);
    best.squared_distance = height * height / normal2;
  }
  return best;
}

/// A segment prepared for the shear of Woop, Benthin & Wald 2013.
struct Segment {
  Vec3 origin;
  Vec3 direction;
  std::array<int, 3> axis;  ///< axis[2] is the direction's longest
  Vec3 shear;

  Segment(const Vec3& a, const Vec3& b) : origin(a), direction(b - a) {
    direction.cwiseAbs().maxCoeff(&axis[2]);
    axis[0] = (axis[2] + 1) % 3;
    axis[1] = (axis[2] + 2) % 3;
    const double z = direction[axis[2]];
    shear = {direction[axis[0]] / z, direction[axis[1]] / z, 1 / z};
  }

  /// Fraction where the segment enters the box, infinity where it misses it or enters after `end`. The bounds are
  /// widened by the rounding error of a difference and a quotient.
  double enters(const Box3& box, double end) const {
    double low = 0;
    double high = end;
    for (int i = 0; i < 3; ++i) {
      if (direction[i] == 0) {
        if (origin[i] < box.min()[i] || origin[i] > box.max()[i]) return infinity;
        continue;
      }
      double near = (box.min()[i] - origin[i]) / direction[i];
      double far = (box.max()[i] - origin[i]) / direction[i];
      if (near > far) std::swap(near, far);
      constexpr double slack = 4 * std::numeric_limits<double>::epsilon();
      low = std::max(low, near - slack * std::abs(near));
      high = std::min(high, far + slack * std::abs(far));
    }
    return low <= high ? low : infinity;
  }

  /// Fraction where the segment's line meets the triangle, infinity where it does not.
  double meets(const std::array<Vec3, 3>& p) const {
    std::array<Vec3, 3> s;
    for (int i = 0; i < 3; ++i) {
      const Vec3 v = p[i] - origin;
      const double z = v[axis[2]];
      s[i] = {v[axis[0]] - shear[0] * z, v[axis[1]] - shear[1] * z, shear[2] * z};
    }
    const double u = s[2].x() * s[1].y() - s[2].y() * s[1].x();
    const double v = s[0].x() * s[2].y() - s[0].y() * s[2].x();
    const double w = s[1].x() * s[0].y() - s[1].y() * s[0].x();
    if (std::min({u, v, w}) < 0 && std::max({u, v, w}) > 0) return infinity;
    const double sum = u + v + w;
    if (sum == 0) return infinity;
    return (u * s[0].z() + v * s[1].z() + w * s[2].z()) / sum;
  }
};

}  // namespace

/// Top-down construction, splits by the surface area heuristic over bins (Wald 2007).
struct SurfaceLocator::Builder {
  struct Item {
    Box3 box;
    Vec3 centre;
    Index face;
  };
  struct Split {
    int axis = 0;
    double at = -infinity;  ///< nothing is below when no cut is worth while
  };

  std::vector<Item> items;
  std::vector<Node>& nodes;

  Builder(const TriangleMesh& mesh, std::vector<Node>& out) : nodes(out) {
    items.reserve(mesh.n_faces());
    for (Index f = 0; f < mesh.n_faces(); ++f) {
      Item& item = items.emplace_back(Item{Box3(), Vec3::Zero(), f});
      for (const Index v : mesh.triangle(f)) item.box.extend(mesh.position(v));
      item.centre = item.box.center();
    }
    nodes.reserve(items.size());
    if (!items.empty()) build(0, mesh.n_faces(), 0);
  }

  /// Where to cut across the longest side of the centres' box: the other sides would cost two thirds of the time, and
  /// pay on no mesh that we know.
  Split best_split(Index begin, Index end, const Box3& centres) const {
    Split best;
    const double width = centres.sizes().maxCoeff(&best.axis);
    const double low = centres.min()[best.axis];
    if (!(width > 0)) return best;
    std::array<Box3, n_bins> box;
    std::array<Index, n_bins> count{};
    for (Index i = begin; i < end; ++i) {
      const auto bin = std::min(n_bins - 1, static_cast<int>((items[i].centre[best.axis] - low) / width * n_bins));
      box[bin].extend(items[i].box);
      ++count[bin];
    }
    std::array<double, n_bins> cost_above{};
    Box3 above;
    Index n_above = 0;
    for (int b = n_bins - 1; b > 0; --b) {
      above.extend(box[b]);
      n_above += count[b];
      cost_above[b] = n_above * half_area(above);
    }
    Box3 below;
    Index n_below = 0;
    double least = infinity;
    for (int b = 1; b < n_bins; ++b) {
      below.extend(box[b - 1]);
      n_below += count[b - 1];
      const double cost = n_below * half_area(below) + cost_above[b];
      if (n_below == 0 || n_below == end - begin || !(cost < least)) continue;
      least = cost;
      best.at = low + width * b / n_bins;
    }
    return best;
  }

  void build(Index begin, Index end, int depth) {
    const auto node = static_cast<Index>(nodes.size());
    nodes.push_back({Box3(), begin, end - begin});
    Box3 centres;
    for (Index i = begin; i < end; ++i) {
      nodes[node].box.extend(items[i].box);
      centres.extend(items[i].centre);
    }
    if (end - begin <= leaf_size) return;
    Index middle = begin;
    if (depth < depth_of_median_splits) {
      const Split split = best_split(begin, end, centres);
      const auto below = [&](const Item& item) { return item.centre[split.axis] < split.at; };
      middle = static_cast<Index>(std::partition(items.begin() + begin, items.begin() + end, below) - items.begin());
    }
    if (middle == begin || middle == end) {
      int axis = 0;
      centres.sizes().maxCoeff(&axis);
      middle = begin + (end - begin) / 2;
      std::nth_element(items.begin() + begin, items.begin() + middle, items.begin() + end,
                       [&](const Item& a, const Item& b) { return a.centre[axis] < b.centre[axis]; });
    }
    nodes[node].count = 0;
    build(begin, middle, depth + 1);
    nodes[node].other = static_cast<Index>(nodes.size());
    build(middle, end, depth + 1);
  }
};

SurfaceLocator::SurfaceLocator(const TriangleMesh& mesh) {
  const Builder builder(mesh, nodes_);
  corners_.reserve(builder.items.size());
  for (const auto& item : builder.items) {
    const auto& [a, b, c] = mesh.triangle(item.face);
    corners_.push_back({{mesh.position(a), mesh.position(b), mesh.position(c)}, item.face});
  }
}

NearestPoint SurfaceLocator::nearest(const Vec3& point, double max_distance) const {
  NearestPoint out;
  if (nodes_.empty() || !point.allFinite() || !(max_distance > 0)) return out;
  double best = max_distance * max_distance;
  std::array<std::pair<double, Index>, stack_size> stack;
  int top = 0;
  stack[top++] = {nodes_[0].box.squaredExteriorDistance(point), 0};
  while (top > 0) {
    const auto [box_distance, index] = stack[--top];
    if (!(box_distance < best)) continue;
    const Node& node = nodes_[index];
    if (node.count > 0) {
      for (Index i = node.other; i < node.other + node.count; ++i) {
        const OnTriangle candidate = nearest_on_triangle(corners_[i].p, point);
        if (!(candidate.squared_distance < best)) continue;
        best = candidate.squared_distance;
        out.at = {corners_[i].face, candidate.barycentric};
      }
      continue;
    }
    std::pair near{nodes_[index + 1].box.squaredExteriorDistance(point), index + 1};
    std::pair far{nodes_[node.other].box.squaredExteriorDistance(point), node.other};
    if (far.first < near.first) std::swap(near, far);
    if (far.first < best) stack[top++] = far;
    if (near.first < best) stack[top++] = near;
  }
  if (out.at.valid()) {
    out.at.barycentric = snapped(out.at.barycentric);
    out.distance = std::sqrt(best);
  }
  return out;
}

SegmentHit SurfaceLocator::cast(const Vec3& a, const Vec3& b, bool any) const {
  SegmentHit out;
  if (nodes_.empty() || a == b || !a.allFinite() || !b.allFinite()) return out;
  const Segment segment(a, b);
  double end = 1;
  std::array<std::pair<double, Index>, stack_size> stack;
  int top = 0;
  stack[top++] = {segment.enters(nodes_[0].box, end), 0};
  while (top > 0) {
    const auto [entry, index] = stack[--top];
    if (!(entry <= end)) continue;
    const Node& node = nodes_[index];
    if (node.count > 0) {
      for (Index i = node.other; i < node.other + node.count; ++i) {
        const double t = segment.meets(corners_[i].p);
        if (!(t >= 0 && t <= end) || (out.hit && t == out.t)) continue;
        out = {true, t, corners_[i].face};
        if (any) return out;
        end = t;
      }
      continue;
    }
    std::pair near{segment.enters(nodes_[index + 1].box, end), index + 1};
    std::pair far{segment.enters(nodes_[node.other].box, end), node.other};
    if (far.first < near.first) std::swap(near, far);
    if (far.first <= end) stack[top++] = far;
    if (near.first <= end) stack[top++] = near;
  }
  return out;
}

}  // namespace isopath
