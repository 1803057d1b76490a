#include "isopath/field/window.h"

#include <algorithm>
#include <utility>

namespace isopath {
namespace {

/// Real roots of a x² + 2 b x + c, without cancellation. The caller knows b² - a c in a form that does not cancel:
/// fronts that are almost equally old have almost a double root, which must not be lost to rounding.
int solve_quadratic(double a, double b, double c, double discriminant, double roots[2]) {
  if (!(discriminant >= 0)) return 0;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  int count = 0;
  if (a != 0) roots[count++] = q / a;
  if (q != 0) roots[count++] = c / q;
  return count;
}

/// Candidates for D_a = D_b, x measured from `origin` (near the interval, to keep the squares small).
int candidates(const Window& a, const Window& b, double origin, double roots[2]) {
  using Kind = Window::Kind;
  if (a.kind == Kind::line && b.kind == Kind::line) {
    const double slope = a.source.x() - b.source.x();
    if (slope == 0) return 0;
    roots[0] = (b.distance(origin) - a.distance(origin)) / slope;
    return 1;
  }
  if (a.kind == Kind::point && b.kind == Kind::point) {
    // |x-s1| - |x-s2| = Δ, squared once to αx + γ = 2Δ|x-s2|, and once more.
    const Vec2 s1(a.source.x() - origin, a.source.y());
    const Vec2 s2(b.source.x() - origin, b.source.y());
    const double delta = b.offset - a.offset;
    const double alpha = 2 * (s2.x() - s1.x());
    const double gamma = s1.squaredNorm() - s2.squaredNorm() - delta * delta;
    if (delta == 0) {
      if (alpha == 0) return 0;
      roots[0] = -gamma / alpha;
      return 1;
    }
    const double d4 = 4 * delta * delta;
    const double a2 = (alpha - 2 * delta) * (alpha + 2 * delta);
    const double at_s2 = alpha * s2.x() + gamma;
    return solve_quadratic(a2, alpha * gamma + d4 * s2.x(), gamma * gamma - d4 * s2.squaredNorm(),
                           d4 * (at_s2 * at_s2 + a2 * s2.y() * s2.y()), roots);
  }
  const Window& line = a.kind == Kind::line ? a : b;
  const Window& point = a.kind == Kind::line ? b : a;
  const Vec2 s(point.source.x() - origin, point.source.y());
  const double c = line.distance(origin) - point.offset;
  const double u = line.source.x();
  const double v = line.source.y();
  const double at_s = c + u * s.x();
  return solve_quadratic(v * v, -(s.x() + c * u), s.squaredNorm() - c * c, (at_s - v * s.y()) * (at_s + v * s.y()),
                         roots);
}

double slope_at(const Window& w, double x) {
  if (w.kind == Window::Kind::line) return w.source.x();
  const double r = w.radius(x);
  return r > 0 ? (x - w.source.x()) / r : 0;
}

/// One Newton step, kept only where it helps: squaring loses digits that the distances themselves still have.
double polish(const Window& a, const Window& b, double x) {
  const double f = a.distance(x) - b.distance(x);
  const double slope = slope_at(a, x) - slope_at(b, x);
  if (slope == 0) return x;
  const double better = x - f / slope;
  return std::abs(a.distance(better) - b.distance(better)) < std::abs(f) ? better : x;
}

}  // namespace

Vec2 Window::direction(double x) const {
  if (kind == Kind::line) return source;
  const Vec2 d(x - source.x(), -source.y());
  const double r = d.norm();
  return r > 0 ? Vec2(d / r) : Vec2(Vec2::Zero());
}

Window Window::flipped(double length) const {
  Window w = *this;
  w.begin = length - end;
  w.end = length - begin;
  if (kind == Kind::point) {
    w.source = Vec2(length - source.x(), -source.y());
  } else {
    w.source = -source;
    w.offset = offset + source.x() * length;
  }
  return w;
}

Ties ties_between(const Window& a, const Window& b, double low, double high) {
  Ties ties;
  double roots[2];
  const int n = candidates(a, b, low, roots);
  for (int i = 0; i < n; ++i) {
    const double x = polish(a, b, low + roots[i]);
    if (x > low && x < high) ties.x[ties.count++] = x;
  }
  if (ties.count == 2 && ties.x[0] > ties.x[1]) std::swap(ties.x[0], ties.x[1]);
  return ties;
}

}  // namespace isopath
