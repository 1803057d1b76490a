#include "isopath/field/window_merge.h"

#include <algorithm>
#include <cmath>

namespace isopath {
namespace {

/// Coordinates and offsets that unfolded along different ways differ by rounding, relative to the model.
constexpr double same_source = 1e-13;
/// Rays that differ by less go the same way: behind the next edge they are less than a snap width apart.
constexpr double same_direction = 1e-12;

/// The same front, cut in two by a vertex where the surface is flat.
bool is_one_front(const Window& left, const Window& right, double size) {
  const double tolerance = same_source * size;
  if (left.kind != right.kind || left.root != right.root) return false;
  if (left.kind == Window::Kind::line) {
    return (left.source - right.source).cwiseAbs().maxCoeff() < same_source &&
           std::abs(left.distance(left.end) - right.distance(right.begin)) < tolerance;
  }
  return std::abs(left.offset - right.offset) < tolerance &&
         (left.source - right.source).cwiseAbs().maxCoeff() < tolerance &&
         std::abs(cross(left.direction(left.begin), right.direction(left.begin))) < same_direction &&
         std::abs(cross(left.direction(right.end), right.direction(right.end))) < same_direction;
}

/// The largest difference of two fronts on the interval of `old`.
double largest_difference(const Window& result, const Window& old) {
  const auto at = [&](double x) { return std::abs(result.distance(x) - old.distance(x)); };
  const double at_ends = std::max(at(old.begin), at(old.end));
  // They grow equally fast along the edge only where their rays are parallel: where the line through both sources, or
  // the ray of a straight front through the other's source, meets the edge.
  const Vec2 along = old.kind == Window::Kind::line ? old.source : result.source;
  const Vec2 line = old.kind == result.kind ? Vec2(result.source - old.source) : along;
  const Vec2& through = result.kind == Window::Kind::point ? result.source : old.source;
  const double x = through.x() - line.x() / line.y() * through.y();
  return x > old.begin && x < old.end ? std::max(at_ends, at(x)) : at_ends;
}

/// The flattest front through the given distances at both ends of the interval whose beam covers those of both windows.
void fit_front(const Window& left, const Window& right, double farthest, Window& result) {
  const double width = result.end - result.begin;
  const double at_begin = left.distance(left.begin);
  const double at_end = right.distance(right.end);
  const double slope = (at_end - at_begin) / width;
  const double first = left.direction(left.begin).x();
  const double last = right.direction(right.end).x();
  const double side = left.source_side();
  if (slope <= first && slope >= last) {  // rays converge; parallel ones cover more
    result.kind = Window::Kind::line;
    result.source = Vec2(slope, -side * std::sqrt((1 - slope) * (1 + slope)));
    result.offset = at_begin - slope * left.begin;
    return;
  }
  // Sources with this difference of distances lie on a hyperbola with the ends as foci. By the law of cosines the ray
  // to the first end has the slope `slope - scale / way`. The nearer the source, the wider the beam.
  const double scale = 0.5 * width * (1 - slope) * (1 + slope);
  double way = farthest;
  if (slope > first) way = std::min(way, scale / (slope - first));
  if (slope < last) way = std::min(way, scale / (last - slope) + at_begin - at_end);
  const double x = slope - scale / way;
  result.kind = Window::Kind::point;
  result.source = Vec2(left.begin - way * x, side * way * std::sqrt((1 - x) * (1 + x)));
  result.offset = at_begin - way;
}

}  // namespace

bool merge_windows(const Window& left, const Window& right, const MergeLimits& limits, Window& merged) {
  Window result = right.end - right.begin > left.end - left.begin ? right : left;
  result.begin = left.begin;
  result.end = right.end;
  result.error = std::max(left.error, right.error);
  if (is_one_front(left, right, limits.size)) {
    merged = result;
    return true;
  }
  const double budget = limits.allowed_at(left.distance(left.end)) - result.error;
  const double rise = std::abs(right.distance(right.end) - left.distance(left.begin));
  if (!(budget > 0 && rise < result.end - result.begin && left.source_side() * right.source_side() > 0)) return false;
  // Far sources cost digits: their squares must leave some below the accuracy.
  const double farthest = std::min(1e3 * limits.size, 1e10 * limits.accuracy);
  fit_front(left, right, farthest, result);
  const double change = std::max(largest_difference(result, left), largest_difference(result, right));
  if (!(change <= budget)) return false;
  result.error += change;
  merged = result;
  return true;
}

}  // namespace isopath
