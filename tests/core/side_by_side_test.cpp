#include "isopath/core/side_by_side.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <stdexcept>
#include <string>
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

TEST(SideBySide, EndsAllCallsWholeAndThrowsWhatTheFirstThrew) {
  constexpr std::size_t n = 40;
  std::atomic<int> done = 0;
  std::atomic<int> inside = 0;
  thread_local bool busy = false;
  const auto call = [&](std::size_t k) {
    EXPECT_FALSE(busy) << "a call began inside another one";
    busy = true;
    tbb::parallel_for(0, 100, [&](int) {
      std::this_thread::yield();
      ++inside;
    });
    busy = false;
    ++done;
    if (k % 10 == 7) throw std::runtime_error(std::to_string(k));
  };
  try {
    all_side_by_side(n, call);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "7");
  }
  EXPECT_EQ(done, n);
  EXPECT_EQ(inside, 100 * n);
  all_side_by_side(0, call);
}

}  // namespace
}  // namespace isopath
