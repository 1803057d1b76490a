#include "isopath/tool/ball_sweep.h"

#include <algorithm>
#include <cmath>

namespace isopath {
namespace {

/// Height at which the line p + t n enters the balls centred on a segment. With the centre c(s), linear in s, that is
/// t(s) = (c - p)·n - sqrt(R² - ρ²), ρ the distance of c from the line. -ρ² is concave in s, so t is convex: the least
/// is where its slope vanishes, or at the end next to there.
double entry(const BallSweep::Segment& segment, const Vec3& p, const Vec3& n, double radius) {
  const Vec3 to_a = segment.a - p;
  const Vec3 along = segment.b - segment.a;
  const double t0 = to_a.dot(n);
  const double t1 = along.dot(n);
  const Vec3 across0 = to_a - t0 * n;
  const Vec3 across1 = along - t1 * n;
  const double b = across1.squaredNorm();
  const auto at = [&](double s) {
    const double inside = radius * radius - (across0 + s * across1).squaredNorm();
    const double half = inside >= 0 ? std::sqrt(inside) : 0;
    const double middle = t0 + s * t1;
    return inside >= 0 && middle + half >= 0 ? middle - half : infinity;  // a ball all behind p is at another place
  };
  if (!(b > 0)) return std::min(at(0), at(1));
  const double s0 = -across0.dot(across1) / b;  // nearest to the line
  const double a = radius * radius - (across0 + s0 * across1).squaredNorm();
  if (a < 0) return infinity;
  return at(std::clamp(s0 - t1 * std::sqrt(a / (b * (b + t1 * t1))), 0.0, 1.0));
}

}  // namespace

BallSweep::BallSweep(std::vector<Segment> segments, double radius, double cell) : radius_(radius), cell_(cell) {
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Vec3 middle = 0.5 * (segments[i].a + segments[i].b);
    order.emplace_back(key(cell_of(middle.x()), cell_of(middle.y()), cell_of(middle.z())), i);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [its_key, i] : order) {
    keys_.push_back(its_key);
    segments_.push_back(segments[i]);
  }
}

std::int64_t BallSweep::cell_of(double coordinate) const {
  return static_cast<std::int64_t>(std::floor(coordinate / cell_));
}

/// 21 bits for each coordinate; cells that share a key by coming round only cost time.
std::uint64_t BallSweep::key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::uint64_t mask = (1U << 21U) - 1;
  return (static_cast<std::uint64_t>(x) & mask) << 42U | (static_cast<std::uint64_t>(y) & mask) << 21U |
         (static_cast<std::uint64_t>(z) & mask);
}

void BallSweep::near(const Vec3& place, double reach, std::vector<Segment>& out) const {
  out.clear();
  const double wide = reach + 0.5 * cell_;  // a segment's middle is at most half a cell from any of its points
  for (std::int64_t x = cell_of(place.x() - wide); x <= cell_of(place.x() + wide); ++x) {
    for (std::int64_t y = cell_of(place.y() - wide); y <= cell_of(place.y() + wide); ++y) {
      for (std::int64_t z = cell_of(place.z() - wide); z <= cell_of(place.z() + wide); ++z) {
        const auto range = std::equal_range(keys_.begin(), keys_.end(), key(x, y, z));
        for (auto k = range.first; k != range.second; ++k) {
          const Segment& segment = segments_[static_cast<std::size_t>(k - keys_.begin())];
          const double its_reach = reach + 0.5 * (segment.b - segment.a).norm();
          if ((0.5 * (segment.a + segment.b) - place).squaredNorm() <= its_reach * its_reach) out.push_back(segment);
        }
      }
    }
  }
}

double BallSweep::height(const Vec3& p, const Vec3& n, const std::vector<Segment>& segments) const {
  double least = infinity;
  for (const Segment& segment : segments) least = std::min(least, entry(segment, p, n, radius_));
  return least;
}

}  // namespace isopath
