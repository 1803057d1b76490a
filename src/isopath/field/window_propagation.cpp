#include "isopath/field/window_propagation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace isopath {
namespace {

constexpr double pi = std::numbers::pi;
/// Angles are sums of a few arcus tangents, each good to 1e-16; a fan is opened this much wider than its shadow.
constexpr double angle_slack = 1e-12;

/// See WindowPropagation: relative to the edge, and not below what coordinates of this model can resolve.
std::vector<double> snap_widths(const TriangleMesh& mesh) {
  std::vector<double> snap(mesh.n_edges());
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    snap[e] = std::min(0.25 * mesh.edge_length(e), std::max(1e-11 * mesh.edge_length(e), 2e-14 * mesh.size()));
  }
  return snap;
}

std::vector<double> to_vector(std::span<const double> values) { return {values.begin(), values.end()}; }

/// Fraction along p → q where the ray from s in direction d passes; clamped to the segment.
double hit_fraction(const Vec2& p, const Vec2& q, const Vec2& s, const Vec2& d) {
  const double at_p = cross(d, p - s);
  const double at_q = cross(d, q - s);
  if (at_p == at_q) return 0;
  return std::clamp(at_p / (at_p - at_q), 0.0, 1.0);
}

}  // namespace

WindowPropagation::WindowPropagation(const TriangleMesh& mesh, const IntrinsicGeometry& geometry,
                                     const SourceSet& sources, const MergeLimits& limits)
    : mesh_(mesh),
      geometry_(geometry),
      windows_(to_vector(mesh.edge_lengths()), snap_widths(mesh), limits),
      distance_(mesh.n_vertices(), infinity),
      root_(mesh.n_vertices(), no_index),
      arrival_(mesh.n_vertices()),
      settled_(mesh.n_vertices(), 0),
      fans_(mesh.n_halfedges()),
      source_at_(mesh.n_vertices(), no_index),
      size_(mesh.size()) {
  start(sources);
}

void WindowPropagation::run(double stop_distance, Progress& progress) {
  std::size_t events = 0;
  Index vertices_settled = 0;
  while (!queue_.empty()) {
    const Event event = queue_.top();
    if (event.distance > stop_distance) break;
    queue_.pop();
    if (event.id < 0) {
      const Index vertex = ~event.id;
      if (settled_[vertex]) continue;
      settled_[vertex] = 1;
      ++vertices_settled;
      settle_vertex(vertex);
    } else if (windows_[event.id].pending) {
      windows_[event.id].pending = false;
      ++propagated_;
      propagate(event.id);
    }
    if (++events % 4096 == 0) {
      progress.checkpoint();
      progress.at(static_cast<double>(vertices_settled) / mesh_.n_vertices());
    }
  }
  progress.at(1);
}

void WindowPropagation::insert(Index edge, const Window& canonical) {
  const double length = geometry_.length(mesh_.halfedge_of(edge));
  for (const Index id : windows_.insert(edge, canonical)) {
    const Window& window = windows_[id];
    if (window.pending) queue_.push({window.min_distance(), id});
    const Index h = mesh_.halfedge_of(edge);
    // The way back to the source, turned into the frame whose x axis leaves the vertex. It lies on the side that the
    // front came from: where it goes straight back along the line of the edge, the sign of y knows nothing.
    const bool from_face_of_h = window.halfedge != h;
    const auto turn_of = [](const Vec2& back, bool left) {
      const double turn = std::atan2(std::abs(back.y()), back.x());
      return left ? turn : -turn;
    };
    if (window.begin == 0) {
      offer_vertex(mesh_.from(h), window.distance(0), window.root,
                   {h, window.error, turn_of(-window.direction(0), from_face_of_h)});
    }
    if (window.end == length) {
      const Index outgoing = mesh_.twin(h) != no_index ? mesh_.twin(h) : TriangleMesh::next(h);
      double turn = turn_of(window.direction(length), !from_face_of_h);
      // on the boundary the edge is the last of the fan: measure from the half-edge before it
      if (mesh_.twin(h) == no_index) turn += geometry_.angle_at_tail(outgoing);
      offer_vertex(mesh_.to(h), window.distance(length), window.root, {outgoing, window.error, turn});
    }
  }
}

