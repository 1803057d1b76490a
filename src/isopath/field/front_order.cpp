#include "isopath/field/front_order.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace isopath {
namespace {

constexpr std::size_t n_slots = 128;
/// Another axis is taken where the spread along this one, squared, is less than this part of the largest.
constexpr double nearly = 0.5;

}  // namespace

FrontOrder::FrontOrder(const Box3& bounds)
    : centre_(bounds.center()),
      size_(std::max(bounds.diagonal().norm(), std::numeric_limits<double>::min())),
      axis_(Vec3::UnitX() / size_) {}

bool FrontOrder::turn(std::span<const Vec3> places) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& place : places) mean += (place - centre_) / static_cast<double>(places.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3& place : places) {
    const Vec3 away = (place - centre_ - mean) / size_;
    spread += away * away.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  if (axis_.dot(spread * axis_) * size_ * size_ >= nearly * solver.eigenvalues()[2]) return false;
  Vec3 axis = solver.eigenvectors().col(2);
  if (axis.dot(axis_) < 0) axis = -axis;  // who began at one end goes on there
  axis_ = axis / size_;
  return true;
}

void FrontOrder::sort(std::vector<Noted>& notes, std::vector<Noted>& sorted) {
  float low = std::numeric_limits<float>::infinity();
  float high = -low;
  for (const Noted& noted : notes) {
    low = std::min(low, noted.along);
    high = std::max(high, noted.along);
  }
  float per_slot = static_cast<float>(n_slots - 1) / (high - low);
  if (!std::isfinite(per_slot)) per_slot = 0;  // all at one place
  const auto slot_of = [&](const Noted& noted) { return static_cast<std::size_t>((noted.along - low) * per_slot); };
  std::array<Index, n_slots + 1> next{};
  for (const Noted& noted : notes) ++next[slot_of(noted) + 1];
  for (std::size_t k = 0; k < n_slots; ++k) next[k + 1] += next[k];
  sorted.resize(notes.size());
  for (const Noted& noted : notes) sorted[next[slot_of(noted)]++] = noted;
  notes.clear();
}

}  // namespace isopath
