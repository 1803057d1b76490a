#include "isopath/field/warp.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "isopath/core/error.h"

namespace isopath {
namespace {

/// Mended triangles keep at least this height over their longest side, relative to the mean edge: flat ones have angles
/// of 0 and π, around which rounding decides.
constexpr double mended_slack = 1e-6;

void check_tool(double tool_radius, double least_stretch) {
  if (!(tool_radius > 0 && std::isfinite(tool_radius))) {
    throw Error(ErrorCode::bad_usage, "the tool's radius must be a positive length in mm",
                {.element = "tool_radius", .value = fmt::format("{}", tool_radius)});
  }
  if (!(least_stretch > 0 && least_stretch <= 1)) {
    throw Error(ErrorCode::bad_usage, "the least stretch must lie above 0 and not above 1",
                {.element = "least_stretch", .value = fmt::format("{}", least_stretch)});
  }
}

void check_tensors(const TriangleMesh& mesh, std::span<const MetricTensor> tensors) {
  if (static_cast<Index>(tensors.size()) != mesh.n_vertices()) {
    throw Error(
        ErrorCode::bad_usage, "a metric needs one tensor for each vertex of the mesh",
        {.element = "tensors", .value = fmt::format("{} tensors, {} vertices", tensors.size(), mesh.n_vertices())});
  }
  constexpr double tolerance = 1e-6;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const MetricTensor& t = tensors[v];
    for (const double stretch : {t.first_stretch, t.second_stretch}) {
      if (stretch > 0 && std::isfinite(stretch)) continue;
      throw Error(ErrorCode::bad_input, "the stretch of a metric must be finite and positive",
                  {.element = fmt::format("vertex {}", v), .value = fmt::format("{}", stretch)});
    }
    const bool orthonormal = std::abs(t.first.squaredNorm() - 1) < tolerance &&
                             std::abs(t.second.squaredNorm() - 1) < tolerance &&
                             std::abs(t.first.dot(t.second)) < tolerance;
    if (orthonormal) continue;
    throw Error(ErrorCode::bad_input, "the directions of a metric must be orthogonal and of unit length",
                {.element = fmt::format("vertex {}", v),
                 .value = fmt::format("({}, {}, {}) and ({}, {}, {})", t.first.x(), t.first.y(), t.first.z(),
                                      t.second.x(), t.second.y(), t.second.z())});
  }
}

/// The tensors with their normals on the side that the triangles' orientation shows: only so can they be blended.
std::vector<MetricTensor> facing_out(const TriangleMesh& mesh, std::span<const MetricTensor> tensors) {
  std::vector<Vec3> out(mesh.n_vertices(), Vec3::Zero());
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    for (const Index v : mesh.triangle(f)) out[v] += mesh.face_area(f) * mesh.face_normal(f);
  }
  std::vector<MetricTensor> facing(tensors.begin(), tensors.end());
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (facing[v].normal().dot(out[v]) < 0) facing[v].second = -facing[v].second;
  }
  return facing;
}

/// How much two sides of a triangle exceed the third.
double slack_of(double a, double b, double c) {
  const double longest = std::max({a, b, c});
  return (a + b + c - longest) - longest;
}

class Splitter {
 public:
  Splitter(const TriangleMesh& mesh, std::span<const MetricTensor> tensors, const WarpOptions& options)
      : mesh_(mesh), tensors_(tensors), options_(options), marks_(mesh.n_faces()) {}

  MetricTensor at(Index face, const Vec3& barycentric) const {
    const auto& [a, b, c] = mesh_.triangle(face);
    return blended({tensors_[a], tensors_[b], tensors_[c]}, barycentric, options_.blend);
  }

  /// The part of an old face around this point is to be split further.
  void mark(Index face, const Vec3& barycentric) { marks_[face].push_back(barycentric); }