void WindowPropagation::insert_leaving(Index halfedge, Window window) {
  const Index edge = mesh_.edge_of(halfedge);
  window.halfedge = window.filler ? no_index : mesh_.twin(halfedge);
  insert(edge, mesh_.halfedge_of(edge) == halfedge ? window : window.flipped(geometry_.length(halfedge)));
}

void WindowPropagation::offer_vertex(Index vertex, double distance, Index root, const Arrival& arrival) {
  distance = std::max(distance, 0.0);  // a straight front may round to just below its own segment
  if (distance >= distance_[vertex] || settled_[vertex]) return;
  distance_[vertex] = distance;
  root_[vertex] = root;
  arrival_[vertex] = arrival;
  queue_.push({distance, ~vertex});
}

double WindowPropagation::total_angle(Index vertex) const {
  double sum = 0;
  Index h = mesh_.outgoing(vertex);
  do {
    sum += geometry_.angle_at_tail(h);
    h = mesh_.next_outgoing(h);
  } while (h != no_index && h != mesh_.outgoing(vertex));
  return sum;
}

double WindowPropagation::arrival_angle(Index vertex) const {
  double sum = 0;
  for (Index h = mesh_.outgoing(vertex); h != arrival_[vertex].halfedge; h = mesh_.next_outgoing(h))
    sum += geometry_.angle_at_tail(h);
  return sum + arrival_[vertex].turn;
}

void WindowPropagation::settle_vertex(Index vertex) {
  const double total = total_angle(vertex);
  if (source_at_[vertex] != no_index) {
    emit_fan(vertex, total, source_arcs_[source_at_[vertex]]);
  } else if (total > (mesh_.is_boundary_vertex(vertex) ? pi : 2 * pi) + angle_slack) {
    const BlockedArc shadowless{arrival_angle(vertex), pi - angle_slack};
    emit_fan(vertex, total, {&shadowless, 1});
  }
  follow_edges(vertex);
}

void WindowPropagation::follow_edges(Index vertex) {
  const auto follow = [&](Index h) {
    const double length = geometry_.length(h);
    Window window;
    window.end = length;
    window.offset = distance_[vertex];
    window.error = arrival_[vertex].error;
    window.root = root_[vertex];
    window.filler = true;
    insert_leaving(h, window);
  };
  Index h = mesh_.outgoing(vertex);
  Index last = no_index;
  do {
    follow(h);
    last = h;
    h = mesh_.next_outgoing(h);
  } while (h != no_index && h != mesh_.outgoing(vertex));
  if (h != no_index) return;
  // the boundary edge that closes the fan arrives at the vertex
  const Index arriving = TriangleMesh::prev(last);
  Window window;
  window.end = geometry_.length(arriving);
  window.source.x() = window.end;
  window.offset = distance_[vertex];
  window.error = arrival_[vertex].error;
  window.root = root_[vertex];
  window.filler = true;
  insert_leaving(arriving, window);
}

void WindowPropagation::emit_fan(Index vertex, double total, std::span<const BlockedArc> blocked) {
  const int turns = mesh_.is_boundary_vertex(vertex) ? 0 : 2;
  double start = 0;
  Index h = mesh_.outgoing(vertex);
  do {
    const double angle = geometry_.angle_at_tail(h);
    // From one blocked arc to the next: what they leave of [0, angle] in this face. A fan has few arcs.
    for (double low = 0; low < angle;) {
      double high = angle;
      double past = low;
      for (const BlockedArc& arc : blocked) {
        for (int turn = -turns; turn <= turns; ++turn) {
          const double arc_low = arc.angle - arc.half_width - start + turn * total;
          const double arc_high = arc.angle + arc.half_width - start + turn * total;
          if (arc_low <= low && arc_high > past) past = arc_high;
          if (arc_low > low) high = std::min(high, arc_low);
        }
      }
      if (past > low) {
        low = past;
        continue;
      }
      fans_[h] = {std::min(fans_[h].low, low), std::max(fans_[h].high, high)};
      emit_into_face(h, low > 0 ? low : -1, high < angle ? high : infinity);
      low = high;
    }
    start += angle;
    h = mesh_.next_outgoing(h);
  } while (h != no_index && h != mesh_.outgoing(vertex));
}

