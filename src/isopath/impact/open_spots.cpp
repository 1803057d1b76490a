#include "isopath/impact/open_spots.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "isopath/field/exact_field_data.h"
#include "isopath/field/face_part.h"
#include "isopath/field/part_bound.h"
#include "isopath/mesh/disjoint_sets.h"

namespace isopath {
namespace {

/// Cells may be larger where they are all open, by so much of what they are beyond the limit, but no larger than this.
constexpr double largest_cell_over_excess = 0.5;
constexpr double largest_cell_over_resolution = 10;
/// In parts larger than this, beside the limit, more than two passes are to be reckoned with.
constexpr double largest_bounded = 0.5;
/// Parts smaller than this, beside the resolution, are soon done with anyway.
constexpr double smallest_bounded = 3;
/// Centres of neighbouring cells are at most this many of their radii apart, together.
constexpr double reach_of_neighbours = 1.6;
/// A large face may have millions of parts.
constexpr int parts_between_checkpoints = 256;

class SpotSearch {
 public:
  SpotSearch(const ExactField& field, double limit, double resolution, const OpenSpotsNear& near,
             const Progress& progress)
      : field_(field), mesh_(field.mesh()), limit_(limit), resolution_(resolution), near_(near), progress_(progress) {}

  /// What may be farther than the limit is halved until it is small, or certainly farther and small enough.
  void search(Index face, std::vector<SpotCell>& cells) const {
    const IntrinsicGeometry& geometry = field_.geometry();
    const Vec2 apex = geometry.apex(3 * face);
    const FaceCorners corners = {Vec3::Zero(), Vec3(geometry.length(3 * face), 0, 0), Vec3(apex.x(), apex.y(), 0)};
    const FaceCorners in_space = corners_of(mesh_, face);
    std::vector<FacePart> parts{FacePart::whole(face)};
    const bool is_large = near_.places && radius_of(in_space, parts[0]) > near_.radius;
    for (const Index v : mesh_.triangle(face)) {
      if (!is_large && !std::isfinite(field_.value_at_vertex(v))) return;
    }
    for (int n = 0; !parts.empty(); ++n) {
      if (n % parts_between_checkpoints == 0) progress_.checkpoint();
      const FacePart part = parts.back();
      parts.pop_back();
      const SurfacePoint centre{face, part.centre()};
      const Vec3 position = position_of(mesh_, centre);
      const double size = near_.places ? radius_of(in_space, part) : 0;
      if (near_.places && !near_.places->any_near(position, near_.radius + size)) continue;
      const double radius = radius_of(corners, part);
      if (near_.places && size > near_.radius) {
        halve(corners, part, parts);
        continue;
      }
      const WayBack way = best_way_back(field_.data(), face, centre.barycentric);
      const double distance = way.distance;
      if (!std::isfinite(distance)) continue;
      if (distance + radius <= limit_) continue;
      if (distance <= limit_ && may_be_bounded(part, radius) && bound_in_part(field_.data(), part, way) <= limit_)
        continue;
      if (radius > largest_cell(distance - radius - limit_)) {
        halve(corners, part, parts);
      } else if (distance > limit_) {
        cells.push_back({centre, position, distance, radius});
      }
    }
  }

 private:
  double largest_cell(double least_excess) const {
    return std::clamp(largest_cell_over_excess * least_excess, resolution_, largest_cell_over_resolution * resolution_);
  }
  /// Whether a bound is worth its cost, about that of looking at two parts; each second time is enough.
  bool may_be_bounded(const FacePart& part, double radius) const {
    return part.depth % 2 == 0 && radius <= largest_bounded * limit_ && radius >= smallest_bounded * resolution_;
  }

  const ExactField& field_;
  const TriangleMesh& mesh_;
  double limit_;
  double resolution_;
  const OpenSpotsNear& near_;
  const Progress& progress_;
};

void put_top_first(OpenSpot& spot) {
  const auto top = std::max_element(spot.cells.begin(), spot.cells.end(),
                                    [](const SpotCell& a, const SpotCell& b) { return a.distance < b.distance; });
  std::iter_swap(spot.cells.begin(), top);
}

/// Finds spot cells by place. Cells of about one size share a grid, so that a place has few of them near it.
class SpotGrid {
 public:
  /// Of the cells whose radius is at most `largest`.
  SpotGrid(const std::vector<SpotCell>& cells, std::vector<Index> members, double largest)
      : cells_(cells), size_(2 * reach_of_neighbours * largest) {
    Box3 box;
    for (const Index i : members) box.extend(cells[i].position);
    corner_ = box.min();  // counted from here, numbers stay small wherever the part lies
    for (const Index i : members) entries_.emplace_back(place_of(cells[i].position), i);
    std::sort(entries_.begin(), entries_.end());
  }

