#include "isopath/post/follow_axis.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "isopath/core/angle.h"
#include "isopath/tool/thin_path.h"

namespace isopath {
namespace {

constexpr int most_rounds = 10;

RotaryAngles between(const RotaryAngles& from, const RotaryAngles& to, double u) {
  return {from.a + u * (to.a - from.a), from.c + u * (to.c - from.c)};
}

// The largest angle between the table's and the wanted axis along a move, at seven places in it.
double deviation(const Vec3& axis_from, const Vec3& axis_to, const RotaryAngles& from, const RotaryAngles& to) {
  double worst = 0;
  for (int k = 1; k < 8; ++k) {
    const Vec3 wanted = axis_between(axis_from, axis_to, k / 8.0);
    const Vec3 got = axis_of(between(from, to, k / 8.0));
    worst = std::max(worst, angle_between(got, wanted));
  }
  return worst;
}

ToolPoint middle(const ToolPoint& from, const ToolPoint& to) {
  ToolPoint point = to;
  point.tip = (from.tip + to.tip) / 2;
  point.axis = axis_between(from.axis, to.axis, 0.5);
  point.time = (from.time + to.time) / 2;
  return point;
}

}  // namespace

ToolPath follow_axis(const ToolPath& path, const RotaryLimits& limits, double axis_tolerance) {
  ToolPath result = path;
  for (int round = 0; round < most_rounds; ++round) {
    // Anew in every round: with more points another way through the two solutions may be the shortest.
    const std::vector<RotaryAngles> angles = rotary_angles(result, limits);
    ToolPath finer;
    for (std::size_t i = 0; i < result.points.size(); ++i) {
      const ToolPoint& point = result.points[i];
      if (i > 0 && point.kind != MoveKind::lift &&
          deviation(result.points[i - 1].axis, point.axis, angles[i - 1], angles[i]) > axis_tolerance) {
        finer.points.push_back(middle(result.points[i - 1], point));
      }
      finer.points.push_back(point);
    }
    if (finer.points.size() == result.points.size()) break;
    result = std::move(finer);
  }
  return result;
}

}  // namespace isopath
