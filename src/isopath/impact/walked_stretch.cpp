#include "isopath/impact/walked_stretch.h"

#include <algorithm>
#include <cmath>

#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

SurfacePoint on_chord(const TriangleMesh& mesh, const SurfacePoint& a, const SurfacePoint& b, double t) {
  const Index face = common_face(mesh, a, b);
  if (face == no_index) return t < 0.5 ? a : b;
  return {face, (1 - t) * express_in(mesh, a, face).barycentric + t * express_in(mesh, b, face).barycentric};
}

/// A vector in the tangent plane, of the length it has in space: so a straight way over an edge stays straight.
Vec3 laid_flat(const Vec3& v, const Vec3& normal) {
  const Vec3 flat = v - normal.dot(v) * normal;
  const double length = flat.norm();
  return length > 1e-9 * v.norm() ? Vec3(v.norm() / length * flat) : Vec3(Vec3::Zero());
}

bool may_skip(const TriangleMesh& mesh, const std::vector<CurveNode>& nodes, std::size_t from, std::size_t to,
              double tolerance) {
  const Vec3& a = nodes[from].position;
  const Vec3 chord = nodes[to].position - a;
  if (nodes[to].kind != nodes[from + 1].kind || common_face(mesh, nodes[from].at, nodes[to].at) == no_index)
    return false;
  for (std::size_t i = from + 1; i < to; ++i) {
    const Vec3 way = nodes[i].position - a;
    const double t = chord.squaredNorm() > 0 ? std::clamp(way.dot(chord) / chord.squaredNorm(), 0.0, 1.0) : 0;
    if ((way - t * chord).norm() > tolerance) return false;
  }
  return true;
}

}  // namespace

WalkedStretch::WalkedStretch(const TriangleMesh& mesh, std::vector<CurveNode> nodes)
    : mesh_(mesh), nodes_(std::move(nodes)) {
  arc_.push_back(0);
  for (std::size_t i = 1; i < nodes_.size(); ++i)
    arc_.push_back(arc_.back() + (nodes_[i].position - nodes_[i - 1].position).norm());
}

std::size_t WalkedStretch::behind(double arc) const {
  const auto above = std::upper_bound(arc_.begin(), arc_.end(), arc);
  return std::min(static_cast<std::size_t>(above - arc_.begin()), arc_.size() - 1);
}

CurveNode WalkedStretch::at(double arc) const {
  const std::size_t i = std::max<std::size_t>(behind(arc), 1);
  const double step = arc_[i] - arc_[i - 1];
  const double t = step > 0 ? std::clamp((arc - arc_[i - 1]) / step, 0.0, 1.0) : 1;
  if (t == 1) return nodes_[i];
  if (t == 0) return {nodes_[i - 1].at, nodes_[i - 1].position, nodes_[i].kind};
  const SurfacePoint point = on_chord(mesh_, nodes_[i - 1].at, nodes_[i].at, t);
  return {point, position_of(mesh_, point), nodes_[i].kind};
}

std::vector<CurveNode> WalkedStretch::part(double from, double to) const {
  std::vector<CurveNode> nodes = {at(from)};
  for (std::size_t i = behind(from); i < size() && arc(i) < to; ++i) nodes.push_back(node(i));
  nodes.push_back(at(to));
  return nodes;
}

std::vector<CurveNode> WalkedStretch::sampled(double step) const {
  const int n = std::max(6, static_cast<int>(std::ceil(length() / step)));
  std::vector<CurveNode> band;
  for (int i = 0; i <= n; ++i) band.push_back(at(length() * i / n));
  return band;
}

double Turn::radius() const { return angle > 0 ? step / (2 * std::sin(0.5 * angle)) : infinity; }

Turn turn_at(const TriangleMesh& mesh, const CurveNode& a, const CurveNode& b, const CurveNode& c) {
  const Vec3 sum = mesh.face_normal(a.at.face) + mesh.face_normal(b.at.face) + mesh.face_normal(c.at.face);
  const Vec3 normal = sum.norm() > 1e-6 ? Vec3(sum.normalized()) : mesh.face_normal(b.at.face);
  Turn turn;
  turn.before = laid_flat(b.position - a.position, normal);
  turn.behind = laid_flat(c.position - b.position, normal);
  turn.step = 0.5 * (turn.before.norm() + turn.behind.norm());
  turn.angle = std::atan2(turn.before.cross(turn.behind).norm(), turn.before.dot(turn.behind));
  return turn;
}

std::vector<CurveNode> joined(const SurfaceLinker& linker, const std::vector<CurveNode>& band) {
  std::vector<CurveNode> nodes = {band.front()};
  for (std::size_t i = 1; i < band.size(); ++i) {
    SurfaceCurve way;
    way.add(linker.mesh(), nodes.back().at);
    linker.extend(way, band[i].at);
    for (std::size_t k = 1; k < way.size(); ++k) nodes.push_back({way.points[k], way.positions[k], band[i].kind});
  }
  return nodes;
}

std::vector<CurveNode> thinned(const TriangleMesh& mesh, const std::vector<CurveNode>& nodes, double tolerance) {
  std::vector<CurveNode> kept = {nodes.front()};
  for (std::size_t i = 0; i + 1 < nodes.size();) {
    std::size_t next = i + 1;
    while (next + 1 < nodes.size() && may_skip(mesh, nodes, i, next + 1, tolerance)) ++next;
    kept.push_back(nodes[next]);
    i = next;
  }
  return kept;
}

std::vector<std::pair<std::size_t, std::size_t>> runs_on_surface(const ImpactCurve& curve) {
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  for (std::size_t i = 0; i < curve.points.size();) {
    if (!curve.points[i].at.valid()) {
      ++i;
      continue;
    }
    std::size_t end = i + 1;
    while (end < curve.points.size() && curve.points[end].kind != MoveKind::lift) ++end;
    runs.emplace_back(i, end);
    i = end;
  }
  return runs;
}

std::vector<CurveNode> nodes_of(const ImpactCurve& curve, std::size_t first, std::size_t end) {
  std::vector<CurveNode> nodes;
  for (std::size_t i = first; i < end; ++i) {
    const ImpactPoint& p = curve.points[i];
    if (!nodes.empty() && p.position == nodes.back().position && i + 1 < end) continue;
    nodes.push_back({p.at, p.position, p.kind});
  }
  return nodes;
}

void replace_runs(const SmoothNormals& normals, ImpactCurve& curve, const std::vector<std::vector<CurveNode>>& runs) {
  ImpactCurve whole;
  std::size_t next = 0;
  std::size_t run = 0;
  for (const auto& [first, end] : runs_on_surface(curve)) {
    whole.points.insert(whole.points.end(), curve.points.begin() + next, curve.points.begin() + first);
    next = end;
    const ImpactPoint start = curve.points[first];
    const std::vector<CurveNode>& nodes = runs[run++];
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (i == 0) {
        whole.points.push_back(start);
      } else if (nodes[i].position != nodes[i - 1].position || i + 1 == nodes.size()) {
        whole.points.push_back({nodes[i].kind, nodes[i].at, nodes[i].position, normals.at(nodes[i].at), start.piece});
      }
    }
  }
  whole.points.insert(whole.points.end(), curve.points.begin() + next, curve.points.end());
  curve = std::move(whole);
}

}  // namespace isopath
