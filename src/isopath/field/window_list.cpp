#include "isopath/field/window_list.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <new>
#include <numeric>
#include <utility>

namespace isopath {
namespace {

constexpr std::size_t chunk_doubles = 1 << 16;
static_assert(sizeof(WindowBlock) <= WindowBlock::header_doubles * sizeof(double));

/// Four classes to a doubling waste an eighth on average.
std::size_t class_of(std::size_t lanes) {
  if (lanes <= 4) return lanes - 1;
  const auto octave = static_cast<std::size_t>(std::bit_width(lanes - 1)) - 3;
  return 4 * octave + ((lanes - 1) >> octave);
}
std::size_t lanes_of(std::size_t size_class) {
  if (size_class < 4) return size_class + 1;
  const std::size_t octave = size_class / 4 - 1;
  return (size_class - 4 * octave + 1) << octave;
}

}  // namespace

void WindowArrays::copy(std::size_t n, const WindowArrays& to) const {
  const auto copy_array = [n](const double* from, double* into) {
    for (std::size_t i = 0; i < n; i += WindowBlock::lanes)
      std::memcpy(into + i, from + i, WindowBlock::lanes * sizeof(double));
  };
  copy_array(begin, to.begin);
  copy_array(end, to.end);
  copy_array(x, to.x);
  copy_array(y, to.y);
  copy_array(offset, to.offset);
  if (root == nullptr) return;
  copy_array(root, to.root);
  copy_array(error, to.error);
}

Window WindowArrays::window(std::size_t i) const {
  Window w;
  w.begin = begin[i];
  w.end = end[i];
  w.source = Vec2(x[i], y[i]);
  w.offset = offset[i];
  w.kind = y[i] > 0 ? Window::Kind::line : Window::Kind::point;
  if (root == nullptr) return w;
  w.root = static_cast<Index>(root[i]);
  w.error = error[i];
  return w;
}

void WindowArrays::set(std::size_t i, const Window& w) const {
  begin[i] = w.begin;
  end[i] = w.end;
  x[i] = w.source.x();
  y[i] = w.kind == Window::Kind::line ? w.source.y() : std::min(w.source.y(), 0.0);
  offset[i] = w.offset;
  if (root == nullptr) return;
  root[i] = w.root;
  error[i] = w.error;
}

void sort_list(const WindowArrays& windows, std::size_t n, const WindowArrays& to) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return windows.begin[a] < windows.begin[b]; });
  for (std::size_t i = 0; i < n; ++i) (windows + order[i]).copy(1, to + i);
}

double* WindowMemory::take(std::size_t n) {
  if (left_ < n + WindowBlock::lanes) {
    left_ = std::max(chunk_doubles, n + WindowBlock::lanes);
    fresh_ = chunks_.emplace_back(left_).data();
    bytes_ += left_ * sizeof(double);
  }
  left_ -= n;
  return std::exchange(fresh_, fresh_ + n);
}

WindowBlock* WindowBlocks::take(std::size_t size) {
  const std::size_t size_class = class_of((size + 2 * WindowBlock::lanes - 1) / WindowBlock::lanes);
  if (size_class >= free_.size()) free_.resize(size_class + 1);
  if (!free_[size_class].empty()) {
    WindowBlock* block = free_[size_class].back();
    free_[size_class].pop_back();
    block->depth = 0;
    return block;
  }
  const std::size_t capacity = lanes_of(size_class) * WindowBlock::lanes;
  const std::size_t needed =
      WindowBlock::header_doubles + (tagged_ ? WindowArrays::tagged_count : WindowArrays::count) * capacity;
  auto* block = new (memory_.take(needed)) WindowBlock;
  block->capacity = static_cast<Index>(capacity);
  block->size_class = static_cast<Index>(size_class);
  return block;
}

void WindowBlocks::give_back(WindowBlock* block) {
  const auto size_class = static_cast<std::size_t>(block->size_class);
  if (size_class >= free_.size()) free_.resize(size_class + 1);
  free_[size_class].push_back(block);
}

}  // namespace isopath
