#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "isopath/field/large_pages.h"
#include "isopath/field/window.h"

namespace isopath {

/// Windows of one half-edge as a structure of arrays, sorted by `begin`, in the frame of the half-edge whose face they
/// enter: the front comes from y <= 0.
///
/// A circle has its unfolded pseudo-source in (x, y), y <= 0, and in `offset` the distance travelled there. A straight
/// front has its unit direction in (x, y), y > 0, and in `offset` its distance at the half-edge's origin.
struct WindowArrays {
  double* begin = nullptr;
  double* end = nullptr;
  double* x = nullptr;
  double* y = nullptr;
  double* offset = nullptr;
  /// Source element, and most that the distances are off by merging; null where only distances are asked for.
  double* root = nullptr;
  double* error = nullptr;

  static constexpr int count = 5;
  static constexpr int tagged_count = 7;
  /// Consecutive arrays of this capacity.
  static WindowArrays at(double* first, std::size_t capacity, bool tagged) {
    return {first,
            first + capacity,
            first + 2 * capacity,
            first + 3 * capacity,
            first + 4 * capacity,
            tagged ? first + 5 * capacity : nullptr,
            tagged ? first + 6 * capacity : nullptr};
  }
  /// The arrays from element i on.
  WindowArrays operator+(std::size_t i) const {
    return {begin + i, end + i, x + i, y + i, offset + i, root ? root + i : nullptr, error ? error + i : nullptr};
  }
  /// One window, as it stands in the half-edge's frame; without half-edge.
  Window window(std::size_t i) const;
  void set(std::size_t i, const Window& window) const;
  /// Copies n windows to `to`, array after array in the order above, and scribbles on up to WindowBlock::lanes - 1
  /// places behind them in each.
  void copy(std::size_t n, const WindowArrays& to) const;
};

/// Copies n windows in the order of their begin.
void sort_list(const WindowArrays& windows, std::size_t n, const WindowArrays& to);

/// A list of windows on its way from one triangle to the next.
struct WindowBlock {
  WindowBlock* next = nullptr;  ///< an older list that waits at the same half-edge
  double least = infinity;      ///< bound on the distances of its windows from below
  Index size = 0;
  Index capacity = 0;  ///< a multiple of `lanes`; the last `lanes` places are for vector instructions to scribble on
  Index size_class = 0;
  Index depth = 0;  ///< least number of faces that its windows have crossed
  static constexpr Index lanes = 8;

  static constexpr std::size_t header_doubles = 8;  ///< keeps the arrays on their own cache lines
  double* storage() { return reinterpret_cast<double*>(this) + header_doubles; }
};

/// Memory that is handed out piece after piece and given back as a whole.
class WindowMemory {
 public:
  /// n doubles; WindowBlock::lanes more behind them may be scribbled on until the next ones are taken.
  double* take(std::size_t n);
  std::size_t bytes() const { return bytes_; }

 private:
  std::vector<LargeVector<double>> chunks_;  ///< on whole cache lines
  double* fresh_ = nullptr;
  std::size_t left_ = 0;  ///< doubles from fresh_ on
  std::size_t bytes_ = 0;
};

/// Blocks by size, used again once they are given back. One thread takes and gives; a block may end up with another
/// thread than it came from.
class WindowBlocks {
 public:
  explicit WindowBlocks(bool tagged) : tagged_(tagged) {}

  /// A block for at least `size` windows.
  WindowBlock* take(std::size_t size);
  void give_back(WindowBlock* block);
  /// Calls the first windows of a block into the cache; more of a long list follow by themselves. Reads nothing that
  /// changes, as another thread may be at work on it.
  void fetch(const WindowBlock* block) const {
    const Index n = std::min(block->capacity - WindowBlock::lanes, 3 * WindowBlock::lanes);
    const char* const windows = reinterpret_cast<const char*>(block) + WindowBlock::header_doubles * sizeof(double);
    for (int k = 0; k < (tagged_ ? WindowArrays::tagged_count : WindowArrays::count); ++k) {
      for (Index i = 0; i < n; i += WindowBlock::lanes) {
        __builtin_prefetch(windows + static_cast<std::size_t>(k * block->capacity + i) * sizeof(double));
      }
    }
  }
  WindowArrays arrays(WindowBlock* block) const {
    return WindowArrays::at(block->storage(), static_cast<std::size_t>(block->capacity), tagged_);
  }
  std::size_t bytes() const { return memory_.bytes(); }

 private:
  bool tagged_;
  std::vector<std::vector<WindowBlock*>> free_;  ///< by size class
  WindowMemory memory_;
};

}  // namespace isopath
