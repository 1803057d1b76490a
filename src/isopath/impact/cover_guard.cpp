#include "isopath/impact/cover_guard.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "isopath/field/face_part.h"
#include "isopath/impact/near_places.h"
#include "isopath/mesh/surface_point.h"

namespace isopath {
namespace {

/// Centres of small parts of a face within `radius` of some places.
void sample_beside(const TriangleMesh& mesh, Index face, const NearPlaces& near, double radius, double size,
                   std::vector<Vec3>& samples) {
  const FaceCorners corners = corners_of(mesh, face);
  std::vector<FacePart> parts = {FacePart::whole(face)};
  while (!parts.empty()) {
    const FacePart part = parts.back();
    parts.pop_back();
    const Vec3 centre = position_of(mesh, {face, part.centre()});
    const double extent = radius_of(corners, part);
    if (!near.any_near(centre, radius + extent)) continue;
    if (extent > size) {
      halve(corners, part, parts);
    } else {
      samples.push_back(centre);
    }
  }
}

/// Those of all faces, face by face.
std::vector<Vec3> samples_beside(const TriangleMesh& mesh, std::span<const Vec3> places, double radius, double size,
                                 const Progress& progress) {
  const NearPlaces near(places);
  std::vector<std::vector<Vec3>> of_face(static_cast<std::size_t>(mesh.n_faces()));
  tbb::parallel_for(Index{0}, mesh.n_faces(), [&](Index f) {
    if (f % 1024 == 0) progress.checkpoint();
    sample_beside(mesh, f, near, radius, size, of_face[f]);
  });
  std::vector<Vec3> samples;
  for (const std::vector<Vec3>& some : of_face) samples.insert(samples.end(), some.begin(), some.end());
  return samples;
}

using GridCell = std::array<Index, 3>;

GridCell grid_cell(const Vec3& p, double size) {
  return {static_cast<Index>(std::floor(p.x() / size)), static_cast<Index>(std::floor(p.y() / size)),
          static_cast<Index>(std::floor(p.z() / size))};
}

/// Segments in a grid of cells, by all cells that they may pass.
class SegmentGrid {
 public:
  explicit SegmentGrid(double size) : size_(size) {}

  void add(Index segment, const Vec3& a, const Vec3& b) {
    const GridCell low = grid_cell(a.cwiseMin(b), size_);
    const GridCell high = grid_cell(a.cwiseMax(b), size_);
    for (Index x = low[0]; x <= high[0]; ++x) {
      for (Index y = low[1]; y <= high[1]; ++y) {
        for (Index z = low[2]; z <= high[2]; ++z) entries_.emplace_back(GridCell{x, y, z}, segment);
      }
    }
  }
  void sort() { std::sort(entries_.begin(), entries_.end()); }

