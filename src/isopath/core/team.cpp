#include "isopath/core/team.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <thread>
#include <utility>

namespace isopath {
namespace {

// Of what a share has left.
constexpr int part_bits = 18;
constexpr std::uint64_t most_parts = (1 << part_bits) - 1;
constexpr std::uint64_t one_loop = std::uint64_t{1} << 2 * part_bits;
constexpr std::uint64_t one_part = std::uint64_t{1} << part_bits;

std::size_t n_threads() {
  const std::size_t allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::min(allowed, static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
}

/// Waits for a moment; after many times, with the processor left to others.
void wait(int& times) {
  constexpr int patience = 200;
  if (++times >= patience) return std::this_thread::yield();
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

}  // namespace

Team::Team()
    : size_(n_threads()), shares_((size_ + 1) / 2), context_(tbb::task_group_context::isolated), helpers_(context_) {}

Team::~Team() {
  over_ = true;
  helpers_.wait();
}

void Team::run(std::size_t n, std::size_t at_a_time, Call call, const Words& work) {
  if (n == 0) return;
  if (size() < 2 || n < 2 * at_a_time) return call(work, 0, n, 0);
  if (!std::exchange(awake_, true)) {
    for (std::size_t k = 1; k < size(); ++k) helpers_.run([this, k] { help(k); });
  }
  // Nothing is left in the shares: nobody takes part in the last loop any more, nor in this one before its parts are
  // out.
  at_a_time = std::max(at_a_time, n / most_parts + 1);
  done_.store(0, std::memory_order_relaxed);
  const std::size_t parts = (n + at_a_time - 1) / at_a_time;
  for (std::size_t k = 0; k < shares_.size(); ++k) {
    const std::size_t first = 2 * k * parts / size();
    const std::size_t past = std::min(2 * k + 2, size()) * parts / size();
    Share& share = shares_[k];
    share.call.store(call, std::memory_order_relaxed);
    share.n.store(n, std::memory_order_relaxed);
    share.at_a_time.store(at_a_time, std::memory_order_relaxed);
    for (std::size_t i = 0; i < work.size(); ++i) share.work[i].store(work[i], std::memory_order_relaxed);
    const std::uint64_t loop = share.left.load(std::memory_order_relaxed) / one_loop + 1;
    share.left.store(loop * one_loop + first * one_part + past, std::memory_order_release);
  }
  do_parts(0);
  for (int times = 0; done_.load(std::memory_order_acquire) < n;) wait(times);
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void Team::help(std::size_t member) {
  for (int times = 0; !over_.load(std::memory_order_relaxed);) {
    if (do_parts(member)) {
      times = 0;
    } else {
      wait(times);
    }
  }
}

bool Team::do_parts(std::size_t member) {
  std::size_t done = 0;
  for (std::size_t k = 0; k < shares_.size(); ++k) {
    Share& share = shares_[(member / 2 + k) % shares_.size()];
    while (const std::size_t n = do_some_of(share, member)) done += n;
  }
  // Once, as others do the same to the same line of the cache.
  if (done > 0) done_.fetch_add(done, std::memory_order_release);
  return done > 0;
}

std::size_t Team::do_some_of(Share& share, std::size_t member) {
  // A quarter of what is left, so that what the two take last is short.
  constexpr std::uint64_t takes = 4;
  const bool from_front = member % 2 == 0;
  std::uint64_t left = share.left.load(std::memory_order_acquire);
  for (;;) {
    const std::uint64_t first_part = left / one_part % one_part;
    const std::uint64_t past_part = left % one_part;
    if (first_part >= past_part) return 0;
    const std::size_t n = share.n.load(std::memory_order_relaxed);
    const std::size_t at_a_time = share.at_a_time.load(std::memory_order_relaxed);
    const Call call = share.call.load(std::memory_order_relaxed);
    Words work;
    for (std::size_t i = 0; i < work.size(); ++i) work[i] = share.work[i].load(std::memory_order_relaxed);
    const std::uint64_t some = (past_part - first_part + takes - 1) / takes;
    const std::uint64_t part = from_front ? first_part : past_part - some;
    const std::uint64_t then = from_front ? left + some * one_part : left - some;
    // It fails if another member took a part, or the loop is not the one any more of which the above was read.
    if (!share.left.compare_exchange_weak(left, then, std::memory_order_acq_rel)) continue;
    const std::size_t first = part * at_a_time;
    const std::size_t past = std::min(first + some * at_a_time, n);
    try {
      call(work, first, past, member);
    } catch (...) {
      const std::lock_guard guard(lock_);
      if (!thrown_) thrown_ = std::current_exception();
    }
    return past - first;
  }
}

}  // namespace isopath