  bool wants_split(const RefineTriangle& triangle) const {
    if (has_mark(triangle)) return true;
    std::array<MetricTensor, 3> corner;
    for (int i = 0; i < 3; ++i) corner[i] = at(triangle.face, triangle.barycentric[i]);
    std::array<double, 3> length;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const Vec3 half = 0.5 * (triangle.position[j] - triangle.position[i]);
      const MetricTensor middle = at(triangle.face, 0.5 * (triangle.barycentric[i] + triangle.barycentric[j]));
      length[i] = edge_length(2 * half, corner[i], corner[j], options_.blend);
      if (length[i] <= options_.shortest_edge) continue;
      const double first = edge_length(half, corner[i], middle, options_.blend);
      const double sum = first + edge_length(half, middle, corner[j], options_.blend);
      if (std::abs(first - 0.5 * sum) > options_.midpoint_shift * sum) return true;
      if (std::abs(sum - length[i]) > options_.length_excess * length[i]) return true;
    }
    return slack_of(length[0], length[1], length[2]) < 0;
  }

 private:
  bool has_mark(const RefineTriangle& triangle) const {
    const std::vector<Vec3>& in_face = marks_[triangle.face];
    if (in_face.empty()) return false;
    Eigen::Matrix3d corners;
    for (int i = 0; i < 3; ++i) corners.col(i) = triangle.barycentric[i];
    const Eigen::Matrix3d inverse = corners.inverse();  // all barycentric coordinates sum to 1, so it exists
    return std::any_of(in_face.begin(), in_face.end(), [&](const Vec3& at) { return (inverse * at).minCoeff() >= 0; });
  }

  const TriangleMesh& mesh_;
  std::span<const MetricTensor> tensors_;
  const WarpOptions& options_;
  std::vector<std::vector<Vec3>> marks_;  ///< per face
};

double slack_of(const WarpedSurface& surface, Index face) {
  const auto length = [&](Index h) { return surface.edge_lengths[surface.refined.mesh.edge_of(h)]; };
  return slack_of(length(3 * face), length(3 * face + 1), length(3 * face + 2));
}

WarpedSurface split(const TriangleMesh& mesh, const std::vector<MetricTensor>& tensors, const Splitter& splitter,
                    const WarpOptions& options, const Progress& progress) {
  WarpedSurface surface;
  const auto wants_split = [&](const RefineTriangle& triangle) {
    progress.checkpoint();
    return splitter.wants_split(triangle);
  };
  surface.refined = refine(mesh, wants_split, options.max_levels);
  const TriangleMesh& fine = surface.refined.mesh;
  surface.tensors = tensors;
  for (Index v = mesh.n_vertices(); v < fine.n_vertices(); ++v) {
    const SurfacePoint& at = surface.refined.on_old[v];
    surface.tensors.push_back(splitter.at(at.face, at.barycentric));
  }
  surface.edge_lengths.resize(fine.n_edges());
  for (Index e = 0; e < fine.n_edges(); ++e) {
    const Index a = fine.from(fine.halfedge_of(e));
    const Index b = fine.to(fine.halfedge_of(e));
    surface.edge_lengths[e] =
        edge_length(fine.position(b) - fine.position(a), surface.tensors[a], surface.tensors[b], options.blend);
  }
  return surface;
}

/// Refinement halves triangles beside split ones without asking; those of them that are broken are marked. False when
/// there are none.
bool mark_broken(const TriangleMesh& mesh, const WarpedSurface& surface, Splitter& splitter) {
  const TriangleMesh& fine = surface.refined.mesh;
  bool any = false;
  for (Index f = 0; f < fine.n_faces(); ++f) {
    if (slack_of(surface, f) >= 0) continue;
    any = true;
    const Index old = surface.refined.old_face[f];
    Vec3 centre = Vec3::Zero();
    for (const Index v : fine.triangle(f)) centre += express_in(mesh, surface.refined.on_old[v], old).barycentric / 3;
    splitter.mark(old, centre);
  }
  return any;
}

