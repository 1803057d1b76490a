#include "isopath/impact/ring_neighbours.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace isopath {
namespace {

std::array<Index, 3> cell_of(const Vec3& place, double size) {
  return {static_cast<Index>(std::floor(place.x() / size)), static_cast<Index>(std::floor(place.y() / size)),
          static_cast<Index>(std::floor(place.z() / size))};
}

double bend_at(const Ring& ring, double arc, double reach) {
  const double r = std::min(reach, 0.25 * ring.length());
  return 1 - (ring.position(arc + r) - ring.position(arc - r)).norm() / (2 * r);
}

}  // namespace

RingSamples::RingSamples(const std::vector<Ring>& rings, double spacing, Progress& progress) {
  for (std::size_t k = 0; k < rings.size(); ++k) {
    progress.checkpoint();
    const double length = rings[k].length();
    const double n = std::max(8.0, std::ceil(4 * length / spacing));
    for (double i = 0; i < n; ++i) {
      const double arc = (i + 0.5) / n * length;
      // the ends of an open curve are to stay its ends
      if (rings[k].open() && std::min(arc, length - arc) < 1.5 * spacing) continue;
      samples_.push_back({static_cast<Index>(k), arc, rings[k].position(arc), bend_at(rings[k], arc, spacing)});
    }
  }
  fine_ = grid_of(spacing);
}

RingSamples::Grid RingSamples::grid_of(double size) const {
  Grid grid;
  grid.size = size;
  grid.entries.reserve(samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i)
    grid.entries.emplace_back(cell_of(samples_[i].position, size), static_cast<Index>(i));
  std::sort(grid.entries.begin(), grid.entries.end());
  return grid;
}

template <class Visit>
void RingSamples::visit_near(const Grid& grid, const Vec3& place, double radius, const Visit& visit) const {
  const Cell low = cell_of(place - Vec3::Constant(radius), grid.size);
  const Cell high = cell_of(place + Vec3::Constant(radius), grid.size);
  for (Index x = low[0]; x <= high[0]; ++x) {
    for (Index y = low[1]; y <= high[1]; ++y) {
      const std::pair<Cell, Index> first{{x, y, low[2]}, 0};
      for (auto e = std::lower_bound(grid.entries.begin(), grid.entries.end(), first);
           e != grid.entries.end() && e->first <= Cell{x, y, high[2]}; ++e) {
        const double d = (samples_[e->second].position - place).norm();
        if (d <= radius) visit(samples_[e->second], d);
      }
    }
  }
}

std::vector<FacingPlace> RingSamples::facing(std::span<const char> ask, std::span<const Index> group, double radius,
                                             Progress& progress) const {
  const Grid wide = radius > 2 * fine_.size ? grid_of(radius) : Grid{};
  const Grid& grid = wide.entries.empty() ? fine_ : wide;
  std::vector<FacingPlace> places;
  std::vector<std::tuple<Index, double, const RingSample*>> near;  // ring, distance
  for (const RingSample& from : samples_) {
    if (!ask[from.ring]) continue;
    progress.checkpoint();
    near.clear();
    visit_near(grid, from.position, radius, [&](const RingSample& to, double d) {
      if (to.ring != from.ring && group[to.ring] == group[from.ring]) near.emplace_back(to.ring, d, &to);
    });
    std::sort(near.begin(), near.end());
    Index last = no_index;
    for (const auto& [ring, d, to] : near) {
      if (ring == std::exchange(last, ring)) continue;
      places.push_back({{from.ring, ring}, {from.arc, to->arc}, d, std::max(from.bend, to->bend)});
    }
  }
  return places;
}

bool RingSamples::other_ring_near(const Vec3& place, double radius, Index a, Index b) const {
  bool found = false;
  visit_near(fine_, place, radius,
             [&](const RingSample& sample, double) { found = found || (sample.ring != a && sample.ring != b); });
  return found;
}

}  // namespace isopath