void WindowPropagation::emit_into_face(Index outgoing, double low, double high) {
  const Index opposite = TriangleMesh::next(outgoing);
  const Vec2 p(geometry_.length(outgoing), 0);
  const Vec2& q = geometry_.apex(outgoing);
  const double length = geometry_.length(opposite);
  const auto at_angle = [&](double angle) {
    return hit_fraction(p, q, Vec2::Zero(), Vec2(std::cos(angle), std::sin(angle))) * length;
  };
  const Index vertex = mesh_.from(outgoing);
  Window window;
  window.begin = low < 0 ? 0 : at_angle(low);
  window.end = high == infinity ? length : at_angle(high);
  window.source = geometry_.apex(opposite);
  window.offset = distance_[vertex];
  window.error = arrival_[vertex].error;
  window.root = root_[vertex];
  insert_leaving(opposite, window);
}

void WindowPropagation::propagate(Index id) {
  const Window& stored = windows_[id];
  const Index h = stored.halfedge;
  const double length = geometry_.length(h);
  const Window window = mesh_.halfedge_of(mesh_.edge_of(h)) == h ? stored : stored.flipped(length);

  const Vec2& apex = geometry_.apex(h);
  const Index right = TriangleMesh::next(h);  // from the head of h to the apex
  const Index left = TriangleMesh::prev(h);   // from the apex to the tail of h
  const bool is_point = window.kind == Window::Kind::point;
  const Vec2 begin_ray = is_point ? Vec2(Vec2(window.begin, 0) - window.source) : window.source;
  const Vec2 end_ray = is_point ? Vec2(Vec2(window.end, 0) - window.source) : window.source;
  const Vec2 begin_origin = is_point ? window.source : Vec2(window.begin, 0);
  const Vec2 end_origin = is_point ? window.source : Vec2(window.end, 0);
  // a ray through an end of the edge leaves through that end, whatever rounding says
  const bool from_tail = window.begin == 0;
  const bool to_head = window.end == length;
  const bool apex_right_of_begin = cross(begin_ray, apex - begin_origin) < 0;
  const bool apex_left_of_end = cross(end_ray, apex - end_origin) > 0;

  const Vec2 tail(0, 0);
  const Vec2 head(length, 0);
  if (apex_right_of_begin) {
    // the part of the beam left of the apex: along `left`, from the apex down to the tail
    const double width = geometry_.length(left);
    Window child = window;
    child.begin = apex_left_of_end ? 0 : hit_fraction(apex, tail, end_origin, end_ray) * width;
    child.end = from_tail ? width : hit_fraction(apex, tail, begin_origin, begin_ray) * width;
    propagate_to(left, child, apex, tail);
  }
  if (apex_left_of_end) {
    const double width = geometry_.length(right);
    Window child = window;
    child.begin = to_head ? 0 : hit_fraction(head, apex, end_origin, end_ray) * width;
    child.end = apex_right_of_begin ? width : hit_fraction(head, apex, begin_origin, begin_ray) * width;
    propagate_to(right, child, head, apex);
  }
}

void WindowPropagation::propagate_to(Index halfedge, const Window& window, const Vec2& p, const Vec2& q) {
  if (!(window.begin < window.end)) return;
  const double length = geometry_.length(halfedge);
  const Vec2 axis = (q - p) / length;
  Window child = window;
  if (window.kind == Window::Kind::point) {
    const Vec2 s = window.source - p;
    child.source = Vec2(axis.dot(s), cross(axis, s));
  } else {
    child.source = Vec2(axis.dot(window.source), cross(axis, window.source));
    child.offset = window.offset + window.source.dot(p);
  }
  if (hopeless(halfedge, child)) return;
  insert_leaving(halfedge, child);
}

bool WindowPropagation::hopeless(Index halfedge, const Window& window) const {
  // Xin & Wang 2009: an end that is nearer by way of a corner of the edge condemns all points between that end and the
  // corner.
  const double margin = 1e-12 * size_ + window.error;
  const double length = geometry_.length(halfedge);
  const Index from = mesh_.from(halfedge);
  const Index to = mesh_.to(halfedge);
  return window.distance(window.end) > distance_[from] + arrival_[from].error + window.end + margin ||
         window.distance(window.begin) > distance_[to] + arrival_[to].error + (length - window.begin) + margin;
}

}  // namespace isopath
