#include <algorithm>

#include "isopath/field/exact_field_data.h"

namespace isopath {
namespace {

/// Rays that miss a window's interval by more than this part of the edge are left to its neighbours: where two windows
/// meet, the shortest way passes inside one of them, up to hair cracks from rounding.
constexpr double widest_miss = 1e-2;

/// Across a face that is lower than this part of its longest edge, and on edges themselves, ways on both sides may be
/// equally long, so that each edge keeps a front that leaves the face and none one that enters.
constexpr double flattest = 1e-6;

enum class Fronts { entering, all_on_edges, all };

/// A candidate way through an edge, in the frame of the edge's canonical half-edge.
struct Crossing {
  double x = 0;
  double distance = infinity;
  Vec2 towards = Vec2::Zero();
  bool straight = false;
};

/// Improves `best` by the straight way from p to the window's source, or by way of the nearest point of the window
/// where it misses it by a hair. p and the source lie on different sides of the edge; or the front leaves p's face by
/// the edge, and passes p before.
bool improve(const Window& w, const Vec2& p, double slack, Crossing& best) {
  const bool is_point = w.kind == Window::Kind::point;
  const Vec2 towards = is_point ? Vec2(w.source - p) : Vec2(-w.source);
  double x = p.x();
  if (towards.y() != 0) {
    x -= towards.x() * (p.y() / towards.y());
  } else if (p.y() != 0) {
    return false;  // rays along the edge pass beside p
  }
  if (x < w.begin - slack || x > w.end + slack) return false;
  if (is_point) {  // the straight line is the least that it can be
    const double left = best.distance - w.offset;
    if (left <= 0 || towards.squaredNorm() >= left * left) return false;
  }
  if (x >= w.begin && x <= w.end) {
    const double distance = is_point ? w.offset + towards.norm() : w.offset + w.source.dot(p);
    if (!(distance < best.distance)) return false;
    best = {x, distance, towards, !is_point};
    return true;
  }
  x = std::clamp(x, w.begin, w.end);
  const Vec2 back = Vec2(x, 0) - p;
  const double distance = w.distance(x) + back.norm();
  if (!(distance < best.distance)) return false;
  best = {x, distance, back};
  return true;
}

void consider_source(const ExactFieldData::PlacedSource& source, const Vec2& p, WayBack& best) {
  const Vec2 way = source.b - source.a;
  double t = 0;
  if (source.squared_length > 0) t = std::clamp((p - source.a).dot(way) / source.squared_length, 0.0, 1.0);
  const Vec2 towards = source.a + t * way - p;
  const double squared = towards.squaredNorm();
  // the ends of a segment belong to the points there
  const bool at_end = source.squared_length > 0 && (t == 0 || t == 1);
  const double bound = best.distance * best.distance;
  if (at_end ? squared >= bound : squared > bound) return;
  const double distance = std::sqrt(squared);
  if (distance < best.distance)
    best = {distance, source.id, WayBack::Stop::source, source.id, t, towards, t > 0 && t < 1};
}

void consider_sources(const ExactFieldData& data, Index face, const Vec2& p, WayBack& best) {
  // the nearest block first: what it gives rules most others out
  const auto blocks = data.source_blocks_in(face);
  std::size_t nearest = 0;
  double least = infinity;
  for (std::size_t k = 0; k < blocks.size() && blocks.size() > 1; ++k) {
    const double squared = blocks[k].box.squaredExteriorDistance(p);
    if (squared >= least) continue;
    least = squared;
    nearest = k;
  }
  const auto consider_block = [&](const ExactFieldData::SourceBlock& block) {
    for (std::size_t i = block.first; i < block.past; ++i) consider_source(data.face_sources[i], p, best);
  };
  if (!blocks.empty()) consider_block(blocks[nearest]);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    if (k != nearest && blocks[k].box.squaredExteriorDistance(p) <= best.distance * best.distance)
      consider_block(blocks[k]);
  }
}

void consider_corners(const ExactFieldData& data, Index face, const Vec3& barycentric, const Vec2& p, WayBack& best) {
  const auto& geometry = data.geometry;
  const Vec2 corners[] = {Vec2(0, 0), Vec2(geometry.length(3 * face), 0), geometry.apex(3 * face)};
  for (int i = 0; i < 3; ++i) {
    if (barycentric[(i + 1) % 3] == 0 && barycentric[(i + 2) % 3] == 0) continue;
    const Index v = data.mesh.triangle(face)[i];
    const Vec2 towards = corners[i] - p;
    const double distance = data.distance[v] + towards.norm();
    if (distance < best.distance) best = {distance, data.root[v], WayBack::Stop::vertex, v, 0, towards};
  }
}

bool lies_flat(const IntrinsicGeometry& geometry, Index face) {
  const Index h = 3 * face;
  const double longest = std::max({geometry.length(h), geometry.length(h + 1), geometry.length(h + 2)});
  return geometry.apex(h).y() * geometry.length(h) <= flattest * longest * longest;
}

/// True when a front that leaves the face of p by this window passes p before it does. The face lies above the edge, or
/// below it.
bool passes_before(const Window& w, const Vec2& p, bool above) {
  if (w.kind == Window::Kind::line) return w.offset + w.source.dot(p) >= 0;
  return above ? w.source.y() >= p.y() : w.source.y() <= p.y();
}

void consider_edge(const ExactFieldData& data, Index h, const Vec3& barycentric, Fronts fronts, WayBack& best) {
  const Index edge = data.mesh.edge_of(h);
  const double length = data.geometry.length(h);
  const bool canonical = data.mesh.halfedge_of(edge) == h;
  Vec2 p = data.geometry.in_frame(h, barycentric);
  const bool by_any = fronts == Fronts::all || (fronts == Fronts::all_on_edges && p.y() <= flattest * length);
  if (by_any && p.y() <= data.geometry.rounding()) p.y() = 0;  // so is a source that is as near
  if (!canonical) p = Vec2(length - p.x(), -p.y());
  Crossing crossing;
  crossing.distance = best.distance;
  Index root = no_index;
  bool found = false;
  // a way through the edge is at least as long as its part in this face
  const double squared_width = best.distance * best.distance - p.y() * p.y();
  if (squared_width < 0) return;
  const double width = std::sqrt(squared_width);
  data.for_each_window(edge, p.x() - width, p.x() + width, [&](const Window& w) {
    if (w.halfedge != h && !(by_any && passes_before(w, p, canonical))) return;
    if (!improve(w, p, widest_miss * length, crossing)) return;
    found = true;
    root = w.root;
  });
  if (!found) return;
  best = {crossing.distance, root, WayBack::Stop::edge, h, crossing.x, crossing.towards, crossing.straight};
  if (!canonical) {
    best.x = length - best.x;
    best.towards = -best.towards;
  }
}

}  // namespace

