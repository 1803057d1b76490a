#include "isopath/mesh/weld.h"

#include <algorithm>
#include <array>
#include <bit>

namespace isopath {
namespace {

std::array<std::uint64_t, 3> bits_of(const Vec3& p) {
  // Adding zero turns minus zero into zero.
  return {std::bit_cast<std::uint64_t>(p.x() + 0.0), std::bit_cast<std::uint64_t>(p.y() + 0.0),
          std::bit_cast<std::uint64_t>(p.z() + 0.0)};
}

/// Multiply-and-fold of the three coordinates (multipliers: odd, from the digits of the golden ratio and of pi).
std::uint64_t hash_of(const Vec3& p) {
  const auto [x, y, z] = bits_of(p);
  std::uint64_t h = x * 0x9e3779b97f4a7c15u;
  h = (h ^ (h >> 32) ^ y) * 0x243f6a8885a308d3u;
  h = (h ^ (h >> 32) ^ z) * 0x9e3779b97f4a7c15u;
  return h ^ (h >> 29);
}

}  // namespace

PointWelder::PointWelder(std::size_t expected) {
  const std::size_t size = std::bit_ceil(std::max<std::size_t>(64, 2 * expected));
  slots_.resize(size);
  mask_ = size - 1;
  points_.reserve(expected);
}

void PointWelder::add(std::span<const Vec3> points, std::span<Index> numbers) {
  // In blocks, so that the table's cache lines are on their way before they are needed.
  constexpr std::size_t block = 32;
  std::array<std::uint64_t, block> hash;
  for (std::size_t begin = 0; begin < points.size(); begin += block) {
    const std::size_t count = std::min(block, points.size() - begin);
    while (2 * (points_.size() + count) > slots_.size()) grow();
    for (std::size_t i = 0; i < count; ++i) {
      hash[i] = hash_of(points[begin + i]);
      __builtin_prefetch(&slots_[hash[i] & mask_]);
    }
    for (std::size_t i = 0; i < count; ++i) numbers[begin + i] = find_or_add(points[begin + i], hash[i]);
  }
}

Index PointWelder::find_or_add(const Vec3& point, std::uint64_t hash) {
  const auto tag = static_cast<std::uint32_t>(hash >> 32);
  std::uint64_t at = hash & mask_;
  while (slots_[at].point != no_index) {
    if (slots_[at].tag == tag && bits_of(points_[slots_[at].point]) == bits_of(point)) return slots_[at].point;
    at = (at + 1) & mask_;
  }
  const auto number = static_cast<Index>(points_.size());
  slots_[at] = {tag, number};
  points_.push_back(point);
  return number;
}

void PointWelder::grow() {
  std::vector<Slot> old(2 * slots_.size());
  old.swap(slots_);
  mask_ = slots_.size() - 1;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const std::uint64_t hash = hash_of(points_[p]);
    std::uint64_t at = hash & mask_;
    while (slots_[at].point != no_index) at = (at + 1) & mask_;
    slots_[at] = {static_cast<std::uint32_t>(hash >> 32), static_cast<Index>(p)};
  }
}

}  // namespace isopath
