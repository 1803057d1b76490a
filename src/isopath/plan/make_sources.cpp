#include "isopath/plan/make_sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "isopath/contour/isolines.h"
#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/vertex_field.h"
#include "isopath/mesh/surface_locator.h"

namespace isopath {
namespace {

using Kind = SourceSpec::Kind;

[[noreturn]] void reject(const SourceSpec& spec, std::string what, std::string value, std::string advice = {}) {
  throw Error(
      ErrorCode::bad_usage, std::move(what),
      {.element = fmt::format("source '{}'", text_of(spec)), .value = std::move(value), .advice = std::move(advice)});
}

/// The mesh and what is worked out on it once for all specs.
class Maker {
 public:
  Maker(const TriangleMesh& mesh, std::span<const Index> vertex_of_file_vertex, Progress& progress)
      : mesh_(mesh), vertex_of_file_vertex_(vertex_of_file_vertex), progress_(progress) {}

  void add(const SourceSpec& spec) {
    progress_.checkpoint();
    switch (spec.kind) {
      case Kind::automatic:
        return add_automatic();
      case Kind::boundary:
        return add_boundary(spec);
      case Kind::vertex:
        for (const Index file_vertex : spec.indices) sources_.add_vertex(mesh_, vertex(spec, file_vertex));
        return;
      case Kind::point:
        return sources_.add_point(nearest(spec, Vec3(spec.numbers[0], spec.numbers[1], spec.numbers[2])));
      case Kind::polyline:
        return add_polyline(spec);
      case Kind::plane:
        return add_plane(spec);
      case Kind::edges:
        return add_edges(spec);
    }
  }

  Index vertex(const SourceSpec& spec, Index file_vertex) const {
    const auto n = static_cast<Index>(vertex_of_file_vertex_.size());
    if (file_vertex >= n) {
      reject(spec, "there is no such vertex", fmt::format("vertex {} of {}", file_vertex, n),
             fmt::format("vertices are numbered 0 to {}", n - 1));
    }
    const Index v = vertex_of_file_vertex_[file_vertex];
    if (v == no_index || mesh_.outgoing(v) == no_index) {
      reject(spec, "the vertex belongs to no triangle", fmt::format("vertex {}", file_vertex), "choose one that does");
    }
    return v;
  }

  SurfacePoint nearest(const SourceSpec& spec, const Vec3& position) {
    if (!locator_) locator_.emplace(mesh_);
    const NearestPoint found = locator_->nearest(position);
    if (!found.at.valid()) reject(spec, "the mesh has no triangle to bring the point to", {});
    return found.at;
  }

  SourceSet take() { return std::move(sources_); }

 private:
  void add_boundary(const SourceSpec& spec);
  void add_automatic();
  void add_polyline(const SourceSpec& spec);
  void add_plane(const SourceSpec& spec);
  bool add_touched(const VertexField& height, double level);
  void add_edges(const SourceSpec& spec);

  const TriangleMesh& mesh_;
  std::span<const Index> vertex_of_file_vertex_;
  Progress& progress_;
  std::optional<SurfaceLocator> locator_;
  SourceSet sources_;
};

void Maker::add_boundary(const SourceSpec& spec) {
  const auto& loops = mesh_.boundary_loops();
  if (loops.empty()) {
    reject(spec, "the mesh is closed: it has no boundary", {}, "use 'auto', 'plane:...' or 'point:...'");
  }
  for (const Index k : spec.indices) {
    if (k >= static_cast<Index>(loops.size())) {
      reject(spec, "there is no such boundary loop", fmt::format("loop {} of {}", k, loops.size()),
             fmt::format("loops are numbered 0 to {}, longest first", loops.size() - 1));
    }
    sources_.add_halfedges(mesh_, loops[k], true);
  }
  if (!spec.indices.empty()) return;
  for (const auto& loop : loops) sources_.add_halfedges(mesh_, loop, true);
}

/// The vertex of each component farthest along the longest axis of the component's box, lowest index first.
std::vector<Index> far_vertices(const TriangleMesh& mesh) {
  std::vector<Box3> boxes(mesh.n_components());
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    for (const Index v : mesh.triangle(f)) boxes[mesh.component_of(f)].extend(mesh.position(v));
  }
  std::vector<int> axes(mesh.n_components());
  for (Index c = 0; c < mesh.n_components(); ++c) boxes[c].sizes().maxCoeff(&axes[c]);
  std::vector<Index> far(mesh.n_components(), no_index);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const Index c = mesh.component_of(f);
    for (const Index v : mesh.triangle(f)) {
      const auto key = [&](Index u) { return std::pair(-mesh.position(u)[axes[c]], u); };
      if (far[c] == no_index || key(v) < key(far[c])) far[c] = v;
    }
  }
  return far;
}

void Maker::add_automatic() {
  std::vector<char> has_boundary(mesh_.n_components(), 0);
  for (const auto& loop : mesh_.boundary_loops()) {
    has_boundary[mesh_.component_of(TriangleMesh::face_of(loop.front()))] = 1;
    sources_.add_halfedges(mesh_, loop, true);
  }
  const std::vector<Index> far = far_vertices(mesh_);
  for (Index c = 0; c < mesh_.n_components(); ++c) {
    if (!has_boundary[c]) sources_.add_vertex(mesh_, far[c]);
  }
}

