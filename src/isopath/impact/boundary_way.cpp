#include "isopath/impact/boundary_way.h"

namespace isopath {
namespace {

/// The boundary half-edge a point lies on (at its start, or inside), `no_index` for other points.
Index boundary_halfedge(const TriangleMesh& mesh, const SurfacePoint& point) {
  const Support support = support_of(mesh, point);
  if (support.kind == Support::Kind::vertex) {
    return mesh.is_boundary_vertex(support.index) ? mesh.outgoing(support.index) : no_index;
  }
  if (support.kind == Support::Kind::edge && mesh.twin(support.index) == no_index) return support.index;
  return no_index;
}

/// Along the loop, with the surface on the left.
std::optional<SurfaceCurve> walk_forward(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                         Index first, Index last, double longest) {
  SurfaceCurve curve;
  curve.add(mesh, from);
  const Vec3 goal = position_of(mesh, to);
  double length = 0;
  Index h = first;
  const auto ahead = [&] {
    return (mesh.position(mesh.to(h)) - goal).norm() <= (mesh.position(mesh.to(h)) - curve.positions.back()).norm();
  };
  while (h != last || !ahead()) {
    const Index vertex = mesh.to(h);
    length += (mesh.position(vertex) - curve.positions.back()).norm();
    if (length > longest) return std::nullopt;
    h = mesh.outgoing(vertex);
    if (h == first) return std::nullopt;  // `to` is on another loop, or nearer the other way on the same edge
    curve.add(mesh, point_on_halfedge(h, 0));
  }
  length += (goal - curve.positions.back()).norm();
  if (length > longest) return std::nullopt;
  curve.add(mesh, to);
  return curve;
}

}  // namespace

std::optional<SurfaceCurve> boundary_way(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                         double longest) {
  const Index a = boundary_halfedge(mesh, from);
  const Index b = boundary_halfedge(mesh, to);
  if (a == no_index || b == no_index) return std::nullopt;
  auto forward = walk_forward(mesh, from, to, a, b, longest);
  auto backward = walk_forward(mesh, to, from, b, a, longest);
  if (backward) backward->reverse();
  if (!forward || !backward) return forward ? forward : backward;
  return length_of(*forward) <= length_of(*backward) ? forward : backward;
}

}  // namespace isopath
