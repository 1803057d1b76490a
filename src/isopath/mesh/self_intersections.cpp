#include "isopath/mesh/self_intersections.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace isopath {
namespace {

/// Sign of the volume of a tetrahedron, 0 within its rounding error: (7 + 56 ε) ε times the sum of the absolute
/// products bounds it (Shewchuk 1997, section 4.4).
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  constexpr double bound = 8 * 0x1p-53;
  const Vec3 u = a - d;
  const Vec3 v = b - d;
  const Vec3 w = c - d;
  const double det = u.dot(v.cross(w));
  const auto positive_cross = [](const Vec3& p, const Vec3& q) {
    return Vec3(std::abs(p.y() * q.z()) + std::abs(p.z() * q.y()), std::abs(p.z() * q.x()) + std::abs(p.x() * q.z()),
                std::abs(p.x() * q.y()) + std::abs(p.y() * q.x()));
  };
  const double error = bound * u.cwiseAbs().dot(positive_cross(v, w));
  return det > error ? 1 : det < -error ? -1 : 0;
}

using Corners = std::array<Vec3, 3>;

/// The open segment passes through the plane of the triangle, inside it or through its rim.
bool pierces(const Vec3& p, const Vec3& q, const Corners& t) {
  if (orientation(t[0], t[1], t[2], p) * orientation(t[0], t[1], t[2], q) >= 0) return false;
  int lowest = 1;
  int highest = -1;
  for (int i = 0; i < 3; ++i) {
    const int side = orientation(p, q, t[i], t[(i + 1) % 3]);
    lowest = std::min(lowest, side);
    highest = std::max(highest, side);
  }
  return lowest >= 0 || highest <= 0;
}

/// Two triangles in one plane overlap unless an edge line of one has the other on its far side (separating axis).
bool overlap_in_plane(const Corners& s, const Corners& t) {
  const Vec3 normal = (s[1] - s[0]).cross(s[2] - s[0]);
  const auto separates = [&](const Corners& one, const Corners& other) {
    for (int i = 0; i < 3; ++i) {
      const Vec3& from = one[i];
      // A point off the plane turns the side of an edge in the plane into a volume.
      const Vec3 above = from + normal / std::sqrt(std::max(normal.stableNorm(), std::numeric_limits<double>::min()));
      const int own = orientation(from, one[(i + 1) % 3], above, one[(i + 2) % 3]);
      if (own == 0) return true;  // no area, no overlap
      const bool apart = std::all_of(other.begin(), other.end(), [&](const Vec3& p) {
        return orientation(from, one[(i + 1) % 3], above, p) * own <= 0;
      });
      if (apart) return true;
    }
    return false;
  };
  return !separates(s, t) && !separates(t, s);
}

class IntersectionFinder {
 public:
  IntersectionFinder(const TriangleSoup& soup, Progress& progress) : soup_(soup), progress_(progress) {
    const std::size_t n = soup.triangles.size();
    boxes_.resize(n);
    order_.resize(n);
    std::iota(order_.begin(), order_.end(), 0);
    for (std::size_t t = 0; t < n; ++t) {
      for (const Index v : soup.triangles[t]) boxes_[t].extend(soup.positions[v]);
    }
    nodes_.reserve(n / 2 + 1);
    if (n > 0) build(0, static_cast<Index>(n));
  }

  std::vector<std::array<Index, 2>> run() {
    for (Index t = 0; t < static_cast<Index>(boxes_.size()); ++t) {
      if (t % 4096 == 0) {
        progress_.checkpoint();
        progress_.at(static_cast<double>(t) / static_cast<double>(boxes_.size()));
      }
      query(t);
    }
    std::sort(found_.begin(), found_.end());
    return std::move(found_);
  }

 private:
  struct Node {
    Box3 box;
    Index begin = 0;
    Index end = 0;
    Index right = no_index;  ///< the left child follows its parent; none in a leaf
  };

  /// Bounding volume hierarchy by halves along the longest side.
  Index build(Index begin, Index end) {
    constexpr Index leaf_size = 4;
    const auto node = static_cast<Index>(nodes_.size());
    nodes_.push_back({{}, begin, end, no_index});
    for (Index i = begin; i < end; ++i) nodes_[node].box.extend(boxes_[order_[i]]);
    if (end - begin <= leaf_size) return node;
    int axis = 0;
    nodes_[node].box.sizes().maxCoeff(&axis);
    const Index middle = begin + (end - begin) / 2;
    const auto centre = [&](Index t) { return boxes_[t].min()[axis] + boxes_[t].max()[axis]; };
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](Index a, Index b) { return std::pair(centre(a), a) < std::pair(centre(b), b); });
    build(begin, middle);
    const Index right = build(middle, end);
    nodes_[node].right = right;
    return node;
  }

  void query(Index t) {
    stack_.assign(1, 0);
    while (!stack_.empty()) {
      const Index index = stack_.back();
      stack_.pop_back();
      const Node& node = nodes_[index];
      if (!node.box.intersects(boxes_[t])) continue;
      if (node.right != no_index) {
        stack_.push_back(node.right);
        stack_.push_back(index + 1);
        continue;
      }
      for (Index i = node.begin; i < node.end; ++i) {
        const Index u = order_[i];
        if (u > t && boxes_[u].intersects(boxes_[t]) && cross(t, u)) found_.push_back({t, u});
      }
    }
  }

  Corners corners(Index t) const {
    const auto& [a, b, c] = soup_.triangles[t];
    return {soup_.positions[a], soup_.positions[b], soup_.positions[c]};
  }

  bool cross(Index s, Index t) const {
    int shared = 0;
    std::array<int, 2> at{};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (soup_.triangles[s][i] != soup_.triangles[t][j]) continue;
        ++shared;
        at = {i, j};
      }
    }
    const Corners p = corners(s);
    const Corners q = corners(t);
    if (shared >= 2) return false;
    if (shared == 1) {
      return pierces(p[(at[0] + 1) % 3], p[(at[0] + 2) % 3], q) || pierces(q[(at[1] + 1) % 3], q[(at[1] + 2) % 3], p);
    }
    for (int i = 0; i < 3; ++i) {
      if (pierces(p[i], p[(i + 1) % 3], q) || pierces(q[i], q[(i + 1) % 3], p)) return true;
    }
    const bool in_plane =
        std::all_of(q.begin(), q.end(), [&](const Vec3& v) { return orientation(p[0], p[1], p[2], v) == 0; });
    return in_plane && overlap_in_plane(p, q);
  }

  const TriangleSoup& soup_;
  Progress& progress_;
  std::vector<Box3> boxes_;
  std::vector<Index> order_;
  std::vector<Node> nodes_;
  std::vector<Index> stack_;
  std::vector<std::array<Index, 2>> found_;
};

}  // namespace

std::vector<std::array<Index, 2>> find_self_intersections(const TriangleSoup& soup, Progress& progress) {
  return IntersectionFinder(soup, progress).run();
}

}  // namespace isopath
