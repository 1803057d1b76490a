#pragma once

#include <chrono>
#include <vector>

#include "isopath/plan/plan_result.h"

namespace isopath {

/// Notes what the stages of a run cost, one after the other.
class StageClock {
 public:
  explicit StageClock(std::vector<StageTime>& times) : times_(times) {}
  /// The stage that ran since the last call ends.
  void ends(const char* stage) {
    const auto now = Clock::now();
    times_.push_back({stage, std::chrono::duration<double>(now - last_).count()});
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<StageTime>& times_;
  Clock::time_point last_ = Clock::now();
};

}  // namespace isopath
