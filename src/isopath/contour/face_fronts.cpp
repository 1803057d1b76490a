#include "isopath/contour/face_fronts.h"

#include <algorithm>
#include <cmath>

namespace isopath {

Vec2 Front::direction(const Vec2& p) const {
  if (straight) return source;
  const Vec2 d = p - source;
  const double r = d.norm();
  return r > 0 ? Vec2(d / r) : Vec2(Vec2::Zero());
}

double angle_between(const Front& a, const Front& b, const Vec2& p) {
  const Vec2 u = a.direction(p);
  const Vec2 v = b.direction(p);
  return std::atan2(std::abs(cross(u, v)), u.dot(v));
}

FaceFronts::FaceFronts(const ExactFieldData& data, Index face)
    : data_(data),
      face_(face),
      corners_{Vec2(0, 0), Vec2(data.geometry.length(3 * face), 0), data.geometry.apex(3 * face)} {}

double FaceFronts::flatness() const {
  double longest = 0;
  for (int i = 0; i < 3; ++i) longest = std::max(longest, data_.geometry.length(3 * face_ + i));
  return 2 * data_.geometry.face_area(face_) / (longest * longest);
}

bool FaceFronts::contains(const Vec2& p, double slack) const {
  for (int i = 0; i < 3; ++i) {
    const Vec2 along = corners_[(i + 1) % 3] - corners_[i];
    if (cross(along, p - corners_[i]) < -slack * along.norm()) return false;
  }
  return true;
}

SurfacePoint FaceFronts::surface_point(const Vec2& p) const {
  Vec3 b;
  b[2] = p.y() / corners_[2].y();
  b[1] = (p.x() - corners_[2].x() * b[2]) / corners_[1].x();
  b[0] = 1 - b[1] - b[2];
  b = b.cwiseMax(0);
  return {face_, b / b.sum()};
}

Vec2 FaceFronts::plane(const SurfacePoint& point) const {
  return data_.geometry.in_frame(3 * face_, express_in(data_.mesh, point, face_).barycentric);
}

Front FaceFronts::nearest(const Vec2& p) const {
  const WayBack way = best_way_back(data_, face_, surface_point(p).barycentric);
  Front front{.straight = way.straight, .root = way.root};
  if (way.stop == WayBack::Stop::source && way.straight) {
    // the way itself has no direction on the source
    const auto sources = data_.sources_in(face_);
    const auto source = std::find_if(sources.begin(), sources.end(), [&](const auto& s) { return s.id == way.at; });
    const Vec2 along = (source->b - source->a).normalized();
    const Vec2 centre = (corners_[0] + corners_[1] + corners_[2]) / 3;
    double side = cross(along, p - source->a);
    if (std::abs(side) <= 1e-12 * source->a.norm() + 1e-12 * corners_[1].x()) side = cross(along, centre - source->a);
    front.source = std::copysign(1.0, side) * Vec2(-along.y(), along.x());
    front.offset = -front.source.dot(source->a);
  } else if (way.straight) {
    const double length = way.towards.norm();
    if (length > 0) front.source = -way.towards / length;
    front.offset = way.distance - front.source.dot(p);
  } else {
    front.source = p + way.towards;
    front.offset = way.distance - way.towards.norm();
  }
  return front;
}

Front FaceFronts::of_window(Index halfedge, const Window& window) const {
  const double length = data_.geometry.length(halfedge);
  const bool canonical = data_.mesh.halfedge_of(data_.mesh.edge_of(halfedge)) == halfedge;
  const Window w = canonical ? window : window.flipped(length);
  const int side = halfedge - 3 * face_;
  const Vec2& tail = corners_[side];
  const Vec2 axis = (corners_[(side + 1) % 3] - tail) / length;
  const auto turned = [&](const Vec2& v) -> Vec2 { return axis * v.x() + Vec2(-axis.y(), axis.x()) * v.y(); };
  Front front{.straight = w.kind == Window::Kind::line, .root = w.root};
  if (!front.straight) {
    front.source = tail + turned(w.source);
    front.offset = w.offset;
    return front;
  }
  // a source on the edge itself: its front goes into this face
  const bool own = w.filler;
  front.source = turned(own ? Vec2(0, 1) : w.source);
  front.offset = w.offset - front.source.dot(tail);
  return front;
}

}  // namespace isopath
