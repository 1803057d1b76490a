#include "isopath/field/vertex_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "isopath/core/error.h"

namespace isopath {

VertexField::VertexField(const TriangleMesh& mesh, std::vector<double> values)
    : mesh_(&mesh), values_(std::move(values)) {
  if (values_.size() != static_cast<std::size_t>(mesh.n_vertices())) {
    throw Error(ErrorCode::bad_usage, "a vertex field needs one value for each vertex",
                {.value = fmt::format("{} values for {} vertices", values_.size(), mesh.n_vertices())});
  }
  for (std::size_t vertex = 0; vertex < values_.size(); ++vertex) {
    if (std::isnan(values_[vertex]) || values_[vertex] == -infinity) {
      throw Error(ErrorCode::bad_usage, "a vertex field's values must be numbers",
                  {.element = fmt::format("vertex {}", vertex),
                   .value = fmt::format("{}", values_[vertex]),
                   .advice = "use infinity for a vertex that is not reached"});
    }
  }
  for (Index face = 0; face < mesh.n_faces(); ++face) max_slope_ = std::max(max_slope_, gradient(face).norm());
}

/// Σ vᵢ (n × eᵢ) / 2A with eᵢ the edge opposite to corner i; zero for a face that is unreached or has no area.
Vec3 VertexField::gradient(Index face) const {
  const auto& [a, b, c] = mesh_->triangle(face);
  if (!std::isfinite(values_[a] + values_[b] + values_[c])) return Vec3::Zero();
  const Vec3 ab = mesh_->position(b) - mesh_->position(a);
  const Vec3 ac = mesh_->position(c) - mesh_->position(a);
  const Vec3 normal = ab.cross(ac);
  const double squared = normal.squaredNorm();
  if (squared == 0) return Vec3::Zero();
  // Differences to corner a, as a common offset must not cost digits.
  return normal.cross((values_[c] - values_[a]) * ab - (values_[b] - values_[a]) * ac) / squared;
}

double VertexField::value(const SurfacePoint& point) const {
  const Triangle& corners = mesh_->triangle(point.face);
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    // Skips 0 × infinity, so that an edge is reached even where the face's third corner is not.
    if (point.barycentric[i] != 0) sum += point.barycentric[i] * values_[corners[i]];
  }
  return sum;
}

SurfaceFunction::Slope VertexField::slope(const SurfacePoint& point) const {
  const Vec3 ascent = gradient(point.face);
  const double length = ascent.norm();
  if (length == 0) return {value(point)};
  return {value(point), ascent / length};
}

void VertexField::edge_crossings(Index edge, double level, std::vector<double>& parameters) const {
  const Index halfedge = mesh_->halfedge_of(edge);
  const double from = values_[mesh_->from(halfedge)];
  const double to = values_[mesh_->to(halfedge)];
  if (from == infinity || to == infinity || (from >= level) == (to >= level)) return;
  parameters.push_back(std::clamp((level - from) / (to - from), 0.0, 1.0));
}

VertexField height_field(const TriangleMesh& mesh, const Vec3& direction) {
  const double length = direction.norm();
  if (!std::isfinite(length) || length == 0) {
    throw Error(ErrorCode::bad_usage, "the direction of a height field must be a finite vector other than zero",
                {.value = fmt::format("({}, {}, {})", direction.x(), direction.y(), direction.z())});
  }
  const Vec3 unit = direction / length;
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(mesh.n_vertices()));
  for (Index vertex = 0; vertex < mesh.n_vertices(); ++vertex) values.push_back(unit.dot(mesh.position(vertex)));
  return {mesh, std::move(values)};
}

}  // namespace isopath
