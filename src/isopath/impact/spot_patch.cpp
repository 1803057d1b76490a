#include "isopath/impact/spot_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>

#include "isopath/core/quiet_progress.h"
#include "isopath/field/exact_field.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

/// Distances are known so far beyond the reach, which tells how much is missing.
constexpr double known_over_reach = 1.5;
/// Of distances, in reaches.
constexpr double accuracy_over_reach = 1e-3;

double squared_distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 side = b - a;
  const double t = side.squaredNorm() > 0 ? std::clamp((p - a).dot(side) / side.squaredNorm(), 0.0, 1.0) : 0;
  return (a + t * side - p).squaredNorm();
}

}  // namespace

SpotPatch::SpotPatch(const TriangleMesh& mesh, const OpenSpot& spot, double reach, const Progress& progress)
    : mesh_(mesh), spot_(spot), reach_(reach), progress_(progress) {
  collect_faces();
  Vec3 sum = Vec3::Zero();
  for (const Index face : faces_) sum += mesh_.face_normal(face);
  const Vec3 mean = sum.stableNormalized();
  double least_cosine = 1;
  for (const Index face : faces_) least_cosine = std::min(least_cosine, mean.dot(mesh_.face_normal(face)));
  // over a plane that no face is steeper to, ways above straight lines are no longer than that
  factor_ = least_cosine > 0 ? 1 / least_cosine : infinity;
  if (!nearly_flat()) part_ = sub_mesh(mesh_, faces_);
}

void SpotPatch::collect_faces() {
  const Vec3& top = spot_.cells.front().position;
  double radius = 0;
  for (const SpotCell& cell : spot_.cells) radius = std::max(radius, (cell.position - top).norm());
  radius += reach_;
  faces_ = {spot_.cells.front().at.face};
  std::unordered_set<Index> known(faces_.begin(), faces_.end());
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    for (Index h = 3 * faces_[i]; h < 3 * faces_[i] + 3; ++h) {
      const Index twin = mesh_.twin(h);
      // a way from the spot crosses edges that are as near as that
      if (twin == no_index || squared_distance_to_segment(top, mesh_.position(mesh_.from(h)),
                                                          mesh_.position(mesh_.to(h))) > radius * radius)
        continue;
      const Index next = TriangleMesh::face_of(twin);
      if (known.insert(next).second) faces_.push_back(next);
    }
  }
  std::sort(faces_.begin(), faces_.end());
}

std::vector<double> SpotPatch::straight_distances(const std::vector<Vec3>& way) const {
  std::vector<double> distances;
  for (const SpotCell& cell : spot_.cells) {
    double least = infinity;
    for (std::size_t i = 1; i < way.size(); ++i)
      least = std::min(least, squared_distance_to_segment(cell.position, way[i - 1], way[i]));
    distances.push_back(factor_ * std::sqrt(least));
  }
  return distances;
}

std::vector<double> SpotPatch::distances_from(const SurfaceCurve& way) const {
  if (nearly_flat()) return straight_distances(way.positions);
  const auto number_of = [&](Index face) {
    const auto at = std::lower_bound(faces_.begin(), faces_.end(), face);
    return at != faces_.end() && *at == face ? static_cast<Index>(at - faces_.begin()) : no_index;
  };
  SourceSet source;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Index face = common_face(mesh_, way.points[i - 1], way.points[i]);
    const Index number = face == no_index ? no_index : number_of(face);
    if (number == no_index) continue;
    const std::array<SurfacePoint, 2> step = {
        SurfacePoint{number, express_in(mesh_, way.points[i - 1], face).barycentric},
        SurfacePoint{number, express_in(mesh_, way.points[i], face).barycentric}};
    source.add_polyline(part_.mesh, step, false);
  }
  std::vector<double> distances(spot_.cells.size(), infinity);
  if (source.empty()) return distances;
  QuietProgress quiet(progress_);
  const ExactField field = ExactField::compute(
      part_.mesh, source, {.stop_distance = known_over_reach * reach_, .accuracy = accuracy_over_reach * reach_},
      quiet);
  for (std::size_t k = 0; k < distances.size(); ++k) {
    const SurfacePoint& at = spot_.cells[k].at;
    const Index number = number_of(at.face);
    if (number != no_index) distances[k] = field.value({number, at.barycentric});
  }
  return distances;
}

}  // namespace isopath
