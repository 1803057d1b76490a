#include "isopath/field/intrinsic_delaunay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "isopath/field/triangle_layout.h"

namespace isopath {
namespace {

constexpr double least_height = 1e-6;
/// Sums of cotangents this close to zero, relative to the larger one or to 1, are zero: both diagonals of a square are
/// fine.
constexpr double rounding = 1e-10;
constexpr int most_divisions = 10;

Index next(Index h) { return TriangleMesh::next(h); }
Index prev(Index h) { return TriangleMesh::prev(h); }

class Builder {
 public:
  Builder(const TriangleMesh& mesh, const IntrinsicGeometry& geometry, const Progress& progress) : progress_(progress) {
    t_.n_vertices = mesh.n_vertices();
    for (Index h = 0; h < mesh.n_halfedges(); ++h) {
      t_.tail.push_back(mesh.from(h));
      t_.twin.push_back(mesh.twin(h));
      t_.length.push_back(geometry.length(h));
    }
  }

  IntrinsicTriangulation run() {
    waiting_.resize(t_.tail.size(), 1);
    for (Index h = t_.n_halfedges(); h-- > 0;) open_.push_back(h);
    for (int division = 0;; ++division) {
      flip_all();
      if (division == most_divisions || !divide_boundary()) break;
    }
    return std::move(t_);
  }

 private:
  bool is_delaunay(Index h) const {
    const double a = t_.cotangent(h);
    const double b = t_.cotangent(t_.twin[h]);
    return a + b >= -rounding * std::max({1.0, std::abs(a), std::abs(b)});
  }

  void enqueue(Index h) {
    if (waiting_[h]) return;
    waiting_[h] = 1;
    open_.push_back(h);
  }

  /// In exact numbers flips come to an end, as each lowers the Dirichlet energy of every function (Rippa 1990); the
  /// limit only ends cycles that rounding may cause between triangles without area.
  void flip_all() {
    std::size_t left = 100 * t_.tail.size();
    for (std::size_t asked = 0; !open_.empty() && left > 0; ++asked) {
      if (asked % 1024 == 0) progress_.checkpoint();
      const Index h = open_.back();
      open_.pop_back();
      waiting_[h] = 0;
      if (t_.twin[h] == no_index || is_delaunay(h) || !flip(h)) continue;
      --left;
    }
  }

  /// Puts the other diagonal of the quadrangle around h in its place. False where that one does not lie inside it.
  bool flip(Index h) {
    const Index t = t_.twin[h];
    if (h / 3 == t / 3) return false;
    const Vec2 k = t_.apex(h);
    const Vec2 l_from_t = t_.apex(t);
    const Vec2 l(t_.length[h] - l_from_t.x(), -l_from_t.y());
    const double height = k.y() - l.y();
    const double crossing = height > 0 ? (k.x() * -l.y() + l.x() * k.y()) / height : -1;
    if (!(crossing > 0 && crossing < t_.length[h])) return false;

    struct Side {
      Index tail, twin, old_slot;
      double length;
    };
    const auto side = [&](Index s) { return Side{t_.tail[s], t_.twin[s], s, t_.length[s]}; };
    const std::array<Side, 4> sides = {side(prev(h)), side(next(t)), side(prev(t)), side(next(h))};
    const std::array<Index, 4> slots = {next(h), prev(h), next(t), prev(t)};
    for (int i = 0; i < 4; ++i) {
      t_.tail[slots[i]] = sides[i].tail;
      t_.length[slots[i]] = sides[i].length;
      Index twin = sides[i].twin;
      for (int j = 0; j < 4; ++j) {
        if (sides[i].twin == sides[j].old_slot) twin = slots[j];  // the quadrangle is glued to itself
      }
      t_.twin[slots[i]] = twin;
      if (twin != no_index) t_.twin[twin] = slots[i];
    }
    t_.tail[h] = sides[2].tail;
    t_.tail[t] = sides[0].tail;
    t_.length[h] = t_.length[t] = (k - l).norm();
    for (const Index s : slots) enqueue(s);
    return true;
  }

  bool divide_boundary() {
    bool divided = false;
    const Index n = t_.n_halfedges();
    for (Index h = 0; h < n; ++h) {
      if (t_.twin[h] != no_index || !(t_.cotangent(h) < -rounding)) continue;
      const Vec2 apex = t_.apex(h);
      if (!(apex.x() > 0 && apex.x() < t_.length[h])) continue;
      divide(h, apex);
      divided = true;
    }
    return divided;
  }

  /// The face (i, j, k) of the boundary half-edge h from i to j becomes (i, p, k) and (p, j, k).
  void divide(Index h, const Vec2& apex) {
    const Index p = t_.n_vertices++;
    const Index first = t_.n_halfedges();
    const Index to_k = next(h);
    t_.added.push_back({t_.tail[h], t_.tail[to_k], apex.x() / t_.length[h]});
    const double height = std::max(apex.y(), least_height * t_.length[h]);
    const auto add = [&](Index tail, Index twin, double length) {
      t_.tail.push_back(tail);
      t_.twin.push_back(twin);
      t_.length.push_back(length);
      waiting_.push_back(0);
    };
    add(p, no_index, t_.length[h] - apex.x());
    add(t_.tail[to_k], t_.twin[to_k], t_.length[to_k]);
    add(t_.tail[prev(h)], to_k, height);
    if (t_.twin[to_k] != no_index) t_.twin[t_.twin[to_k]] = first + 1;
    t_.length[h] = apex.x();
    t_.tail[to_k] = p;
    t_.twin[to_k] = first + 2;
    t_.length[to_k] = height;
    for (const Index s : {to_k, prev(h), first + 1}) enqueue(s);
  }

  const Progress& progress_;
  IntrinsicTriangulation t_;
  std::vector<Index> open_;
  std::vector<char> waiting_;
};

}  // namespace

Vec2 IntrinsicTriangulation::apex(Index halfedge) const {
  return apex_of(length[halfedge], length[next(halfedge)], length[prev(halfedge)]);
}

double IntrinsicTriangulation::cotangent(Index halfedge) const {
  const double base = length[halfedge];
  const Vec2 tip = apex(halfedge);
  const double longest = std::max({base, length[next(halfedge)], length[prev(halfedge)]});
  const double twice_area = std::max(base * tip.y(), least_height * longest * longest);
  return (tip.y() * tip.y() - tip.x() * (base - tip.x())) / twice_area;
}

IntrinsicTriangulation intrinsic_delaunay(const TriangleMesh& mesh, const IntrinsicGeometry& geometry,
                                          const Progress& progress) {
  return Builder(mesh, geometry, progress).run();
}

}  // namespace isopath
