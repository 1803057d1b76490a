#include "isopath/impact/two_way.h"

#include <algorithm>
#include <utility>

#include "isopath/impact/boundary_rings.h"
#include "isopath/impact/ring_joints.h"

namespace isopath {
namespace {

class JoinedRings {
 public:
  JoinedRings(const std::vector<Ring>& rings, const std::vector<RingJoint>& joints)
      : rings_(rings), joints_(joints), cuts_of_(rings.size()), walked_(rings.size(), 0) {
    for (std::size_t j = 0; j < joints.size(); ++j) {
      for (std::size_t c = 0; c < joints[j].cuts.size(); ++c)
        cuts_of_[joints[j].cuts[c].ring].push_back({static_cast<Index>(j), static_cast<Index>(c)});
    }
    for (auto& cuts : cuts_of_) {
      std::sort(cuts.begin(), cuts.end(), [&](const CutId& a, const CutId& b) { return cut(a).low < cut(b).low; });
    }
  }

  std::vector<SurfaceCurve> walk_all() {
    std::vector<SurfaceCurve> curves;
    for (Index k = 0; k < static_cast<Index>(rings_.size()); ++k) {
      if (!walked_[k]) curves.push_back(cuts_of_[k].empty() ? whole(k) : walk(cuts_of_[k].front()));
    }
    return curves;
  }

 private:
  struct CutId {
    Index joint = no_index;
    Index cut = 0;
    bool operator==(const CutId&) const = default;
  };
  const RingJoint::Cut& cut(const CutId& id) const { return joints_[id.joint].cuts[id.cut]; }

  SurfaceCurve whole(Index ring) {
    walked_[ring] = 1;
    SurfaceCurve curve;
    rings_[ring].append_forward(curve, 0, 0);
    return curve;
  }

  /// From the high end of a cut round until it is come to again.
  SurfaceCurve walk(const CutId& start) {
    SurfaceCurve curve;
    CutId at = start;
    bool forward = true;
    do {
      const Index ring = cut(at).ring;
      walked_[ring] = 1;
      const CutId next = neighbour(at, forward);
      if (forward) {
        rings_[ring].append_forward(curve, cut(at).high, cut(next).low);
      } else {
        rings_[ring].append_backward(curve, cut(at).low, cut(next).high);
      }
      // a cut is left at its low end when it was come to forward, and forward from its high end
      const RingJoint::End end = cross(curve, next, !forward);
      at = {next.joint, end.cut};
      forward = end.high;
    } while (!(at == start && forward));
    return curve;
  }

  CutId neighbour(const CutId& at, bool forward) const {
    const auto& cuts = cuts_of_[cut(at).ring];
    const auto i = static_cast<std::size_t>(std::find(cuts.begin(), cuts.end(), at) - cuts.begin());
    return cuts[(forward ? i + 1 : i + cuts.size() - 1) % cuts.size()];
  }

  /// Appends the rung that starts at one end of a cut; returns the end it leads to.
  RingJoint::End cross(SurfaceCurve& curve, const CutId& from, bool high) const {
    const RingJoint::End start{from.cut, high};
    const auto& rungs = joints_[from.joint].rungs;
    const auto found = std::find_if(rungs.begin(), rungs.end(),
                                    [&](const RingJoint::Rung& r) { return r.from == start || r.to == start; });
    SurfaceCurve way = found->curve;
    const bool back = found->to == start;
    if (back) way.reverse();
    curve.points.insert(curve.points.end(), way.points.begin(), way.points.end());
    curve.positions.insert(curve.positions.end(), way.positions.begin(), way.positions.end());
    return back ? found->from : found->to;
  }

  const std::vector<Ring>& rings_;
  const std::vector<RingJoint>& joints_;
  std::vector<std::vector<CutId>> cuts_of_;  // of every ring, in the order of arcs
  std::vector<char> walked_;
};

}  // namespace

std::vector<SurfaceCurve> two_way(const SurfaceLinker& linker, std::span<const Contour> contours, double spacing,
                                  Progress& progress) {
  const std::vector<Ring> rings = rings_of(linker.mesh(), contours);
  const std::vector<RingJoint> joints = choose_joints(linker, rings, spacing, progress);
  return JoinedRings(rings, joints).walk_all();
}

std::vector<SurfaceCurve> joined_to_curve(const SurfaceLinker& linker, const SurfaceCurve& curve,
                                          std::span<const Contour> contours, double spacing, Progress& progress) {
  std::vector<Ring> rings;
  rings.emplace_back(linker.mesh(), curve.points, true);
  for (Ring& ring : rings_of(linker.mesh(), contours)) rings.push_back(std::move(ring));
  const std::vector<RingJoint> joints = choose_joints(linker, rings, spacing, progress);
  std::vector<SurfaceCurve> joined = JoinedRings(rings, joints).walk_all();
  const bool has_joint = std::any_of(joints.begin(), joints.end(), [](const RingJoint& joint) {
    return std::any_of(joint.cuts.begin(), joint.cuts.end(), [](const RingJoint::Cut& cut) { return cut.ring == 0; });
  });
  // the first one holds the curve, and begins anywhere on it
  SurfaceCurve& whole = joined.front();
  if (!has_joint) whole = curve;
  const auto is_at = [&](std::size_t i, const Vec3& place) { return whole.positions[i] == place; };
  for (std::size_t i = 0; i + 1 < whole.size(); ++i) {
    if (!is_at(i, curve.positions.back()) || !is_at(i + 1, curve.positions.front())) continue;
    SurfaceCurve turned;
    const auto take = [&](std::size_t from, std::size_t to) {
      const auto at = [](auto& values, std::size_t k) { return values.begin() + static_cast<std::ptrdiff_t>(k); };
      turned.points.insert(turned.points.end(), at(whole.points, from), at(whole.points, to));
      turned.positions.insert(turned.positions.end(), at(whole.positions, from), at(whole.positions, to));
    };
    take(i + 1, whole.size() - 1);
    take(0, i + 1);
    whole = std::move(turned);
    break;
  }
  return joined;
}

}  // namespace isopath
