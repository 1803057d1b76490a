#include "isopath/core/team.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

namespace isopath {
namespace {

TEST(Team, DoesEveryItemOnceInThousandsOfLoops) {
  for (const std::size_t threads : {1, 2, 5}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Team team;
    EXPECT_LE(team.size(), threads);
    std::mt19937_64 random(7);
    std::vector<int> times;
    for (int loop = 0; loop < 5000; ++loop) {
      const std::size_t n = random() % 200;
      const std::size_t at_a_time = 1 + random() % 9;
      times.assign(n, 0);
      team.share(n, at_a_time, [&](std::size_t first, std::size_t past, std::size_t member) {
        EXPECT_LT(member, team.size());
        EXPECT_EQ(first % at_a_time, 0);
        EXPECT_TRUE(past == n || past % at_a_time == 0);
        for (std::size_t i = first; i < past; ++i) ++times[i];
      });
      ASSERT_EQ(std::count(times.begin(), times.end(), 1), static_cast<std::ptrdiff_t>(n)) << "loop " << loop;
    }
  }
}

TEST(Team, TakesWorkOfAnySize) {
  Team team;
  std::vector<int> times(1000);
  std::array<int, 100> add{};
  add.fill(1);
  for (int loop = 0; loop < 100; ++loop) {
    team.share(times.size(), 7, [&times, add](std::size_t first, std::size_t past, std::size_t) {
      for (std::size_t i = first; i < past; ++i) times[i] += add[i % add.size()];
    });
  }
  EXPECT_EQ(std::count(times.begin(), times.end(), 100), 1000);
}

TEST(Team, LetsEveryMemberWork) {
  Team team;
  std::vector<std::atomic<bool>> worked(team.size());
  const auto all = [&] {
    return std::all_of(worked.begin(), worked.end(), [](const auto& yes) { return yes.load(); });
  };
  for (int loop = 0; loop < 100000 && !all(); ++loop) {
    team.share(64, 1, [&](std::size_t, std::size_t, std::size_t member) {
      worked[member] = true;
      std::this_thread::yield();
    });
  }
  EXPECT_TRUE(all());
}

TEST(Team, EndsTheLoopBeforeItThrows) {
  Team team;
  std::atomic<int> done = 0;
  const auto work = [&](std::size_t first, std::size_t past, std::size_t) {
    done += static_cast<int>(past - first);
    if (first <= 40 && 40 < past) throw std::runtime_error("at 40");
  };
  EXPECT_THROW(team.share(100, 3, work), std::runtime_error);
  EXPECT_TRUE(done == 100 || team.size() < 2);
  done = 0;
  team.share(30, 3, work);
  EXPECT_EQ(done, 30);
}

TEST(Team, WorksWhereAllThreadsAreBusy) {
  std::atomic<int> done = 0;
  tbb::parallel_for(0, 50, [&](int) {
    Team team;
    for (int loop = 0; loop < 20; ++loop) {
      team.share(100, 2,
                 [&](std::size_t first, std::size_t past, std::size_t) { done += static_cast<int>(past - first); });
    }
  });
  EXPECT_EQ(done, 50 * 20 * 100);
}

}  // namespace
}  // namespace isopath
