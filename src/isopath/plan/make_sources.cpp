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
#include "isopath/plan/curve_sources.h"

namespace isopath {
namespace {

using Kind = SourceSpec::Kind;

constexpr double degrees = std::numbers::pi / 180;
/// A point picked on a part lies on it up to a person's carelessness. Farther away it is a slip, or in another unit.
constexpr double farthest_pick_over_size = 0.1;

[[noreturn]] void reject(const SourceSpec& spec, std::string what, std::string value, std::string advice = {}) {
  throw Error(
      ErrorCode::bad_usage, std::move(what),
      {.element = fmt::format("source '{}'", text_of(spec)), .value = std::move(value), .advice = std::move(advice)});
}

/// What `make` returns; an Error of it that names no element gets the spec's name.
template <class Make>
auto with_spec(const SourceSpec& spec, const Make& make) {
  try {
    return make();
  } catch (const Error& error) {
    if (!error.where().element.empty()) throw;
    ErrorWhere where = error.where();
    where.element = fmt::format("source '{}'", text_of(spec));
    throw Error(error.code(), error.summary(), where);
  }
}

struct Range {
  double low = infinity;
  double high = -infinity;
};

/// Of the vertices that triangles use.
Range range_of(const TriangleMesh& mesh, const VertexField& height) {
  Range range;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (mesh.outgoing(v) == no_index) continue;
    range.low = std::min(range.low, height.values()[v]);
    range.high = std::max(range.high, height.values()[v]);
  }
  return range;
}

/// The mesh and what is worked out on it once for all specs.
class Maker {
 public:
  Maker(const TriangleMesh& mesh, std::span<const Index> vertex_of_file_vertex, Progress& progress,
        AutoLoops loops = AutoLoops::all)
      : mesh_(mesh), vertex_of_file_vertex_(vertex_of_file_vertex), progress_(progress), loops_(loops) {}

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
      case Kind::geodesic:
        return add_geodesic(spec);
      case Kind::cut:
        return add_cut(spec);
      case Kind::segment:
        return add_segment(spec);
      case Kind::offset:
        return add_offset(spec);
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
  Index checked_loop(const SourceSpec& spec, Index loop) const;
  void add_boundary(const SourceSpec& spec);
  void add_automatic();
  void add_polyline(const SourceSpec& spec);
  void add_plane(const SourceSpec& spec);
  void add_cut(const SourceSpec& spec);
  void add_plane_at(const SourceSpec& spec, const VertexField& height, double level, const std::string& asked,
                    const std::string& allowed);
  bool add_touched(const VertexField& height, double level);
  void add_edges(const SourceSpec& spec);
  void add_geodesic(const SourceSpec& spec);
  void add_segment(const SourceSpec& spec);
  void add_offset(const SourceSpec& spec);
  SurfacePoint picked(const SourceSpec& spec, std::size_t first);
  void check_pick(const SourceSpec& spec, const Vec3& point, double distance, const char* from_what) const;
  std::vector<std::vector<Index>> chains_of(const SourceSpec& spec) const;
  void add_line(const std::vector<SurfacePoint>& line) { sources_.add_polyline(mesh_, line, false); }

