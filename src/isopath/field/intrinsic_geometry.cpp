#include "isopath/field/intrinsic_geometry.h"

#include <fmt/format.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <algorithm>
#include <array>

#include <cmath>
#include <limits>

#include "isopath/core/error.h"
#include "isopath/field/angles.h"
#include "isopath/field/triangle_layout.h"

namespace isopath {
namespace {

/// Lengths of points on one line break the triangle inequality by a few roundings.
constexpr double length_rounding = 8 * std::numeric_limits<double>::epsilon();

void check_lengths(const TriangleMesh& mesh, std::span<const double> lengths) {
  if (static_cast<Index>(lengths.size()) != mesh.n_edges()) {
    throw Error(
        ErrorCode::bad_usage, "a metric needs one length for each edge of the mesh",
        {.element = "edge lengths", .value = fmt::format("{} lengths, {} edges", lengths.size(), mesh.n_edges())});
  }
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    if (lengths[e] > 0 && std::isfinite(lengths[e])) continue;
    const Index h = mesh.halfedge_of(e);
    throw Error(ErrorCode::bad_input, "the length of an edge in a metric must be finite and positive",
                {.element = fmt::format("edge {} from vertex {} to {}", e, mesh.from(h), mesh.to(h)),
                 .value = fmt::format("{} mm", lengths[e])});
  }
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    std::array<double, 3> s;
    for (int i = 0; i < 3; ++i) s[i] = lengths[mesh.edge_of(3 * f + i)];
    std::sort(s.begin(), s.end());
    if (s[2] - s[1] <= s[0] + length_rounding * s[2]) continue;
    throw Error(ErrorCode::bad_input,
                "a face cannot have these edge lengths: one is longer than the other two together",
                {.element = fmt::format("face {}", f),
                 .value = fmt::format("{} > {} + {} mm", s[2], s[1], s[0]),
                 .advice = "refine the mesh where the metric changes, or add a little to all lengths"});
  }
}

}  // namespace

IntrinsicGeometry::IntrinsicGeometry(const TriangleMesh& mesh)
    : size_(mesh.size()), length_(mesh.n_halfedges()), apex_(mesh.n_halfedges()), angle_(mesh.n_halfedges()) {
  constexpr Index at_a_time = 3 * 1024;
  tbb::parallel_for(tbb::blocked_range(Index(0), mesh.n_halfedges(), at_a_time), [&](const auto& part) {
    for (Index h = part.begin(); h < part.end(); ++h) {
      const Vec3& a = mesh.position(mesh.from(h));
      const Vec3 along = mesh.position(mesh.to(h)) - a;
      const Vec3 towards = mesh.position(mesh.from(TriangleMesh::prev(h))) - a;
      // Half-edges of one edge must agree to the last bit, so that both sides see the same interval.
      length_[h] = mesh.edge_length(mesh.edge_of(h));
      apex_[h] = length_[h] > 0 ? Vec2(along.dot(towards) / length_[h], along.cross(towards).norm() / length_[h])
                                : Vec2(0, towards.norm());
    }
    angles_of(std::span(apex_).subspan(part.begin(), part.size()),
              std::span(angle_).subspan(part.begin(), part.size()));
  });
}

IntrinsicGeometry::IntrinsicGeometry(const TriangleMesh& mesh, std::span<const double> edge_lengths)
    : is_metric_(true),
      max_stretch_(0),
      length_(mesh.n_halfedges()),
      apex_(mesh.n_halfedges()),
      angle_(mesh.n_halfedges()) {
  check_lengths(mesh, edge_lengths);
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    const double right = edge_lengths[mesh.edge_of(TriangleMesh::next(h))];
    const double left = edge_lengths[mesh.edge_of(TriangleMesh::prev(h))];
    length_[h] = edge_lengths[mesh.edge_of(h)];
    apex_[h] = apex_of(length_[h], right, left);
    const double in_space = mesh.edge_length(mesh.edge_of(h));
    if (in_space > 0) max_stretch_ = std::max(max_stretch_, length_[h] / in_space);
  }
  angles_of(apex_, angle_);
  const IntrinsicGeometry space(mesh);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    Index h = 3 * f;  // on the longest edge a needle's layout is best known
    for (const Index other : {3 * f + 1, 3 * f + 2}) {
      if (space.length_[other] > space.length_[h]) h = other;
    }
    const Vec2& apex = space.apex_[h];
    if (!(apex.y() > length_rounding * space.length_[h])) continue;  // all its points are on its edges
    // the map from space to the layout is [a b; 0 d]
    const double a = length_[h] / space.length_[h];
    const double b = (apex_[h].x() - a * apex.x()) / apex.y();
    const double d = apex_[h].y() / apex.y();
    // its larger singular value
    max_stretch_ = std::max(max_stretch_, 0.5 * (std::hypot(a + d, b) + std::hypot(a - d, b)));
  }
  size_ = max_stretch_ * mesh.size();
}

Vec2 IntrinsicGeometry::in_frame(Index halfedge, const Vec3& barycentric) const {
  const double head = barycentric[TriangleMesh::next(halfedge) % 3];
  const double top = barycentric[TriangleMesh::prev(halfedge) % 3];
  return head * Vec2(length_[halfedge], 0) + top * apex_[halfedge];
}

Vec3 IntrinsicGeometry::direction_in_space(const TriangleMesh& mesh, Index face, const Vec2& v) const {
  const auto& [a, b, c] = mesh.triangle(face);
  const Vec3 along = mesh.position(b) - mesh.position(a);
  const Index h = 3 * face;
  if (is_metric_ && apex_[h].y() > 0) {
    const double top = v.y() / apex_[h].y();
    const double head = (v.x() - top * apex_[h].x()) / length_[h];
    return (head * along + top * (mesh.position(c) - mesh.position(a))).stableNormalized();
  }
  const Vec3 x = along.stableNormalized();
  const Vec3 y = mesh.face_normal(face).cross(x);
  return (v.x() * x + v.y() * y).stableNormalized();
}

}  // namespace isopath
