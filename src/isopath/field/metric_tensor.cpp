#include "isopath/field/metric_tensor.h"

#include <algorithm>
#include <cmath>

namespace isopath {
namespace {

double squared(double x) { return x * x; }

/// Turned about the line that both tangent planes share, until the normal is n.
MetricTensor turned_to(const MetricTensor& tensor, const Vec3& n) {
  const Vec3 m = tensor.normal();
  const Vec3 axis = m.cross(n);
  const double c = m.dot(n);
  if (!(c > -1 + 1e-12)) return tensor;  // turned over: every axis would serve
  const auto turn = [&](const Vec3& v) { return Vec3(c * v + axis.cross(v) + axis * (axis.dot(v) / (1 + c))); };
  MetricTensor out = tensor;
  out.first = turn(tensor.first);
  out.second = n.cross(out.first);
  return out;
}

/// The symmetric matrix [xx xy; xy yy] of squared stretches in the frame (x, y).
MetricTensor of_matrix(const Vec3& x, const Vec3& y, double xx, double xy, double yy) {
  const double half_difference = 0.5 * (xx - yy);
  const double radius = std::hypot(half_difference, xy);
  const double mean = 0.5 * (xx + yy);
  const double angle = radius > 0 ? 0.5 * std::atan2(xy, half_difference) : 0;
  MetricTensor out;
  out.first = std::cos(angle) * x + std::sin(angle) * y;
  out.second = -std::sin(angle) * x + std::cos(angle) * y;
  out.first_stretch = std::sqrt(mean + radius);
  // the smaller eigenvalue from the determinant, which does not cancel
  out.second_stretch = std::sqrt(std::max(0.0, (xx * yy - xy * xy) / (mean + radius)));
  return out;
}

MetricTensor linear_blend(const std::array<MetricTensor, 3>& tensors, const Vec3& weights, const Vec3& n) {
  const Vec3 x = n.unitOrthogonal();
  const Vec3 y = n.cross(x);
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (int i = 0; i < 3; ++i) {
    if (weights[i] == 0) continue;
    const MetricTensor t = turned_to(tensors[i], n);
    const double first = weights[i] * squared(t.first_stretch);
    const double second = weights[i] * squared(t.second_stretch);
    xx += first * squared(t.first.dot(x)) + second * squared(t.second.dot(x));
    xy += first * t.first.dot(x) * t.first.dot(y) + second * t.second.dot(x) * t.second.dot(y);
    yy += first * squared(t.first.dot(y)) + second * squared(t.second.dot(y));
  }
  return of_matrix(x, y, xx, xy, yy);
}

/// The paper's: directions are matched by the larger dot product, then turned by t times the angle, which lies between
/// -45 and 45 degrees; stretches are interpolated linearly.
MetricTensor paper_blend(const MetricTensor& a, const MetricTensor& b, double t) {
  const Vec3 n = ((1 - t) * a.normal() + t * b.normal()).stableNormalized();
  MetricTensor from = turned_to(a, n);
  const MetricTensor to = turned_to(b, n);
  const bool matches = std::abs(from.first.dot(to.first)) >= std::abs(from.first.dot(to.second));
  Vec3 goal = matches ? to.first : to.second;
  if (goal.dot(from.first) < 0) goal = -goal;
  const double angle = t * std::atan2(n.dot(from.first.cross(goal)), from.first.dot(goal));
  MetricTensor out;
  out.first = std::cos(angle) * from.first + std::sin(angle) * n.cross(from.first);
  out.second = n.cross(out.first);
  out.first_stretch = (1 - t) * from.first_stretch + t * (matches ? to.first_stretch : to.second_stretch);
  out.second_stretch = (1 - t) * from.second_stretch + t * (matches ? to.second_stretch : to.first_stretch);
  return out;
}

}  // namespace

double MetricTensor::length(const Vec3& v) const {
  const double x = first.dot(v);
  const double y = second.dot(v);
  const double in_plane = std::hypot(x, y);
  if (!(in_plane > 0)) return v.norm() * std::sqrt(first_stretch * second_stretch);  // no direction is nearer
  return std::hypot(first_stretch * x, second_stretch * y) * (v.norm() / in_plane);
}

MetricTensor blended(const std::array<MetricTensor, 3>& tensors, const Vec3& weights, TensorBlend blend) {
  for (int i = 0; i < 3; ++i) {
    if (weights[i] == 1) return tensors[i];
  }
  if (blend == TensorBlend::paper) {
    // pairwise, as the paper does; a zero weight drops out
    const double pair = weights[0] + weights[1];
    if (weights[0] == 0) return paper_blend(tensors[1], tensors[2], weights[2]);
    if (weights[1] == 0) return paper_blend(tensors[0], tensors[2], weights[2]);
    const MetricTensor between = paper_blend(tensors[0], tensors[1], weights[1] / pair);
    return weights[2] == 0 ? between : paper_blend(between, tensors[2], weights[2]);
  }
  Vec3 n = Vec3::Zero();
  for (int i = 0; i < 3; ++i) n += weights[i] * tensors[i].normal();
  return linear_blend(tensors, weights, n.stableNormalized());
}

double edge_length(const Vec3& edge, const MetricTensor& a, const MetricTensor& b, TensorBlend blend) {
  const double at_a = a.length(edge);
  const double at_b = b.length(edge);
  return blend == TensorBlend::paper ? 0.5 * (at_a + at_b) : std::sqrt(0.5 * (squared(at_a) + squared(at_b)));
}

}  // namespace isopath
