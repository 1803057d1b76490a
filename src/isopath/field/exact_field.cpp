#include "isopath/field/exact_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "isopath/core/error.h"
#include "isopath/core/side_by_side.h"
#include "isopath/field/exact_field_data.h"
#include "isopath/field/list_propagation.h"

namespace isopath {
namespace {

/// Calls visit(face) for every face that holds the point.
template <class Visit>
void for_each_face_at(const TriangleMesh& mesh, const SurfacePoint& point, Visit&& visit) {
  const Support support = support_of(mesh, point);
  if (support.kind == Support::Kind::vertex) {
    const Index start = mesh.outgoing(support.index);
    for (Index h = start; h != no_index;) {
      visit(TriangleMesh::face_of(h));
      h = mesh.next_outgoing(h);
      if (h == start) break;
    }
    return;
  }
  visit(point.face);
  if (support.kind == Support::Kind::edge && mesh.twin(support.index) != no_index) {
    visit(TriangleMesh::face_of(mesh.twin(support.index)));
  }
}

/// Lists the source elements of every face they touch.
void index_sources(ExactFieldData& data) {
  const auto elements = data.sources.elements();
  std::vector<std::pair<Index, Index>> pairs;
  for (Index id = 0; id < static_cast<Index>(elements.size()); ++id) {
    const SourceElement& element = elements[id];
    if (element.kind == SourceElement::Kind::point) {
      for_each_face_at(data.mesh, element.a, [&](Index f) { pairs.emplace_back(f, id); });
      continue;
    }
    SurfacePoint middle = element.a;
    middle.barycentric = 0.5 * (element.a.barycentric + element.b.barycentric);
    for_each_face_at(data.mesh, middle, [&](Index f) { pairs.emplace_back(f, id); });
  }
  std::sort(pairs.begin(), pairs.end());
  data.first_source.assign(data.mesh.n_faces() + 1, 0);
  for (const auto& [f, id] : pairs) {
    ++data.first_source[f + 1];
    // a point on an edge or vertex may be stored with a neighbouring face; so may a segment along an edge
    const auto place = [&, face = f](const SurfacePoint& point) {
      return data.geometry.in_frame(3 * face, express_in(data.mesh, point, face).barycentric);
    };
    ExactFieldData::PlacedSource source{.id = id, .a = place(elements[id].a)};
    source.b = elements[id].kind == SourceElement::Kind::segment ? place(elements[id].b) : source.a;
    source.squared_length = (source.b - source.a).squaredNorm();
    data.face_sources.push_back(source);
  }
  for (Index f = 0; f < data.mesh.n_faces(); ++f) data.first_source[f + 1] += data.first_source[f];
  constexpr std::size_t block = 16;
  data.first_block.assign(1, 0);
  for (Index f = 0; f < data.mesh.n_faces(); ++f) {
    for (std::size_t i = data.first_source[f]; i < data.first_source[f + 1]; i += block) {
      ExactFieldData::SourceBlock& part = data.source_blocks.emplace_back();
      part.first = i;
      part.past = std::min(i + block, data.first_source[f + 1]);
      for (std::size_t k = part.first; k < part.past; ++k)
        part.box.extend(data.face_sources[k].a).extend(data.face_sources[k].b);
    }
    data.first_block.push_back(data.source_blocks.size());
  }
}

/// The convex cone that some directions span, while they lie in one open half-plane.
class DirectionCone {
 public:
  /// False when the directions no longer do.
  bool add(const Vec2& d) {
    if (right_ == Vec2::Zero()) right_ = left_ = d;
    const bool left_of_right = cross(right_, d) >= 0;
    const bool right_of_left = cross(d, left_) >= 0;
    if (!left_of_right && !right_of_left) return false;
    if (!left_of_right) right_ = d;
    if (!right_of_left) left_ = d;
    const auto less_than_half_turn = [](const Vec2& a, const Vec2& b) {
      return cross(a, b) > rounding || a.dot(b) > 0;
    };
    return less_than_half_turn(right_, left_) && less_than_half_turn(right_, d);
  }

