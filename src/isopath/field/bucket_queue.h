#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace isopath {

/// A queue of items ordered by key up to the width of a bucket; within a bucket first in, first out. Keys behind the
/// bucket being emptied count as belonging to it, keys beyond the horizon to the last bucket in sight: the order is not
/// strict, and whoever uses it must bear items that come too early or again.
class BucketQueue {
 public:
  explicit BucketQueue(float width) : per_width_(1 / width), buckets_(n_buckets) {}

  void push(float key, std::uint32_t item) {
    const float bucket = std::min(key * per_width_ - first_, static_cast<float>(n_buckets - 1));
    const auto ahead = bucket > 0 ? static_cast<std::size_t>(bucket) : 0;
    buckets_[(current_ + ahead) % n_buckets].push_back(item);
    ++size_;
  }
  /// Whether items with these keys, both at least 0, wait in the same bucket.
  bool same_bucket(float key, float other) const {
    return static_cast<std::int64_t>(key * per_width_) == static_cast<std::int64_t>(other * per_width_);
  }
  /// Whether a key lies in the bucket being emptied or before it.
  bool due(float key) const { return key * per_width_ - first_ < 1; }
  bool empty() const { return size_ == 0; }
  /// Goes on to the next bucket that holds items, if need be, and tells how many are left in it. The queue must not be
  /// empty.
  std::size_t n_next() {
    while (next_ == buckets_[current_].size()) advance();
    return buckets_[current_].size() - next_;
  }
  /// The item that comes `n` after the next, if this bucket and the one after it reach so far; else the next. For a
  /// look ahead only, and after `n_next`.
  std::uint32_t ahead(std::size_t n) const {
    const std::vector<std::uint32_t>& bucket = buckets_[current_];
    if (next_ + n < bucket.size()) return bucket[next_ + n];
    const std::vector<std::uint32_t>& after = buckets_[(current_ + 1) % n_buckets];
    n -= bucket.size() - next_;
    return n < after.size() ? after[n] : bucket[next_];
  }
  /// Removes the next item, one of `n_next`.
  std::uint32_t pop() {
    --size_;
    return buckets_[current_][next_++];
  }

 private:
  static constexpr std::size_t n_buckets = 4096;

  void advance() {
    buckets_[current_].clear();
    next_ = 0;
    current_ = (current_ + 1) % n_buckets;
    first_ += 1;
  }

  float per_width_;
  float first_ = 0;  ///< number of the bucket being emptied, counted from key 0
  std::size_t current_ = 0;
  std::size_t next_ = 0;
  std::size_t size_ = 0;
  std::vector<std::vector<std::uint32_t>> buckets_;
};

}  // namespace isopath
