#include "isopath/mesh/curved_surface.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "isopath/mesh/normals.h"
#include "isopath/mesh/surface_locator.h"

namespace isopath {
namespace {

/// Of the point of a face that is nearest to a point in its plane or next to it.
Vec3 barycentric_in(const TriangleMesh& mesh, Index face, const Vec3& point) {
  const Vec3& n = mesh.face_normal(face);
  const Triangle& corner = mesh.triangle(face);
  Vec3 weights = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vec3& a = mesh.position(corner[(i + 1) % 3]);
    const Vec3& b = mesh.position(corner[(i + 2) % 3]);
    weights[i] = std::max(0.0, n.dot((a - point).cross(b - point)));
  }
  const double sum = weights.sum();
  return sum > 0 ? Vec3(weights / sum) : Vec3(Vec3::Constant(1.0 / 3));
}

}  // namespace

CurvedSurface::CurvedSurface(const TriangleMesh& mesh, const SurfaceFit& fit) : corners_(mesh.n_halfedges()) {
  for (Index h = 0; h < mesh.n_halfedges(); ++h) corners_[h] = {mesh.position(mesh.from(h)), fit.corner_normals[h]};
}

CurvedSurface::CurvedSurface(const TriangleMesh& mesh, double radius)
    : CurvedSurface(mesh, fit_surface(mesh, SmoothNormals(mesh), radius)) {}

CurvedSurface CurvedSurface::over(const TriangleMesh& mesh, const TriangleMesh& finer) const {
  CurvedSurface out;
  out.corners_.resize(finer.n_halfedges());
  const SurfaceLocator locator(mesh);
  tbb::parallel_for(tbb::blocked_range<Index>(0, finer.n_faces(), 256), [&](const auto& range) {
    for (Index f = range.begin(); f < range.end(); ++f) {
      Vec3 centre = Vec3::Zero();  // inside one face, whereas corners lie between several
      for (const Index v : finer.triangle(f)) centre += finer.position(v) / 3;
      const Index face = locator.nearest(centre).at.face;
      for (int i = 0; i < 3; ++i) {
        out.corners_[3 * f + i] = at({face, barycentric_in(mesh, face, finer.position(finer.triangle(f)[i]))});
      }
    }
  });
  return out;
}

CurvedSurface::Point CurvedSurface::at(const SurfacePoint& on_mesh) const {
  const Vec3& b = on_mesh.barycentric;
  const Point* corner = &corners_[3 * on_mesh.face];
  const Vec3 flat = b[0] * corner[0].position + b[1] * corner[1].position + b[2] * corner[2].position;
  Vec3 lift = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    lift -= b[i] * (flat - corner[i].position).dot(corner[i].normal) * corner[i].normal;
    normal += b[i] * corner[i].normal;
  }
  return {flat + 0.5 * lift, normal.stableNormalized()};
}

}  // namespace isopath
