#include "isopath/impact/two_way.h"

#include <algorithm>

#include "isopath/impact/boundary_rings.h"
#include "isopath/impact/ring_joints.h"

namespace isopath {
namespace {

class JoinedRings {
 public:
  JoinedRings(const std::vector<Ring>& rings, const std::vector<RingJoint>& joints)
      : rings_(rings), joints_(joints), cuts_of_(rings.size()), walked_(rings.size(), 0) {
    for (std::size_t j = 0; j < joints.size(); ++j) {
      for (Index side = 0; side < 2; ++side)
        cuts_of_[joints[j].cuts[side].ring].push_back({static_cast<Index>(j), side});
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
    Index side = 0;
    bool operator==(const CutId&) const = default;
  };
  const RingJoint::Cut& cut(const CutId& id) const { return joints_[id.joint].cuts[id.side]; }

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
      // a cut is left at its low end when it was come to forward
      const bool at_high = !forward;
      cross(curve, next, at_high);
      at = {next.joint, 1 - next.side};
      forward = joints_[next.joint].crosswise ? !at_high : at_high;
    } while (!(at == start && forward));
    return curve;
  }

  CutId neighbour(const CutId& at, bool forward) const {
    const auto& cuts = cuts_of_[cut(at).ring];
    const auto i = static_cast<std::size_t>(std::find(cuts.begin(), cuts.end(), at) - cuts.begin());
    return cuts[(forward ? i + 1 : i + cuts.size() - 1) % cuts.size()];
  }

  /// Appends the rung that starts at one end of a cut.
  void cross(SurfaceCurve& curve, const CutId& from, bool at_high) const {
    const RingJoint& joint = joints_[from.joint];
    // rungs are numbered by their end on the first cut
    const bool high_on_first = from.side == 1 && joint.crosswise ? !at_high : at_high;
    SurfaceCurve rung = joint.rungs[high_on_first ? 1 : 0];
    if (from.side == 1) rung.reverse();
    curve.points.insert(curve.points.end(), rung.points.begin(), rung.points.end());
    curve.positions.insert(curve.positions.end(), rung.positions.begin(), rung.positions.end());
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

}  // namespace isopath