  /// Calls visit(other) for the members that may touch a cell no larger than they are, and for others near it.
  template <class Visit>
  void for_near(Index cell, const Visit& visit) const {
    const GridPlace at = place_of(cells_[cell].position);
    for (std::int64_t x = at[0] - 1; x <= at[0] + 1; ++x) {
      for (std::int64_t y = at[1] - 1; y <= at[1] + 1; ++y) {
        const std::pair<GridPlace, Index> first{{x, y, at[2] - 1}, 0};
        for (auto e = std::lower_bound(entries_.begin(), entries_.end(), first);
             e != entries_.end() && e->first <= GridPlace{x, y, at[2] + 1}; ++e) {
          visit(e->second);
        }
      }
    }
  }

 private:
  using GridPlace = std::array<std::int64_t, 3>;
  GridPlace place_of(const Vec3& position) const {
    GridPlace place;
    for (int k = 0; k < 3; ++k) place[k] = static_cast<std::int64_t>(std::floor((position[k] - corner_[k]) / size_));
    return place;
  }

  const std::vector<SpotCell>& cells_;
  double size_;
  Vec3 corner_;
  std::vector<std::pair<GridPlace, Index>> entries_;
};

bool may_touch(const TriangleMesh& mesh, const SpotCell& a, const SpotCell& b) {
  const double reach = reach_of_neighbours * (a.radius + b.radius);
  if ((a.position - b.position).squaredNorm() > reach * reach) return false;
  // not from one side of a thin wall to the other
  return a.at.face == b.at.face || mesh.face_normal(a.at.face).dot(mesh.face_normal(b.at.face)) > 0;
}

/// Joins cells whose parts may touch: each with those about as large, and with all larger ones.
DisjointSets connected(const TriangleMesh& mesh, const std::vector<SpotCell>& cells, const Progress& progress) {
  DisjointSets sets(cells.size());
  double largest = 0;
  for (const SpotCell& cell : cells) largest = std::max(largest, cell.radius);
  std::vector<Index> left(cells.size());
  std::iota(left.begin(), left.end(), 0);
  const double least = largest / 64;  // few if any are smaller
  for (; !left.empty(); largest /= 2) {
    const auto smaller = std::partition(left.begin(), left.end(),
                                        [&](Index i) { return 2 * cells[i].radius > largest || largest <= least; });
    const SpotGrid grid(cells, {left.begin(), smaller}, largest);
    for (std::size_t k = 0; k < left.size(); ++k) {
      if (k % 1024 == 0) progress.checkpoint();
      const Index i = left[k];
      const bool is_member = k < static_cast<std::size_t>(smaller - left.begin());
      grid.for_near(i, [&](Index other) {
        if (is_member && other <= i) return;  // each two once
        if (sets.root(i) != sets.root(other) && may_touch(mesh, cells[i], cells[other])) sets.join(i, other);
      });
    }
    left.erase(left.begin(), smaller);
  }
  return sets;
}

/// Cells whose parts may touch belong to one spot.
std::vector<OpenSpot> group(const TriangleMesh& mesh, std::vector<SpotCell> cells, const Progress& progress) {
  DisjointSets sets = connected(mesh, cells, progress);
  std::vector<OpenSpot> spots;
  std::vector<Index> number(cells.size(), no_index);
  for (Index i = 0; i < static_cast<Index>(cells.size()); ++i) {
    Index& k = number[sets.root(i)];
    if (k == no_index) {
      k = static_cast<Index>(spots.size());
      spots.emplace_back();
    }
    spots[k].cells.push_back(std::move(cells[i]));
  }
  for (OpenSpot& spot : spots) put_top_first(spot);
  return spots;
}

}  // namespace

std::vector<OpenSpot> open_spots(const ExactField& field, double limit, double resolution, const Progress& progress,
                                 const OpenSpotsNear& near) {
  const Index n = field.mesh().n_faces();
  constexpr Index chunk = 4;  // a large face may take as long as thousands of small ones
  const SpotSearch spot_search(field, limit, resolution, near, progress);
  std::vector<std::vector<SpotCell>> found((n + chunk - 1) / chunk);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t k) {
    const auto first = static_cast<Index>(k) * chunk;
    for (Index f = first; f < std::min(n, first + chunk); ++f) {
      spot_search.search(f, found[k]);
    }
  });
  std::vector<SpotCell> cells;
  for (const auto& part : found) cells.insert(cells.end(), part.begin(), part.end());
  return group(field.mesh(), std::move(cells), progress);
}

std::vector<OpenSpot> halves_of(const OpenSpot& spot, double smallest) {
  Box3 box;
  for (const SpotCell& cell : spot.cells) box.extend(cell.position);
  int axis = 0;
  if (!(box.sizes().maxCoeff(&axis) > smallest)) return {};
  const double middle = box.center()[axis];
  std::vector<OpenSpot> halves(2);
  for (const SpotCell& cell : spot.cells) halves[cell.position[axis] < middle ? 0 : 1].cells.push_back(cell);
  for (OpenSpot& half : halves) put_top_first(half);
  return halves;
}

}  // namespace isopath