/// Adds the least length that lets every face have its lengths.
void mend(WarpedSurface& surface) {
  const TriangleMesh& mesh = surface.refined.mesh;
  std::vector<double>& lengths = surface.edge_lengths;
  double worst = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const double slack = slack_of(surface, f);
    if (slack >= 0) continue;
    ++surface.broken_faces;
    worst = std::min(worst, slack);
  }
  if (surface.broken_faces == 0) return;
  double mean = 0;
  for (const double l : lengths) mean += l / static_cast<double>(lengths.size());
  surface.added_length = mended_slack * mean - worst;
  for (double& l : lengths) l += surface.added_length;
}

}  // namespace

void WarpOptions::validate() const {
  const auto refuse = [](const char* field, std::string value) {
    throw Error(ErrorCode::bad_usage, fmt::format("{} is out of range", field),
                {.element = fmt::format("warp option {}", field), .value = std::move(value)});
  };
  if (!(midpoint_shift > 0 && midpoint_shift < 0.5)) {
    refuse("midpoint_shift", fmt::format("{}; must be above 0 and below 0.5", midpoint_shift));
  }
  if (!(length_excess > 0)) refuse("length_excess", fmt::format("{}; must be above 0", length_excess));
  if (!(shortest_edge >= 0)) refuse("shortest_edge", fmt::format("{}; must be 0 or more", shortest_edge));
  if (max_levels < 0 || max_levels > 20) refuse("max_levels", fmt::format("{}; must be 0 … 20", max_levels));
}

ToolMetric tool_metric(std::span<const PrincipalCurvatures> curvatures, double tool_radius, double least_stretch) {
  check_tool(tool_radius, least_stretch);
  ToolMetric metric;
  metric.tensors.resize(curvatures.size());
  for (std::size_t v = 0; v < curvatures.size(); ++v) {
    const PrincipalCurvatures& k = curvatures[v];
    if (k.max_direction.isZero()) continue;  // no face uses the vertex
    const auto stretch = [&](double curvature) {
      return std::sqrt(std::max(1 - tool_radius * curvature, least_stretch * least_stretch));
    };
    metric.tensors[v] = {k.max_direction, k.min_direction, stretch(k.max), stretch(k.min)};
    const double least_square = 1 - tool_radius * k.max;  // the surface is hollowest along this direction
    if (least_square < least_stretch * least_stretch) metric.clamped.push_back(static_cast<Index>(v));
    if (least_square <= 0) metric.gouged.push_back(static_cast<Index>(v));
  }
  return metric;
}

WarpedSurface warp_surface(const TriangleMesh& mesh, std::span<const MetricTensor> tensors, const WarpOptions& options,
                           Progress& progress) {
  options.validate();
  check_tensors(mesh, tensors);
  const std::vector<MetricTensor> facing = facing_out(mesh, tensors);
  Splitter splitter(mesh, facing, options);
  WarpedSurface surface = split(mesh, facing, splitter, options, progress);
  while (mark_broken(mesh, surface, splitter)) {
    const Index n_faces = surface.refined.mesh.n_faces();
    surface = split(mesh, facing, splitter, options, progress);
    if (surface.refined.mesh.n_faces() == n_faces) break;  // all that is broken is at the last level
  }
  mend(surface);
  return surface;
}

std::vector<double> edge_lengths_by_normals(const TriangleMesh& mesh, const SmoothNormals& normals, double tool_radius,
                                            double least_stretch) {
  check_tool(tool_radius, least_stretch);
  std::vector<double> lengths(mesh.n_edges());
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    const Index h = mesh.halfedge_of(e);
    const Vec3 edge = mesh.position(mesh.to(h)) - mesh.position(mesh.from(h));
    const auto turn = [&](Index half) {
      const Index next = TriangleMesh::next(half);
      return Vec3(normals.at_corner(half / 3, next % 3) - normals.at_corner(half / 3, half % 3));
    };
    // at a crease the two faces have normals of their own
    const Vec3 change = mesh.twin(h) == no_index ? turn(h) : Vec3(0.5 * (turn(h) - turn(mesh.twin(h))));
    const double square = edge.squaredNorm();
    lengths[e] = std::sqrt(std::max(square + tool_radius * change.dot(edge), least_stretch * least_stretch * square));
  }
  return lengths;
}

}  // namespace isopath
