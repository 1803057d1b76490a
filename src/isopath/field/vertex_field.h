#pragma once

#include <span>
#include <vector>

#include "isopath/field/surface_function.h"

namespace isopath {

/// A function given by its values at the vertices and linear inside every face. A value of infinity marks a vertex as
/// unreached; a face with such a corner is unreached but for its finite corners and the edge between them.
/// The mesh must outlive the field.
class VertexField final : public SurfaceFunction {
 public:
  /// Takes one value for each vertex, in the mesh's order. Throws Error(bad_usage) when their number differs or a value
  /// is NaN or minus infinity.
  VertexField(const TriangleMesh& mesh, std::vector<double> values);

  const TriangleMesh& mesh() const { return *mesh_; }
  std::span<const double> values() const { return values_; }

  double value_at_vertex(Index vertex) const override { return values_[vertex]; }
  double value(const SurfacePoint& point) const override;
  Slope slope(const SurfacePoint& point) const override;
  void edge_crossings(Index edge, double level, std::vector<double>& parameters) const override;
  bool linear_in_faces() const override { return true; }
  bool monotone_in_face(Index) const override { return true; }
  /// The length of the largest gradient of a face that is reached.
  double max_slope() const override { return max_slope_; }

 private:
  Vec3 gradient(Index face) const;

  const TriangleMesh* mesh_;
  std::vector<double> values_;
  double max_slope_ = 0;
};

/// The height of every vertex along `direction` (of any length): its isolines are cuts with parallel planes, its unit
/// mm. Throws Error(bad_usage) when the direction is zero or not finite.
VertexField height_field(const TriangleMesh& mesh, const Vec3& direction);

}  // namespace isopath
