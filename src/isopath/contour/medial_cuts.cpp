#include "isopath/contour/medial_cuts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

#include "isopath/contour/medial_axis.h"
#include "isopath/core/error.h"
#include "isopath/mesh/straight_walk.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

/// Twigs shorter than this times the clearance at their foot end in corners of 60 degrees or more.
constexpr double corner_twig = 2;
/// The clearance of a branch into a corner of angle φ rises by sin(φ/2) per length: 0.3 for 35 degrees.
constexpr double corner_slope = 0.3;
/// Where the clearance falls less than this per length, the foot of a step is reached: its cut is within a thousandth
/// of the shortest, as clearance at a length s beyond a corner is at most √(r² + s²).
constexpr double foot_slope = 0.05;
/// Ends of a cut this near to an inward corner, in lengths of the cut, go to it: a cut beside it leaves a sliver.
constexpr double corner_reach = 0.05;
constexpr double least_corner = 1.1 * std::numbers::pi;
/// Of the way from one point of the axis to the next.
constexpr double beside_node = 1e-3;

/// An arc of the axis with arc length, and the part of it that is not a branch into a corner.
struct Branch {
  const std::vector<BisectorPoint>* points = nullptr;
  std::vector<double> at;
  std::size_t first = 0;
  std::size_t last = 0;  // included; less than `first` where nothing is left

  double clearance(std::size_t i) const { return (*points)[i].clearance; }
};

/// How far from index `i` the clearance rises like in a corner, going by `step` up to `end`.
std::size_t end_of_corner(const Branch& branch, std::size_t i, std::ptrdiff_t step, std::size_t end) {
  while (i != end) {
    std::size_t j = i;
    const double reach = std::max(branch.clearance(i), 1e-3 * branch.at.back());
    while (j != end && std::abs(branch.at[j] - branch.at[i]) < reach) j += static_cast<std::size_t>(step);
    const double run = std::abs(branch.at[j] - branch.at[i]);
    if (branch.clearance(j) - branch.clearance(i) <= corner_slope * run) return i;
    i = j;
  }
  return end;
}

/// The nodes that hang together with the one farthest from the boundary. What does not are twigs from the flat corners
/// of a boundary of many edges, without their feet, along which the two directions of arrival differ too little.
std::vector<char> nodes_of_trunk(const BisectorGraph& graph) {
  std::vector<char> in_trunk(graph.nodes.size(), 0);
  std::vector<Index> open;
  const auto farthest = std::max_element(graph.nodes.begin(), graph.nodes.end(),
                                         [](const auto& a, const auto& b) { return a.clearance < b.clearance; });
  if (farthest != graph.nodes.end()) open.push_back(static_cast<Index>(farthest - graph.nodes.begin()));
  while (!open.empty()) {
    const Index node = open.back();
    open.pop_back();
    if (std::exchange(in_trunk[node], 1) != 0) continue;
    for (const Index arc : graph.nodes[node].arcs) {
      for (const Index next : {graph.arcs[arc].from, graph.arcs[arc].to}) open.push_back(next);
    }
  }
  return in_trunk;
}

std::vector<Branch> branches_of(const TriangleMesh& mesh, const BisectorGraph& graph) {
  const std::vector<char> in_trunk = nodes_of_trunk(graph);
  std::vector<Branch> branches;
  for (const BisectorGraph::Arc& arc : graph.arcs) {
    if (in_trunk[arc.from] == 0) continue;
    Branch branch{&arc.points, {0}, 0, arc.points.size() - 1};
    for (std::size_t i = 1; i < arc.points.size(); ++i) {
      const Vec3 step = position_of(mesh, arc.points[i].point) - position_of(mesh, arc.points[i - 1].point);
      branch.at.push_back(branch.at.back() + step.norm());
    }
    const auto is_leaf = [&](Index node) { return graph.nodes[node].arcs.size() == 1; };
    if (is_leaf(arc.from)) branch.first = end_of_corner(branch, branch.first, 1, branch.last);
    if (is_leaf(arc.to)) branch.last = end_of_corner(branch, branch.last, -1, branch.first);
    branches.push_back(std::move(branch));
  }
  return branches;
}

double angle_at(const TriangleMesh& mesh, Index vertex) {
  double sum = 0;
  for (Index h = mesh.outgoing(vertex); h != no_index; h = mesh.next_outgoing(h)) {
    const Vec3 a = mesh.position(mesh.to(h)) - mesh.position(vertex);
    const Vec3 b = mesh.position(mesh.from(TriangleMesh::prev(h))) - mesh.position(vertex);
    sum += std::atan2(a.cross(b).norm(), a.dot(b));
  }
  return sum;
}

/// The inward corner of the boundary nearest to a point on it, if one lies within `reach`; else the point.
SurfacePoint at_corner_near(const TriangleMesh& mesh, const SurfacePoint& point, double reach) {
  Index best = no_index;
  for (const auto& loop : mesh.boundary_loops()) {
    for (const Index h : loop) {
      const double distance = (mesh.position(mesh.from(h)) - position_of(mesh, point)).norm();
      if (distance > reach || angle_at(mesh, mesh.from(h)) < least_corner) continue;
      best = mesh.from(h);
      reach = distance;
    }
  }
  return best == no_index ? point : point_at_vertex(mesh, best);
}

/// The shortest way between the ends of a line, these brought to the corners they lie beside.
std::vector<SurfacePoint> tightened(const TriangleMesh& mesh, const std::vector<SurfacePoint>& line) {
  double length = 0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    length += (position_of(mesh, line[i]) - position_of(mesh, line[i - 1])).norm();
  }
  const double reach = corner_reach * length;
  SourceSet end;
  end.add_point(at_corner_near(mesh, line.front(), reach));
  const ExactField field = ExactField::compute(mesh, end, {.stop_distance = length + 2 * reach});
  std::vector<SurfacePoint> way = field.shortest_path(at_corner_near(mesh, line.back(), reach));
  return way.size() < 2 ? line : way;
}

