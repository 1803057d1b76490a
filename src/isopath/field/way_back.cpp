#include "isopath/field/way_back.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace isopath {
namespace {

/// Rays that miss a window's interval by more than this part of the edge are left to its neighbours: where two windows
/// meet, the shortest way passes inside one of them, up to hair cracks from rounding.
constexpr double widest_miss = 1e-2;

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

void consider_source(const ExactFieldData& data, std::size_t index, const Vec2& p, WayBack& best) {
  const ExactFieldData::PlacedSource& source = data.face_sources[index];
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
    best = {distance, source.id, WayBack::Stop::source, source.id, t, towards, t > 0 && t < 1, index};
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
    for (std::size_t i = block.first; i < block.past; ++i) consider_source(data, i, p, best);
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
    if (data.distance[v] >= best.distance) continue;
    const Vec2 towards = corners[i] - p;
    const double distance = data.distance[v] + towards.norm();
    if (distance < best.distance) best = {distance, data.root[v], WayBack::Stop::vertex, v, 0, towards};
  }
}

/// True when a front that leaves the face of p by this window passes p before it does. The face lies above the edge, or
/// below it.
bool passes_before(const Window& w, const Vec2& p, bool above) {
  if (w.kind == Window::Kind::line) return w.offset + w.source.dot(p) >= 0;
  return above ? w.source.y() >= p.y() : w.source.y() <= p.y();
}

/// Looks for the best way through one edge of the face of a point.
class EdgeSearch {
 public:
  EdgeSearch(const ExactFieldData& data, Index h, const Vec3& barycentric, Fronts fronts)
      : h_(h), length_(data.geometry.length(h)), p_(data.geometry.in_frame(h, barycentric)) {
    by_any_ = fronts == Fronts::all || (fronts == Fronts::all_on_edges && p_.y() <= flattest_face * length_);
    if (by_any_ && p_.y() <= data.geometry.rounding()) p_.y() = 0;  // so is a source that is as near
    canonical_ = data.mesh.halfedge_of(data.mesh.edge_of(h)) == h;
    if (!canonical_) p_ = Vec2(length_ - p_.x(), -p_.y());
  }

  /// In the frame of the edge's canonical half-edge.
  const Vec2& point() const { return p_; }

  void start(double bound) { crossing_.distance = bound; }
  void consider(const Window& w) {
    if (w.halfedge != h_ && !(by_any_ && passes_before(w, p_, canonical_))) return;
    if (improve(w, p_, widest_miss * length_, crossing_)) window_ = &w;
  }
  void finish(WayBack& best) const {
    if (window_ == nullptr) return;
    best = {.distance = crossing_.distance,
            .root = window_->root,
            .stop = WayBack::Stop::edge,
            .at = h_,
            .x = crossing_.x,
            .towards = crossing_.towards,
            .straight = crossing_.straight,
            .window = window_};
    if (canonical_) return;
    best.x = length_ - best.x;
    best.towards = -best.towards;
  }

 private:
  Index h_;
  double length_;
  Vec2 p_;
  bool by_any_ = false;
  bool canonical_ = false;
  Crossing crossing_;
  const Window* window_ = nullptr;
};

void consider_edge(const ExactFieldData& data, Index h, const Vec3& barycentric, Fronts fronts, WayBack& best) {
  EdgeSearch search(data, h, barycentric, fronts);
  // a way through the edge is at least as long as its part in this face
  const Vec2& p = search.point();
  const double squared_width = best.distance * best.distance - p.y() * p.y();
  if (squared_width < 0) return;
  const double width = std::sqrt(squared_width);
  search.start(best.distance);
  data.windows.for_each(data.mesh.edge_of(h), p.x() - width, p.x() + width,
                        [&](const Window& w) { search.consider(w); });
  search.finish(best);
}

Fronts fronts_for(const ExactFieldData& data, Index face, const SkippedEdges& skipped) {
  if (skipped.leaving) return Fronts::entering;
  return lies_flat(data.geometry, face) ? Fronts::all : Fronts::all_on_edges;
}

/// Where fronts that leave the face count, too.
bool touches_edge(const IntrinsicGeometry& geometry, Index face, const Vec3& barycentric) {
  for (Index h = 3 * face; h < 3 * face + 3; ++h) {
    if (geometry.in_frame(h, barycentric).y() <= flattest_face * geometry.length(h)) return true;
  }
  return false;
}