  /// The segments in the cells around a place, each once.
  std::vector<Index> near(const Vec3& place) const {
    std::vector<Index> found;
    const GridCell at = grid_cell(place, size_);
    for (Index x = at[0] - 1; x <= at[0] + 1; ++x) {
      for (Index y = at[1] - 1; y <= at[1] + 1; ++y) {
        const std::pair<GridCell, Index> first{{x, y, at[2] - 1}, 0};
        const GridCell last{x, y, at[2] + 1};
        for (auto e = std::lower_bound(entries_.begin(), entries_.end(), first);
             e != entries_.end() && e->first <= last; ++e)
          found.push_back(e->second);
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

 private:
  double size_;
  std::vector<std::pair<GridCell, Index>> entries_;
};

double distance_to_chord(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 side = b - a;
  const double t = side.squaredNorm() > 0 ? std::clamp((p - a).dot(side) / side.squaredNorm(), 0.0, 1.0) : 0;
  return (a + t * side - p).norm();
}

}  // namespace

CoverGuard::CoverGuard(const TriangleMesh& mesh, std::vector<Vec3> points, Index movable, std::vector<Segment> segments,
                       const CoverGuardOptions& options, const Progress& progress)
    : points_(std::move(points)),
      segments_(std::move(segments)),
      options_(options),
      segments_of_point_(static_cast<std::size_t>(movable)),
      blocks_near_(segments_.size()) {
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    for (const Index p : {segments_[s].first, segments_[s].second}) {
      if (p < movable) segments_of_point_[p].push_back(static_cast<Index>(s));
    }
  }
  const double far = options_.reach + options_.most_moved;
  const double block_size = 0.4 * options_.reach;
  const double block_radius = 0.5 * std::sqrt(3.0) * block_size;
  SegmentGrid grid(far + block_radius);
  for (std::size_t s = 0; s < segments_.size(); ++s)
    grid.add(static_cast<Index>(s), points_[segments_[s].first], points_[segments_[s].second]);
  grid.sort();

  const std::span<const Vec3> moving(points_.data(), static_cast<std::size_t>(movable));
  std::vector<std::pair<GridCell, Vec3>> places;
  for (const Vec3& place : samples_beside(mesh, moving, far, options_.sample_size, progress))
    places.emplace_back(grid_cell(place, block_size), place);
  // samples come face by face, and keep that order in their cells
  std::stable_sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::size_t> ends;
  for (std::size_t i = 1; i <= places.size(); ++i) {
    if (i == places.size() || places[i].first != places[i - 1].first) ends.push_back(i);
  }
  std::vector<WatchedBlock> watched(ends.size());
  tbb::parallel_for(std::size_t{0}, ends.size(), [&](std::size_t k) {
    if (k % 64 == 0) progress.checkpoint();
    const std::size_t first = k > 0 ? ends[k - 1] : 0;
    const GridCell& cell = places[first].first;
    const Vec3 centre = block_size * (Vec3(cell[0], cell[1], cell[2]) + Vec3::Constant(0.5));
    std::vector<Index>& beside = watched[k].segments = grid.near(centre);
    double least = infinity;
    std::erase_if(beside, [&](Index s) {
      const double d = distance_to(s, centre);
      least = std::min(least, d);
      return d > far + block_radius;
    });
    // a block that one segment holds wherever it moves needs no watch
    if (least + block_radius < options_.reach - options_.most_moved) return;
    for (std::size_t i = first; i < ends[k]; ++i) watch(places[i].second, watched[k]);
  });
  for (WatchedBlock& block : watched) add_block(std::move(block));
}

void CoverGuard::watch(const Vec3& place, WatchedBlock& block) const {
  const double far = options_.reach + options_.most_moved;
  const double safe = options_.reach - options_.most_moved;
  Index& witness = block.last_witness;  // of the place before: often of this one too
  double least = witness == no_index ? infinity : distance_to(witness, place);
  for (const Index s : block.segments) {
    if (least < safe) return;  // it stays in reach wherever points move
    const double d = distance_to(s, place);
    if (d >= least) continue;
    least = d;
    witness = s;
  }
  // what is so far was not covered by points that move
  if (least >= safe && least <= far) block.samples.push_back({place, std::max(options_.reach, least), witness});
}

void CoverGuard::add_block(WatchedBlock block) {
  if (block.samples.empty()) return;
  const auto number = static_cast<Index>(blocks_.size());
  const auto movable = static_cast<Index>(segments_of_point_.size());
  for (const Index s : block.segments) {
    if (segments_[s].first < movable || segments_[s].second < movable) blocks_near_[s].push_back(number);
  }
  const auto first = static_cast<Index>(samples_.size());
  for (Sample& sample : block.samples) {
    sample.block = number;
    samples_.push_back(sample);
  }
  blocks_.push_back({first, static_cast<Index>(samples_.size()), std::move(block.segments)});
}

double CoverGuard::distance_to(Index segment, const Vec3& from) const {
  return distance_to_chord(from, points_[segments_[segment].first], points_[segments_[segment].second]);
}

Index CoverGuard::other_witness(Index sample, Index a, Index b) const {
  const Sample& s = samples_[sample];
  for (const Index segment : blocks_[s.block].segments) {
    if (segment != a && segment != b && distance_to(segment, s.position) <= s.limit) return segment;
  }
  return no_index;
}

bool CoverGuard::try_move(Index point, const Vec3& to) {
  const std::vector<Index>& own = segments_of_point_[point];
  const Index a = own.empty() ? no_index : own.front();
  const Index b = own.empty() ? no_index : own.back();
  const Vec3 from = std::exchange(points_[point], to);
  pending_.clear();
  const auto keeps = [&](Index sample, Index moved) {
    const Sample& s = samples_[sample];
    if (s.witness != moved) return true;
    Index witness = a;
    if (distance_to(a, s.position) > s.limit) {
      witness = distance_to(b, s.position) <= s.limit ? b : other_witness(sample, a, b);
    }
    if (witness != no_index && witness != s.witness) pending_.emplace_back(sample, witness);
    return witness != no_index;
  };
  for (const Index moved : own) {
    for (const Index block : blocks_near_[moved]) {
      for (Index sample = blocks_[block].first; sample < blocks_[block].past; ++sample) {
        if (keeps(sample, moved)) continue;
        points_[point] = from;
        return false;
      }
    }
  }
  for (const auto& [sample, witness] : pending_) samples_[sample].witness = witness;
  return true;
}

}  // namespace isopath
