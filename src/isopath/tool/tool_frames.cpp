#include "isopath/tool/tool_frames.h"

#include <cmath>
#include <vector>

#include "isopath/core/tolerance.h"

namespace isopath {
namespace {

// A direction that is shorter than this after projection says nothing: its rounding error of about 1e-16, divided by
// the length, would turn the frame by more than 1e-8 rad.
constexpr double least_direction = 1e-8;

double length_tolerance(const ToolPath& path) {
  Box3 box;
  for (const ToolPoint& point : path.points) box.extend(point.tip);
  return box.isEmpty() ? 0 : Tolerance::of_size(box.diagonal().norm()).length;
}

// Entry i is the direction of the move that leaves point i; zero where that is shorter than the tolerance, and at the
// end.
std::vector<Vec3> directions(const ToolPath& path) {
  const std::vector<ToolPoint>& points = path.points;
  const double tolerance = length_tolerance(path);
  std::vector<Vec3> result(points.size(), Vec3::Zero());
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vec3 move = points[i + 1].tip - points[i].tip;
    const double length = move.norm();
    if (length > tolerance) result[i] = move / length;
  }
  return result;
}

// The same, but a move of no length takes the direction of the next one that has any.
std::vector<Vec3> departures(std::vector<Vec3> moves) {
  for (std::size_t i = moves.size(); i-- > 1;) {
    if (moves[i - 1].isZero(0)) moves[i - 1] = moves[i];
  }
  return moves;
}

// The part of the direction that is perpendicular to the axis, unit; zero where there is none.
Vec3 perpendicular(const Vec3& direction, const Vec3& axis) {
  const Vec3 part = direction - direction.dot(axis) * axis;
  const double length = part.norm();
  return length > least_direction ? Vec3(part / length) : Vec3::Zero();
}

Vec3 any_perpendicular(const Vec3& axis) {
  return perpendicular(std::abs(axis.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY(), axis);
}

}  // namespace

void set_tangents(ToolPath& path) {
  std::vector<ToolPoint>& points = path.points;
  const std::vector<Vec3> moves = directions(path);
  const std::vector<Vec3> leaving = departures(moves);
  Vec3 arriving = Vec3::Zero();
  Vec3 carried = Vec3::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& axis = points[i].axis;
    Vec3 tangent = perpendicular(arriving + leaving[i], axis);
    if (tangent.isZero(0)) tangent = perpendicular(leaving[i], axis);
    if (tangent.isZero(0)) tangent = perpendicular(carried, axis);
    points[i].tangent = carried = tangent;
    if (!moves[i].isZero(0)) arriving = moves[i];
  }
  carried = Vec3::Zero();
  for (std::size_t i = points.size(); i-- > 0;) {
    Vec3& tangent = points[i].tangent;
    if (tangent.isZero(0)) tangent = perpendicular(carried, points[i].axis);
    if (tangent.isZero(0)) tangent = any_perpendicular(points[i].axis);
    carried = tangent;
  }
}

Eigen::Quaterniond orientation_of(const ToolPoint& point) {
  Eigen::Matrix3d frame;
  frame << point.tangent, point.axis.cross(point.tangent), point.axis;
  return Eigen::Quaterniond(frame).normalized();
}

}  // namespace isopath