/// The shortest path between two points of one component.
std::vector<SurfacePoint> shortest_way(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                       Progress& progress) {
  SourceSet end;
  end.add_point(to);
  // Neighbouring points are mostly near each other: look nearby first, since a field over all of the part costs more.
  double reach = 2 * (position_of(mesh, from) - position_of(mesh, to)).norm() + mesh.tolerance().length;
  for (;; reach = reach < 4 * mesh.size() ? 4 * reach : infinity) {
    const ExactField field = ExactField::compute(mesh, end, {.stop_distance = reach}, progress);
    // Up to the stop distance the field is exact, beyond it is not.
    if (field.value(from) <= reach) return field.shortest_path(from);
  }
}

void Maker::add_polyline(const SourceSpec& spec) {
  std::vector<SurfacePoint> on_surface;
  for (const Vec3& position : read_polyline(spec.file)) {
    const SurfacePoint next = nearest(spec, position);
    if (on_surface.empty()) {
      on_surface.push_back(next);
      continue;
    }
    progress_.checkpoint();
    if (mesh_.component_of(on_surface.back().face) != mesh_.component_of(next.face)) {
      reject(spec, "two points that follow each other lie on different components of the mesh",
             fmt::format("the second is near {}, {}, {}", position.x(), position.y(), position.z()),
             "use one polyline for each component");
    }
    const std::vector<SurfacePoint> way = shortest_way(mesh_, on_surface.back(), next, progress_);
    on_surface.insert(on_surface.end(), way.begin() + 1, way.end());
  }
  if (on_surface.size() == 1) return sources_.add_point(on_surface.front());
  sources_.add_polyline(mesh_, on_surface, false);
}

void Maker::add_plane(const SourceSpec& spec) {
  const Vec3 normal(spec.numbers[0], spec.numbers[1], spec.numbers[2]);
  const VertexField height = height_field(mesh_, normal);
  // The field measures along the unit normal; the equation is in the normal as given.
  const double level = spec.numbers[3] / normal.norm();
  const std::vector<Contour> cuts = isolines(mesh_, height, std::array{level}, {}, progress_);
  if (cuts.empty()) {
    if (add_touched(height, level)) return;
    double low = infinity;
    double high = -infinity;
    for (const double value : height.values()) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
    reject(spec, "the plane does not cut the part", fmt::format("D = {}", spec.numbers[3]),
           fmt::format("with this normal D may lie between {} and {}", low * normal.norm(), high * normal.norm()));
  }
  for (const Contour& cut : cuts) sources_.add_polyline(mesh_, cut.points, cut.closed);
}

/// A plane at the rim of the part cuts no face, but it meets the edges and vertices that lie in it.
bool Maker::add_touched(const VertexField& height, double level) {
  const double tolerance = mesh_.tolerance().length;
  const auto touched = [&](Index v) { return std::abs(height.values()[v] - level) <= tolerance; };
  bool any = false;
  std::vector<char> on_edge(mesh_.n_vertices(), 0);
  for (Index e = 0; e < mesh_.n_edges(); ++e) {
    const Index h = mesh_.halfedge_of(e);
    if (!touched(mesh_.from(h)) || !touched(mesh_.to(h))) continue;
    sources_.add_halfedges(mesh_, std::array{h}, false);
    on_edge[mesh_.from(h)] = on_edge[mesh_.to(h)] = any = true;
  }
  for (Index v = 0; v < mesh_.n_vertices(); ++v) {
    if (on_edge[v] || mesh_.outgoing(v) == no_index || !touched(v)) continue;
    sources_.add_vertex(mesh_, v);
    any = true;
  }
  return any;
}

void Maker::add_edges(const SourceSpec& spec) {
  const auto chains = feature_chains(mesh_, spec.numbers[0] * std::numbers::pi / 180);
  if (chains.empty()) {
    reject(spec, "no two faces meet at more than this angle", fmt::format("{} degrees", spec.numbers[0]),
           "give a smaller angle");
  }
  for (const auto& chain : chains) {
    sources_.add_halfedges(mesh_, chain, mesh_.to(chain.back()) == mesh_.from(chain.front()));
  }
}

}  // namespace

SourceSet make_sources(const TriangleMesh& mesh, std::span<const SourceSpec> specs,
                       std::span<const Index> vertex_of_file_vertex, Progress& progress) {
  Maker maker(mesh, vertex_of_file_vertex, progress);
  for (const SourceSpec& spec : specs) maker.add(spec);
  return maker.take();
}

SurfacePoint make_point(const TriangleMesh& mesh, const SourceSpec& spec,
                        std::span<const Index> vertex_of_file_vertex) {
  Maker maker(mesh, vertex_of_file_vertex, Progress::none());
  if (spec.kind == Kind::point) {
    return maker.nearest(spec, Vec3(spec.numbers[0], spec.numbers[1], spec.numbers[2]));
  }
  if (spec.kind == Kind::vertex && spec.indices.size() == 1) {
    return point_at_vertex(mesh, maker.vertex(spec, spec.indices.front()));
  }
  reject(spec, "one point belongs here", {}, "give point:X,Y,Z or vertex:I");
}

}  // namespace isopath
