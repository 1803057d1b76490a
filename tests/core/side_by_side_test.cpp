#include "isopath/core/side_by_side.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

namespace isopath {
namespace {

TEST(SideBySide, LetsOneEndItsLoopsWhenTheOtherThrows) {
  constexpr int n = 2000;
  for (int trial = 0; trial < 20; ++trial) {
    std::atomic<int> done = 0;
    std::atomic<bool> began = false;
    const auto fail = [&] {
      for (int k = 0; k < 1000 && !began; ++k) std::this_thread::sleep_for(std::chrono::microseconds(100));
      throw std::runtime_error("first");
    };
    const auto work = [&] {
      began = true;
      tbb::parallel_for(0, n, [&](int) {
        std::this_thread::yield();
        ++done;
      });
    };
    EXPECT_THROW(side_by_side(work, [&] { throw std::runtime_error("second"); }), std::runtime_error);
    EXPECT_EQ(done, n);
    if (tbb::this_task_arena::max_concurrency() < 2) continue;
    done = 0;
    began = false;
    EXPECT_THROW(side_by_side(work, fail), std::runtime_error);
    EXPECT_EQ(done, n);
  }
}

TEST(SideBySide, ThrowsWhatTheFirstThrew) {
  const auto thrower = [](const char* what) { return [=] { throw std::runtime_error(what); }; };
  try {
    side_by_side(thrower("first"), thrower("second"));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "first");
  }
}

}  // namespace
}  // namespace isopath