/// `towards` from the frame of the half-edge that the way goes through into that of half-edge 3·face.
void turn_into_face(const IntrinsicGeometry& geometry, Index face, WayBack& best) {
  if (best.stop != WayBack::Stop::edge || best.at == 3 * face) return;
  const Vec2 tail = best.at == 3 * face + 1 ? Vec2(geometry.length(3 * face), 0) : geometry.apex(3 * face);
  const Vec2 head = best.at == 3 * face + 1 ? geometry.apex(3 * face) : Vec2(Vec2::Zero());
  const Vec2 axis = (head - tail) / geometry.length(best.at);
  best.towards = axis * best.towards.x() + Vec2(-axis.y(), axis.x()) * best.towards.y();
}

}  // namespace

bool lies_flat(const IntrinsicGeometry& geometry, Index face) {
  const Index h = 3 * face;
  const double longest = std::max({geometry.length(h), geometry.length(h + 1), geometry.length(h + 2)});
  return geometry.apex(h).y() * geometry.length(h) <= flattest_face * longest * longest;
}

double way_by(const Window& w, const Vec2& p) {
  const bool is_point = w.kind == Window::Kind::point;
  const Vec2 towards = is_point ? Vec2(w.source - p) : Vec2(-w.source);
  const double straight = is_point ? w.offset + towards.norm() : w.offset + w.source.dot(p);
  if (towards.y() == 0) return straight;
  const double x = p.x() - towards.x() * (p.y() / towards.y());
  if (x >= w.begin && x <= w.end) return straight;
  const double nearest = std::clamp(x, w.begin, w.end);
  return w.distance(nearest) + (Vec2(nearest, 0) - p).norm();
}

double squared_distance(const ExactFieldData::PlacedSource& source, const Vec2& p) {
  const Vec2 way = source.b - source.a;
  double t = 0;
  if (source.squared_length > 0) t = std::clamp((p - source.a).dot(way) / source.squared_length, 0.0, 1.0);
  return (source.a + t * way - p).squaredNorm();
}

WayBack best_way_back_among(const ExactFieldData& data, Index face, const Vec3& barycentric,
                            std::span<const NearCandidate> candidates, const SkippedEdges& skipped) {
  WayBack best;
  const Vec2 p = data.geometry.in_frame(3 * face, barycentric);
  auto next = candidates.begin();
  for (; next != candidates.end() && next->where() == NearCandidate::in_face; ++next)
    consider_source(data, data.first_source[face] + next->number(), p, best);
  consider_corners(data, face, barycentric, p, best);
  const Fronts fronts = fronts_for(data, face, skipped);
  while (next != candidates.end()) {
    const unsigned corner = next->where();
    const Index h = 3 * face + static_cast<Index>(corner);
    const std::span<const Window> windows = data.windows.of(data.mesh.edge_of(h));
    EdgeSearch search(data, h, barycentric, fronts);
    search.start(best.distance);
    for (; next != candidates.end() && next->where() == corner; ++next) {
      if (!skipped.skip[corner]) search.consider(windows[next->number()]);
    }
    search.finish(best);
  }
  turn_into_face(data.geometry, face, best);
  return best;
}

WayBack best_way_back(const ExactFieldData& data, Index face, const Vec3& barycentric, const SkippedEdges& skipped) {
  const Vec2 p = data.geometry.in_frame(3 * face, barycentric);
  const auto part = data.trees.part_at(face, p);
  if (part && !touches_edge(data.geometry, face, barycentric)) {
    const WayBack best = best_way_back_among(data, face, barycentric, part->candidates, skipped);
    if (best.distance <= part->bound) return best;
  }
  WayBack best;
  consider_sources(data, face, p, best);
  consider_corners(data, face, barycentric, p, best);
  const Fronts fronts = fronts_for(data, face, skipped);
  for (int i = 0; i < 3; ++i) {
    if (!skipped.skip[i]) consider_edge(data, 3 * face + i, barycentric, fronts, best);
  }
  turn_into_face(data.geometry, face, best);
  return best;
}

}  // namespace isopath
