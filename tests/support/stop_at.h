#pragma once

#include <atomic>

#include "isopath/core/progress.h"

namespace isopath::test {

/// Wants to stop when it is asked for the n-th time.
class StopAt final : public Progress {
 public:
  explicit StopAt(long n) : left_(n) {}
  bool cancelled() const override { return --left_ <= 0; }
  long asked_since(long n) const { return n - left_; }

 private:
  mutable std::atomic<long> left_;
};

}  // namespace isopath::test