/// The two shortest ways to the boundary from between two neighbouring points of the axis, as one line.
std::optional<std::vector<SurfacePoint>> spokes(const ExactField& field, const BisectorPoint& a,
                                                const BisectorPoint& b) {
  const TriangleMesh& mesh = field.mesh();
  const Index face = common_face(mesh, a.point, b.point);
  if (face == no_index) return std::nullopt;
  const Vec3 along = position_of(mesh, b.point) - position_of(mesh, a.point);
  if (!(along.norm() > mesh.tolerance().length)) return std::nullopt;
  // Right beside the first point: at itself, a node maybe, a third way could be as short.
  const SurfacePoint foot{face, (1 - beside_node) * express_in(mesh, a.point, face).barycentric +
                                    beside_node * express_in(mesh, b.point, face).barycentric};
  // A little to either side of the axis only one way is the shortest; the farther off, the surer.
  for (const double off : {1e-3, 1e-4, 1e-5}) {
    std::array<std::vector<SurfacePoint>, 2> way;
    std::array<Vec3, 2> towards;
    for (int side = 0; side < 2; ++side) {
      const double turn = (side == 0 ? 0.5 : -0.5) * std::numbers::pi;
      way[side] = straight_walk(mesh, foot, along, turn, off * a.clearance).points;
      const SurfacePoint start = way[side].back();
      towards[side] = field.nearest(start).towards_source;
      const std::vector<SurfacePoint> rest = field.shortest_path(start);
      if (rest.size() < 2) return std::nullopt;
      way[side].insert(way[side].end(), rest.begin() + 1, rest.end());
    }
    const double apart = std::acos(std::clamp(towards[0].dot(towards[1]), -1.0, 1.0));
    if (apart < 0.5 * std::min(a.angle, b.angle)) continue;
    std::vector<SurfacePoint> line(way[0].rbegin(), way[0].rend());
    line.insert(line.end(), way[1].begin() + 1, way[1].end());
    return tightened(mesh, line);
  }
  return std::nullopt;
}

class CutFinder {
 public:
  CutFinder(const ExactField& field, double threshold) : field_(field), threshold_(threshold) {}

  void look_along(const Branch& branch) {
    for (std::size_t i = branch.first; i < branch.last; ++i) {
      const bool low = branch.clearance(i) < threshold_;
      if (low == (branch.clearance(i + 1) < threshold_)) continue;
      // down the step, towards the narrow side
      const std::ptrdiff_t step = low ? -1 : 1;
      const std::size_t end = low ? branch.first : branch.last;
      std::size_t j = low ? i : i + 1;
      while (j != end) {
        const std::size_t next = j + static_cast<std::size_t>(step);
        const double fall = branch.clearance(j) - branch.clearance(next);
        if (fall <= foot_slope * std::abs(branch.at[next] - branch.at[j])) break;
        j = next;
      }
      cut_near(branch, j);
    }
  }

  std::vector<std::vector<SurfacePoint>> take() { return std::move(lines_); }

 private:
  /// At the chord of the branch nearest to one of its points that has both ways.
  void cut_near(const Branch& branch, std::size_t j) {
    const TriangleMesh& mesh = field_.mesh();
    const Vec3 place = position_of(mesh, (*branch.points)[j].point);
    const double clearance = branch.clearance(j);
    for (const auto& [other, reach] : made_) {
      if ((other - place).norm() < std::max(reach, clearance)) return;  // one cut of a neck is enough
    }
    for (std::size_t off = 0; off < branch.points->size(); ++off) {
      for (const std::size_t i : {j + off, j - off}) {
        if (i < branch.first || i >= branch.last) continue;
        if (std::abs(branch.at[i] - branch.at[j]) > clearance) continue;
        auto line = spokes(field_, (*branch.points)[i], (*branch.points)[i + 1]);
        if (!line) continue;
        lines_.push_back(*std::move(line));
        made_.emplace_back(place, clearance);
        return;
      }
    }
  }

  const ExactField& field_;
  double threshold_;
  std::vector<std::pair<Vec3, double>> made_;
  std::vector<std::vector<SurfacePoint>> lines_;
};

}  // namespace

void MedialCutOptions::validate() const {
  if (unevenness > 1 && std::isfinite(unevenness)) return;
  throw Error(ErrorCode::bad_usage, "the ratio of clearances must be above 1",
              {.element = "unevenness", .value = fmt::format("{}", unevenness)});
}

MedialCuts medial_cuts(const ExactField& field, const MedialCutOptions& options, Progress& progress) {
  options.validate();
  const TriangleMesh& mesh = field.mesh();
  const BisectorGraph axis = pruned(mesh, medial_axis(field, {}, progress), corner_twig);
  const std::vector<Branch> branches = branches_of(mesh, axis);
  MedialCuts cuts;
  double least = infinity;
  for (const Branch& branch : branches) {
    for (std::size_t i = branch.first; i < branch.last + 1 && branch.first < branch.last; ++i) {
      least = std::min(least, branch.clearance(i));
      cuts.greatest_clearance = std::max(cuts.greatest_clearance, branch.clearance(i));
    }
  }
  if (!(least < infinity)) return cuts;
  cuts.least_clearance = least;
  if (cuts.greatest_clearance <= options.unevenness * least) return cuts;
  CutFinder finder(field, std::sqrt(least * cuts.greatest_clearance));
  for (const Branch& branch : branches) {
    progress.checkpoint();
    finder.look_along(branch);
  }
  cuts.lines = finder.take();
  return cuts;
}

}  // namespace isopath
