#include "isopath/mesh/normals.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>

#include "isopath/core/angle.h"
#include "isopath/core/error.h"

namespace isopath {
namespace {

double longest_edge(const TriangleMesh& mesh, Index face) {
  double longest = 0;
  for (Index h = 3 * face; h < 3 * face + 3; ++h) longest = std::max(longest, mesh.edge_length(mesh.edge_of(h)));
  return longest;
}

/// A triangle lower than this share of its longest edge has no normal of its own: meshes come with coordinates rounded
/// to single precision (6e-8), and one decade more is left for their distance from the origin.
constexpr double least_relative_height = 1e-6;

bool has_normal(const TriangleMesh& mesh, Index face) {
  const double longest = longest_edge(mesh, face);
  return 2 * mesh.face_area(face) > least_relative_height * longest * longest;
}

/// Normals of the faces; those without one take that of a neighbour, spreading from the faces that have one.
std::vector<Vec3> face_normals(const TriangleMesh& mesh) {
  std::vector<Vec3> normal(mesh.n_faces(), Vec3::Zero());
  std::deque<Index> waiting;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    if (has_normal(mesh, f)) {
      normal[f] = mesh.face_normal(f);
    } else {
      waiting.push_back(f);
    }
  }
  for (std::size_t since_progress = 0; !waiting.empty() && since_progress < waiting.size();) {
    const Index f = waiting.front();
    waiting.pop_front();
    double longest = -1;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const Index g = mesh.twin(h);
      if (g == no_index || normal[g / 3].isZero(0) || mesh.edge_length(mesh.edge_of(h)) <= longest) continue;
      longest = mesh.edge_length(mesh.edge_of(h));
      normal[f] = normal[g / 3];
    }
    ++since_progress;
    if (longest >= 0) {
      since_progress = 0;
    } else {
      waiting.push_back(f);
    }
  }
  for (const Index f : waiting) {
    const Vec3 own = mesh.face_normal(f);
    normal[f] = own.isZero(0) ? Vec3::UnitZ() : own;
  }
  return normal;
}

double corner_angle(const TriangleMesh& mesh, Index halfedge) {
  const Vec3 a = mesh.position(mesh.to(halfedge)) - mesh.position(mesh.from(halfedge));
  const Vec3 b = mesh.position(mesh.from(mesh.prev(halfedge))) - mesh.position(mesh.from(halfedge));
  return angle_between(a, b);
}

}  // namespace

void NormalsOptions::validate() const {
  if (crease_angle >= 0 && crease_angle <= std::numbers::pi) return;
  throw Error(ErrorCode::bad_usage, "the crease angle must lie between 0 and pi radians",
              {.element = "crease_angle", .value = fmt::format("{}", crease_angle)});
}

SmoothNormals::SmoothNormals(const TriangleMesh& mesh, const NormalsOptions& options)
    : face_(face_normals(mesh)), crease_(mesh.n_halfedges(), 0), corner_(mesh.n_halfedges(), Vec3::Zero()) {
  options.validate();
  for (Index h = 0; h < mesh.n_halfedges(); ++h) {
    const Index g = mesh.twin(h);
    crease_[h] = g == no_index || angle_between(face_[h / 3], face_[g / 3]) > options.crease_angle;
  }
  std::vector<Index> fan;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    fan.clear();
    for (Index h = mesh.outgoing(v); h != no_index && (fan.empty() || h != fan.front()); h = mesh.next_outgoing(h)) {
      fan.push_back(h);
    }
    // Start at a crease, if there is one, so that no group is broken by where the fan happens to begin.
    std::rotate(fan.begin(), std::find_if(fan.begin(), fan.end(), [&](Index h) { return is_crease(h); }), fan.end());
    for (std::size_t begin = 0; begin < fan.size();) {
      std::size_t end = begin;
      Vec3 sum = Vec3::Zero();
      do {
        const Index face = fan[end] / 3;
        if (has_normal(mesh, face)) sum += corner_angle(mesh, fan[end]) * face_[face];
        ++end;
      } while (end < fan.size() && !is_crease(fan[end]));
      for (; begin < end; ++begin) {
        // The normals of a group of a few radians never add up to less than this, unless they cancel.
        corner_[fan[begin]] = sum.norm() > 1e-6 ? sum.normalized() : face_[fan[begin] / 3];
      }
    }
  }
}

Vec3 SmoothNormals::at(const SurfacePoint& point) const {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < 3; ++i) sum += point.barycentric[i] * corner_[3 * point.face + i];
  const double length = sum.norm();
  return length > 1e-6 ? Vec3(sum / length) : face_[point.face];
}

}  // namespace isopath
