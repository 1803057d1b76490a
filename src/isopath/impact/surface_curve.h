#pragma once

#include <optional>
#include <vector>

#include "isopath/contour/isolines.h"
#include "isopath/core/progress.h"
#include "isopath/mesh/surface_locator.h"
#include "isopath/mesh/surface_point.h"

namespace isopath {

/// A polyline that lies on the surface: consecutive points share a face.
struct SurfaceCurve {
  std::vector<SurfacePoint> points;
  std::vector<Vec3> positions;  ///< of the points, in space

  std::size_t size() const { return points.size(); }
  bool empty() const { return points.empty(); }
  void add(const TriangleMesh& mesh, const SurfacePoint& point);
  void reverse();
};

/// Appends points evenly between two that share a face, without these, so many that no step is longer than `step` (at
/// most 1000 steps); none where they share no face.
void append_between(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to, double step,
                    std::vector<SurfacePoint>& points);

SurfaceCurve make_curve(const TriangleMesh& mesh, std::vector<SurfacePoint> points);
double length_of(const SurfaceCurve& curve);
/// Index of the curve's point nearest to a place; 0 for an empty curve.
std::size_t nearest_index(const SurfaceCurve& curve, const Vec3& place);
/// A closed curve that starts at another of its points.
SurfaceCurve rotated(const SurfaceCurve& closed, std::size_t start);
/// A closed contour walked once round, from its point nearest to a place back to that point.
SurfaceCurve closed_from(const TriangleMesh& mesh, const Contour& contour, const Vec3& place);

/// Joins points of the surface by short curves on it. Throws Error(cancelled) when `progress` asks for it. The mesh,
/// the locator and `progress` must outlive it.
class SurfaceLinker {
 public:
  SurfaceLinker(const TriangleMesh& mesh, const SurfaceLocator& locator, const Progress& progress = Progress::none())
      : mesh_(mesh), locator_(locator), progress_(progress) {}

  /// A curve on the surface from `from` to `to`, both included: along the plane section where that leads there, else
  /// the geodesic. None when every way is longer than `longest`.
  std::optional<SurfaceCurve> link(const SurfacePoint& from, const SurfacePoint& to, double longest) const;
  /// The same by the plane section alone: none where that does not lead there, though another way may.
  std::optional<SurfaceCurve> plain_link(const SurfacePoint& from, const SurfacePoint& to, double longest) const;

  /// Appends a point to a curve, by way of the surface. Only where the surface offers no way, as between two
  /// components, the point is appended as it is.
  void extend(SurfaceCurve& curve, const SurfacePoint& to) const;

  const TriangleMesh& mesh() const { return mesh_; }
  const SurfaceLocator& locator() const { return locator_; }

 private:
  const TriangleMesh& mesh_;
  const SurfaceLocator& locator_;
  const Progress& progress_;
};

}  // namespace isopath
