#include "isopath/impact/open_spots.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
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

class SpotSearch {
 public:
  SpotSearch(const ExactField& field, double limit, double resolution, const OpenSpotsNear& near)
      : field_(field), mesh_(field.mesh()), limit_(limit), resolution_(resolution), near_(near) {}

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
    while (!parts.empty()) {
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
};

using GridCell = std::array<Index, 3>;

void put_top_first(OpenSpot& spot) {
  const auto top = std::max_element(spot.cells.begin(), spot.cells.end(),
                                    [](const SpotCell& a, const SpotCell& b) { return a.distance < b.distance; });
  std::iter_swap(spot.cells.begin(), top);
}

/// Cells whose parts may touch belong to one spot.
std::vector<OpenSpot> group(const TriangleMesh& mesh, std::vector<SpotCell> cells) {
  double size = 0;
  for (const SpotCell& cell : cells) size = std::max(size, 2 * reach_of_neighbours * cell.radius);
  const auto grid_cell = [&](const Vec3& p) {
    return GridCell{static_cast<Index>(std::floor(p.x() / size)), static_cast<Index>(std::floor(p.y() / size)),
                    static_cast<Index>(std::floor(p.z() / size))};
  };
  std::vector<std::pair<GridCell, Index>> grid;
  for (std::size_t i = 0; i < cells.size(); ++i) grid.emplace_back(grid_cell(cells[i].position), static_cast<Index>(i));
  std::sort(grid.begin(), grid.end());
  DisjointSets sets(cells.size());
  for (const auto& [at, i] : grid) {
    for (Index x = at[0] - 1; x <= at[0] + 1; ++x) {
      for (Index y = at[1] - 1; y <= at[1] + 1; ++y) {
        const std::pair<GridCell, Index> first{{x, y, at[2] - 1}, 0};
        for (auto e = std::lower_bound(grid.begin(), grid.end(), first);
             e != grid.end() && e->first <= GridCell{x, y, at[2] + 1}; ++e) {
          if (e->second <= i) continue;  // each two once
          const SpotCell& a = cells[i];
          const SpotCell& b = cells[e->second];
          const double reach = reach_of_neighbours * (a.radius + b.radius);
          if ((a.position - b.position).squaredNorm() > reach * reach) continue;
          // not from one side of a thin wall to the other
          if (a.at.face == b.at.face || mesh.face_normal(a.at.face).dot(mesh.face_normal(b.at.face)) > 0)
            sets.join(i, e->second);
        }
      }
    }
  }
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
  const SpotSearch spot_search(field, limit, resolution, near);
  std::vector<std::vector<SpotCell>> found((n + chunk - 1) / chunk);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t k) {
    const auto first = static_cast<Index>(k) * chunk;
    for (Index f = first; f < std::min(n, first + chunk); ++f) {
      progress.checkpoint();
      spot_search.search(f, found[k]);
    }
  });
  std::vector<SpotCell> cells;
  for (const auto& part : found) cells.insert(cells.end(), part.begin(), part.end());
  return group(field.mesh(), std::move(cells));
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