 private:
  static constexpr double rounding = 1e-9;
  Vec2 right_ = Vec2::Zero();
  Vec2 left_ = Vec2::Zero();
};

/// Merging is to last until the farthest point; paths along edges tell about how far that is.
MergeLimits merge_limits(const ListPropagation& propagation, double size, const ExactFieldOptions& options,
                         Progress& progress) {
  if (options.accuracy == 0) return {.size = size};
  constexpr double across = 0.85;  // surfaces are crossed a little faster than along edges
  double reach = options.expected_reach;
  if (!(reach > 0)) reach = across * propagation.reach_along_edges(options.stop_distance / across, progress);
  return {.accuracy = options.accuracy, .size = size, .reach = std::min(options.stop_distance, reach)};
}

}  // namespace

void ExactFieldOptions::validate() const {
  if (accuracy >= 0 && accuracy < infinity) return;
  throw Error(ErrorCode::bad_usage, "accuracy of a distance field is not a length",
              {.element = "accuracy",
               .value = fmt::format("{} mm", accuracy),
               .advice = "give 0 for exact distances, or for example 1e-6 of the model's size"});
}

ExactField::ExactField(std::unique_ptr<ExactFieldData> data) : data_(std::move(data)) {}
ExactField::ExactField(ExactField&&) noexcept = default;
ExactField& ExactField::operator=(ExactField&&) noexcept = default;
ExactField::~ExactField() = default;

ExactField ExactField::compute(const TriangleMesh& mesh, const SourceSet& sources, const ExactFieldOptions& options,
                               Progress& progress) {
  return run(std::make_unique<ExactFieldData>(mesh, IntrinsicGeometry(mesh), sources), options, progress);
}

ExactField ExactField::compute(const TriangleMesh& mesh, IntrinsicGeometry metric, const SourceSet& sources,
                               const ExactFieldOptions& options, Progress& progress) {
  return run(std::make_unique<ExactFieldData>(mesh, std::move(metric), sources), options, progress);
}

ExactField ExactField::run(std::unique_ptr<ExactFieldData> data, const ExactFieldOptions& options, Progress& progress) {
  const SourceSet& sources = data->sources;
  if (sources.empty()) throw Error(ErrorCode::bad_usage, "a distance field needs at least one source");
  options.validate();
  SourceFronts fronts;
  std::optional<ListPropagation> room;
  side_by_side([&] { index_sources(*data); },
               [&] {
                 fronts = source_fronts(data->mesh, data->geometry, sources, progress);
                 room.emplace(data->mesh, data->geometry, true);
               });
  ListPropagation& propagation = *room;
  propagation.start(fronts);
  propagation.merge_within(merge_limits(propagation, data->geometry.size(), options, progress));
  propagation.run(options.stop_distance, progress);
  data->propagated = propagation.propagated();
  data->windows = propagation.take_windows(progress);
  data->distance = propagation.vertex_distances();
  data->root = propagation.vertex_roots();
  data->fans = propagation.fans();
  if (options.many_questions) data->trees = FaceTrees(*data, progress);
  data->reach = options.stop_distance;
  ExactField field(std::move(data));
#ifndef NDEBUG
  field.verify();
#endif
  return field;
}

const TriangleMesh& ExactField::mesh() const { return data_->mesh; }
const IntrinsicGeometry& ExactField::geometry() const { return data_->geometry; }
std::span<const double> ExactField::vertex_distances() const { return data_->distance; }
std::size_t ExactField::windows_kept() const { return data_->windows.size(); }
std::size_t ExactField::windows_propagated() const { return data_->propagated; }
double ExactField::max_slope() const { return data_->geometry.max_stretch(); }
double ExactField::value_at_vertex(Index vertex) const { return data_->distance[vertex]; }
double ExactField::value(const SurfacePoint& point) const {
  const Support support = support_of(data_->mesh, point);
  if (support.kind == Support::Kind::vertex) return data_->distance[support.index];
  return best_way_back(*data_, point.face, point.barycentric).distance;
}

double ExactField::max_vertex_distance() const {
  double largest = 0;
  for (const double d : data_->distance) {
    if (d < infinity) largest = std::max(largest, d);
  }
  return largest;
}

ExactField::Nearest ExactField::nearest(const SurfacePoint& point) const {
  const Support support = support_of(data_->mesh, point);
  const WayBack way = best_way_back(*data_, point.face, point.barycentric);
  Nearest result{way.distance, way.root};
  if (way.towards != Vec2::Zero())
    result.towards_source = data_->geometry.direction_in_space(data_->mesh, point.face, way.towards.normalized());
  if (support.kind == Support::Kind::vertex) {
    result.distance = data_->distance[support.index];
    result.root = data_->root[support.index];
  }
  return result;
}

SurfaceFunction::Slope ExactField::slope(const SurfacePoint& point) const {
  const Nearest nearest_source = nearest(point);
  return {nearest_source.distance, -nearest_source.towards_source};
}

void ExactField::edge_crossings(Index edge, double level, std::vector<double>& parameters) const {
  const std::span<const Window> windows = data_->windows.of(edge);
  const Index h = data_->mesh.halfedge_of(edge);
  const double length = data_->geometry.length(h);
  bool above = data_->distance[data_->mesh.from(h)] >= level;
  const bool ends_above = data_->distance[data_->mesh.to(h)] >= level;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const Window& w = windows[i];
    const bool above_after = i + 1 == windows.size()
                                 ? ends_above
                                 : std::min(w.distance(w.end), windows[i + 1].distance(windows[i + 1].begin)) >= level;
    const double r = level - w.offset;
    const auto add = [&](double x) { parameters.push_back(std::clamp(x, w.begin, w.end) / length); };
    if (above != above_after) {
      if (w.kind == Window::Kind::line) {
        add(w.source.x() != 0 ? r / w.source.x() : 0.5 * (w.begin + w.end));
      } else {
        const double half = std::sqrt(std::max(0.0, r * r - w.source.y() * w.source.y()));
        add(above ? w.source.x() - half : w.source.x() + half);
      }
    } else if (above && w.kind == Window::Kind::point && w.min_distance() < level) {
      const double half = std::sqrt(std::max(0.0, r * r - w.source.y() * w.source.y()));
      add(w.source.x() - half);
      add(w.source.x() + half);
    }
    above = above_after;
  }
}

