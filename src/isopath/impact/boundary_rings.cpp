#include "isopath/impact/boundary_rings.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

namespace isopath {
namespace {

/// One end of an open contour, and where on the boundary it lies.
struct End {
  Index contour = no_index;
  bool last = false;  ///< the contour's last point
  Index loop = no_index;
  Index place = 0;   ///< of the half-edge in the loop
  double along = 0;  ///< from the half-edge's start, mm
  Index partner = no_index;
  std::vector<SurfacePoint> way;  ///< the loop's vertices between this end and its partner
};

class EndPairing {
 public:
  EndPairing(const TriangleMesh& mesh, std::span<const Contour> contours)
      : mesh_(mesh), contours_(contours), end_of_(contours.size(), {no_index, no_index}) {
    number_boundary();
    for (Index k = 0; k < static_cast<Index>(contours.size()); ++k) {
      if (contours[k].closed) continue;
      add_end(k, false);
      add_end(k, true);
    }
    pair_ends();
  }

  std::vector<Ring> rings() {
    std::vector<Ring> rings;
    std::vector<char> used(contours_.size(), 0);
    for (Index k = 0; k < static_cast<Index>(contours_.size()); ++k) {
      if (used[k]) continue;
      Ring ring(mesh_, contours_[k].closed ? contours_[k].points : chain_from(k, used));
      if (ring.length() > mesh_.tolerance().length) rings.push_back(std::move(ring));
    }
    return rings;
  }

 private:
  void number_boundary() {
    place_.assign(mesh_.n_halfedges(), {no_index, 0});
    const auto& loops = mesh_.boundary_loops();
    for (std::size_t l = 0; l < loops.size(); ++l) {
      for (std::size_t i = 0; i < loops[l].size(); ++i)
        place_[loops[l][i]] = {static_cast<Index>(l), static_cast<Index>(i)};
    }
  }

  void add_end(Index contour, bool last) {
    const SurfacePoint& point = last ? contours_[contour].points.back() : contours_[contour].points.front();
    const Support support = support_of(mesh_, point);
    Index h = no_index;
    if (support.kind == Support::Kind::vertex) h = mesh_.outgoing(support.index);
    if (support.kind == Support::Kind::edge) h = support.index;
    End end;
    end.contour = contour;
    end.last = last;
    if (h != no_index && place_[h].first != no_index) {
      std::tie(end.loop, end.place) = place_[h];
      end.along = (position_of(mesh_, point) - mesh_.position(mesh_.from(h))).norm();
    }
    end_of_[contour][last ? 1 : 0] = static_cast<Index>(ends_.size());
    ends_.push_back(std::move(end));
  }

  void pair_ends() {
    std::vector<std::vector<Index>> of_loop(mesh_.boundary_loops().size());
    for (Index e = 0; e < static_cast<Index>(ends_.size()); ++e) {
      if (ends_[e].loop != no_index) of_loop[ends_[e].loop].push_back(e);
    }
    for (auto& ends : of_loop) {
      if (ends.empty() || ends.size() % 2 == 1) continue;
      std::sort(ends.begin(), ends.end(), [&](Index a, Index b) {
        return std::tie(ends_[a].place, ends_[a].along) < std::tie(ends_[b].place, ends_[b].along);
      });
      // two ways to take every second stretch of the loop
      std::array<double, 2> length = {0, 0};
      for (std::size_t i = 0; i < ends.size(); ++i) length[i % 2] += way_length(ends[i], ends[(i + 1) % ends.size()]);
      for (std::size_t i = length[1] < length[0] ? 1 : 0; i < ends.size(); i += 2)
        join(ends[i], ends[(i + 1) % ends.size()]);
    }
  }

  std::vector<SurfacePoint> way(Index from, Index to) const {
    const auto& loop = mesh_.boundary_loops()[ends_[from].loop];
    const auto n = static_cast<Index>(loop.size());
    const bool round = std::tie(ends_[to].place, ends_[to].along) < std::tie(ends_[from].place, ends_[from].along);
    const Index steps = ends_[to].place - ends_[from].place + (round ? n : 0);
    std::vector<SurfacePoint> points;
    for (Index i = 1; i <= steps; ++i) points.push_back(point_on_halfedge(loop[(ends_[from].place + i) % n], 0));
    return points;
  }

  SurfacePoint point_of(const End& end) const {
    const auto& points = contours_[end.contour].points;
    return end.last ? points.back() : points.front();
  }

  double way_length(Index from, Index to) const {
    double sum = 0;
    Vec3 here = position_of(mesh_, point_of(ends_[from]));
    for (const SurfacePoint& point : way(from, to)) {
      sum += (position_of(mesh_, point) - here).norm();
      here = position_of(mesh_, point);
    }
    return sum + (position_of(mesh_, point_of(ends_[to])) - here).norm();
  }

  void join(Index from, Index to) {
    ends_[from].partner = to;
    ends_[to].partner = from;
    ends_[from].way = way(from, to);
    ends_[to].way.assign(ends_[from].way.rbegin(), ends_[from].way.rend());
  }

  /// Contour after contour along the partners; back the same way from an end without one.
  std::vector<SurfacePoint> chain_from(Index contour, std::vector<char>& used) {
    const Index start = first_of_chain(contour);
    std::vector<SurfacePoint> chain;
    for (Index e = start;;) {
      const End& in = ends_[e];
      used[in.contour] = 1;
      const auto& points = contours_[in.contour].points;
      if (in.last) {
        chain.insert(chain.end(), points.rbegin(), points.rend());
      } else {
        chain.insert(chain.end(), points.begin(), points.end());
      }
      const End& out = ends_[end_of_[in.contour][in.last ? 0 : 1]];
      if (out.partner == no_index) break;
      chain.insert(chain.end(), out.way.begin(), out.way.end());
      if (out.partner == start) return chain;
      e = out.partner;
    }
    for (std::size_t i = chain.size() - 1; i-- > 1;) chain.push_back(chain[i]);
    return chain;
  }

  /// The end to enter a chain by: one without partner, if the chain has such ends.
  Index first_of_chain(Index contour) const {
    const Index start = end_of_[contour][0];
    Index e = start;
    while (ends_[e].partner != no_index) {
      const End& before = ends_[ends_[e].partner];
      e = end_of_[before.contour][before.last ? 0 : 1];
      if (e == start) break;
    }
    return e;
  }

  const TriangleMesh& mesh_;
  std::span<const Contour> contours_;
  std::vector<std::pair<Index, Index>> place_;  // loop and place in it of every half-edge
  std::vector<std::array<Index, 2>> end_of_;
  std::vector<End> ends_;
};

}  // namespace

std::vector<Ring> rings_of(const TriangleMesh& mesh, std::span<const Contour> contours) {
  return EndPairing(mesh, contours).rings();
}

}  // namespace isopath