  const TriangleMesh& mesh_;
  std::span<const Index> vertex_of_file_vertex_;
  Progress& progress_;
  AutoLoops loops_;
  std::optional<SurfaceLocator> locator_;
  SourceSet sources_;
};

[[noreturn]] void reject_closed(const SourceSpec& spec) {
  reject(spec, "the mesh is closed: it has no boundary", {}, "use 'auto', 'plane:...' or 'point:...'");
}

Index Maker::checked_loop(const SourceSpec& spec, Index loop) const {
  const auto n = static_cast<Index>(mesh_.boundary_loops().size());
  if (n == 0) reject_closed(spec);
  if (loop < n) return loop;
  reject(spec, "there is no such boundary loop", fmt::format("loop {} of {}", loop, n),
         fmt::format("loops are numbered 0 to {}, longest first", n - 1));
}

void Maker::add_boundary(const SourceSpec& spec) {
  const auto& loops = mesh_.boundary_loops();
  if (loops.empty()) reject_closed(spec);
  for (const Index k : spec.indices) sources_.add_halfedges(mesh_, loops[checked_loop(spec, k)], true);
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
  for (const auto& loop : mesh_.boundary_loops()) {  // the longest comes first
    char& seen = has_boundary[mesh_.component_of(TriangleMesh::face_of(loop.front()))];
    if (std::exchange(seen, 1) && loops_ == AutoLoops::longest) continue;
    sources_.add_halfedges(mesh_, loop, true);
  }
  const std::vector<Index> far = far_vertices(mesh_);
  for (Index c = 0; c < mesh_.n_components(); ++c) {
    if (!has_boundary[c]) sources_.add_vertex(mesh_, far[c]);
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
  const double scale = normal.norm();
  const auto [low, high] = range_of(mesh_, height);
  add_plane_at(spec, height, spec.numbers[3] / scale, fmt::format("D = {}", spec.numbers[3]),
               fmt::format("with this normal D may lie between {} and {}", low * scale, high * scale));
}

void Maker::add_cut(const SourceSpec& spec) {
  const bool by_point = spec.numbers.size() > 3;
  const std::size_t first_angle = by_point ? 3 : 1;
  const double tilt = first_angle + 1 < spec.numbers.size() ? spec.numbers[first_angle + 1] : 0;
  const Vec3 normal = cut_normal(degrees * spec.numbers[first_angle], degrees * tilt);
  const VertexField height = height_field(mesh_, normal);
  const auto [low, high] = range_of(mesh_, height);
  if (by_point) {
    const Vec3 through(spec.numbers[0], spec.numbers[1], spec.numbers[2]);
    const double level = normal.dot(through);
    return add_plane_at(
        spec, height, level, fmt::format("through {}, {}, {}", through.x(), through.y(), through.z()),
        fmt::format("at this angle the part lies {} to {} mm to the left of the plane", low - level, high - level));
  }
  const double middle = normal.dot(mesh_.bounds().center());
  add_plane_at(spec, height, middle + spec.numbers[0], fmt::format("offset {}", spec.numbers[0]),
               fmt::format("at this angle the offset may lie between {} and {}", low - middle, high - middle));
}

void Maker::add_plane_at(const SourceSpec& spec, const VertexField& height, double level, const std::string& asked,
                         const std::string& allowed) {
  const std::vector<Contour> cuts = isolines(mesh_, height, std::array{level}, {}, progress_);
  if (cuts.empty() && !add_touched(height, level)) {
    reject(spec, "the plane does not cut the part", asked, allowed);
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

std::vector<std::vector<Index>> Maker::chains_of(const SourceSpec& spec) const {
  auto chains = feature_chains(mesh_, degrees * spec.numbers[0]);
  if (chains.empty()) {
    reject(spec, "no two faces meet at more than this angle", fmt::format("{} degrees", spec.numbers[0]),
           "give a smaller angle");
  }
  return chains;
}

void add_chains(const TriangleMesh& mesh, const std::vector<std::vector<Index>>& chains, SourceSet& sources) {
  for (const auto& chain : chains) {
    sources.add_halfedges(mesh, chain, mesh.to(chain.back()) == mesh.from(chain.front()));
  }
}

void Maker::add_edges(const SourceSpec& spec) { add_chains(mesh_, chains_of(spec), sources_); }

void Maker::add_offset(const SourceSpec& spec) {
  SourceSet edges;
  add_chains(mesh_, chains_of(spec), edges);
  const double distance = spec.numbers[1];
  const ExactField field = ExactField::compute(mesh_, edges, {}, progress_);
  const std::vector<Contour> lines = isolines(mesh_, field, std::array{distance}, {}, progress_);
  if (lines.empty()) {
    reject(spec, "no place is this far from the feature edges", fmt::format("{} mm", distance),
           fmt::format("the farthest vertex is {} mm away", field.max_vertex_distance()));
  }
  for (const Contour& line : lines) sources_.add_polyline(mesh_, line.points, line.closed);
}

void Maker::check_pick(const SourceSpec& spec, const Vec3& point, double distance, const char* from_what) const {
  const double limit = farthest_pick_over_size * mesh_.size();
  if (distance <= limit) return;
  reject(spec, fmt::format("a point lies far from {}", from_what),
         fmt::format("{}, {}, {} is {:.6g} mm away, limit {:.6g} mm", point.x(), point.y(), point.z(), distance, limit),
         "give coordinates in mm in the frame of the part, or the unit of the mesh file when that is not mm");
}

/// The point of the surface that three of the spec's numbers pick.
SurfacePoint Maker::picked(const SourceSpec& spec, std::size_t first) {
  const Vec3 point(spec.numbers[first], spec.numbers[first + 1], spec.numbers[first + 2]);
  const SurfacePoint at = nearest(spec, point);
  check_pick(spec, point, (position_of(mesh_, at) - point).norm(), "the surface");
  return at;
}

void Maker::add_geodesic(const SourceSpec& spec) {
  const SurfacePoint a = picked(spec, 0);
  const SurfacePoint b = picked(spec, 3);
  add_line(with_spec(spec, [&] { return geodesic_through(mesh_, a, b, progress_); }));
}

void Maker::add_segment(const SourceSpec& spec) {
  Index loop = no_index;
  std::array<double, 2> share = {};
  if (!spec.indices.empty()) {
    loop = checked_loop(spec, spec.indices.front());
    share = {spec.numbers[0], spec.numbers[1]};
  } else {
    for (int end = 0; end < 2; ++end) {
      const Vec3 point(spec.numbers[3 * end], spec.numbers[3 * end + 1], spec.numbers[3 * end + 2]);
      const BoundaryPlace place = with_spec(spec, [&] { return nearest_on_boundary(mesh_, point); });
      check_pick(spec, point, place.distance, "the boundary");
      if (end == 1 && place.loop != loop) {
        reject(spec, "the points lie on different boundary loops", fmt::format("loops {} and {}", loop, place.loop),
               "give two points near the same loop");
      }
      loop = place.loop;
      share[end] = place.share;
    }
  }
  add_line(with_spec(spec, [&] { return boundary_segment(mesh_, loop, share[0], share[1]); }));
}

}  // namespace

SourceSet make_sources(const TriangleMesh& mesh, std::span<const SourceSpec> specs,
                       std::span<const Index> vertex_of_file_vertex, Progress& progress, AutoLoops loops) {
  Maker maker(mesh, vertex_of_file_vertex, progress, loops);
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
