#include "isopath/field/part_bound.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "isopath/field/way_back.h"

namespace isopath {
namespace {

/// A second front is looked for this far out from the centre towards the corner where the first one is oldest: corners
/// themselves may lie on edges.
constexpr double towards_corner = 0.9;

using AtCorners = std::array<double, 3>;

/// Lengths of the ways from the corners of a part that begin as another one does; infinite for what is not convex.
AtCorners ways_like(const ExactFieldData& data, const FacePart& part, const WayBack& way) {
  AtCorners lengths{infinity, infinity, infinity};
  const IntrinsicGeometry& geometry = data.geometry;
  for (int k = 0; k < 3; ++k) {
    const Vec3& corner = part.corner[k];
    if (way.stop == WayBack::Stop::source) {
      lengths[k] = std::sqrt(squared_distance(data.face_sources[way.placed], geometry.in_frame(3 * part.face, corner)));
    } else if (way.stop == WayBack::Stop::vertex) {
      const Triangle& triangle = data.mesh.triangle(part.face);
      const auto i = std::find(triangle.begin(), triangle.end(), way.at) - triangle.begin();
      const Vec2 there = geometry.in_frame(3 * part.face, Vec3::Unit(i));
      lengths[k] = data.distance[way.at] + (there - geometry.in_frame(3 * part.face, corner)).norm();
    } else if (way.stop == WayBack::Stop::edge && way.window->halfedge == way.at) {
      Vec2 p = geometry.in_frame(way.at, corner);
      if (data.mesh.halfedge_of(data.mesh.edge_of(way.at)) != way.at) p = Vec2(geometry.length(way.at) - p.x(), -p.y());
      lengths[k] = way_by(*way.window, p);
    }
  }
  return lengths;
}

}  // namespace

double bound_in_part(const ExactFieldData& data, const FacePart& part, const WayBack& nearest) {
  const AtCorners one = ways_like(data, part, nearest);
  const auto oldest = std::max_element(one.begin(), one.end());
  const Vec3 centre = part.centre();
  const Vec3 beyond = centre + towards_corner * (part.corner[oldest - one.begin()] - centre);
  const AtCorners other = ways_like(data, part, best_way_back(data, part.face, beyond));
  double half_sum = 0;
  for (int k = 0; k < 3; ++k) half_sum = std::max(half_sum, 0.5 * (one[k] + other[k]));
  return std::min({half_sum, *oldest, *std::max_element(other.begin(), other.end())});
}

}  // namespace isopath