WayBack best_way_back(const ExactFieldData& data, Index face, const Vec3& barycentric, const SkippedEdges& skipped) {
  WayBack best;
  const auto& geometry = data.geometry;
  const Vec2 p = geometry.in_frame(3 * face, barycentric);
  consider_sources(data, face, p, best);
  consider_corners(data, face, barycentric, p, best);
  const Fronts fronts =
      skipped.leaving ? Fronts::entering : (lies_flat(geometry, face) ? Fronts::all : Fronts::all_on_edges);
  for (int i = 0; i < 3; ++i) {
    if (!skipped.skip[i]) consider_edge(data, 3 * face + i, barycentric, fronts, best);
  }
  if (best.stop == WayBack::Stop::edge && best.at != 3 * face) {
    // into the frame of half-edge 3·face
    const Vec2 tail = best.at == 3 * face + 1 ? Vec2(geometry.length(3 * face), 0) : geometry.apex(3 * face);
    const Vec2 head = best.at == 3 * face + 1 ? geometry.apex(3 * face) : Vec2(Vec2::Zero());
    const Vec2 axis = (head - tail) / geometry.length(best.at);
    best.towards = axis * best.towards.x() + Vec2(-axis.y(), axis.x()) * best.towards.y();
  }
  return best;
}

}  // namespace isopath