bool ExactField::monotone_in_face(Index face) const {
  // The distance is a least one of fronts; where all their directions lie in one open half-plane it grows along its
  // axis everywhere.
  if (!data_->sources_in(face).empty()) return false;
  const auto& geometry = data_->geometry;
  const Vec2 corners[] = {Vec2(0, 0), Vec2(geometry.length(3 * face), 0), geometry.apex(3 * face)};
  DirectionCone cone;
  for (int i = 0; i < 3; ++i) {
    const Index h = 3 * face + i;
    const Vec2 axis = (corners[(i + 1) % 3] - corners[i]) / geometry.length(h);
    const auto add = [&](const Vec2& d) { return cone.add(axis * d.x() + Vec2(-axis.y(), axis.x()) * d.y()); };
    const FanArc& fan = data_->fans[h];
    for (const double angle : {fan.low, fan.high}) {
      if (fan.low <= fan.high && !add(Vec2(std::cos(angle), std::sin(angle)))) return false;
    }
    const Index edge = data_->mesh.edge_of(h);
    const double sign = data_->mesh.halfedge_of(edge) == h ? 1 : -1;
    for (const Window& w : data_->windows.of(edge)) {
      if (w.halfedge != h) continue;
      if (!add(sign * w.direction(w.begin)) || !add(sign * w.direction(w.end))) return false;
    }
  }
  return true;
}

std::vector<SurfacePoint> ExactField::shortest_path(const SurfacePoint& point) const {
  std::vector<SurfacePoint> path{point};
  if (value(point) == infinity) return {};
  const std::size_t most_steps = 16 * static_cast<std::size_t>(data_->mesh.n_faces()) + 16;
  while (path.size() < most_steps) {
    const SurfacePoint here = path.back();
    const Support support = support_of(data_->mesh, here);
    if (support.kind == Support::Kind::vertex && data_->distance[support.index] == 0) break;
    WayBack best;
    SurfacePoint from;
    for_each_face_at(data_->mesh, here, [&](Index face) {
      const SurfacePoint p = express_in(data_->mesh, here, face);
      SkippedEdges skipped{.leaving = true};
      for (int i = 0; i < 3; ++i) {
        skipped.skip[i] = p.barycentric[(i + 2) % 3] == 0;
      }
      const WayBack way = best_way_back(*data_, face, p.barycentric, skipped);
      if (way.distance < best.distance) {
        best = way;
        from = p;
      }
    });
    if (best.stop == WayBack::Stop::none) break;
    if (best.stop == WayBack::Stop::vertex) {
      path.push_back(point_at_vertex(data_->mesh, best.at));
    } else if (best.stop == WayBack::Stop::edge) {
      const double t = std::clamp(best.x / data_->geometry.length(best.at), 0.0, 1.0);
      path.push_back(t == 0 || t == 1
                         ? point_at_vertex(data_->mesh, t == 0 ? data_->mesh.from(best.at) : data_->mesh.to(best.at))
                         : point_on_halfedge(best.at, t));
    } else {
      const SourceElement& element = data_->sources.elements()[best.at];
      SurfacePoint end = express_in(data_->mesh, element.a, from.face);
      const SurfacePoint b = express_in(data_->mesh, element.b, from.face);
      end.barycentric = (1 - best.x) * end.barycentric + best.x * b.barycentric;
      if (end.barycentric != from.barycentric) path.push_back(end);
      break;
    }
  }
  return path;
}

}  // namespace isopath
