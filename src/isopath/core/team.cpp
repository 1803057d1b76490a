#include "isopath/core/team.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <thread>
#include <utility>

namespace isopath {
namespace {

/// In the lower half of a ticket: nothing is to be had.
constexpr std::uint64_t closed = 0xffffffff;

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

Team::Share::Share() : ticket(closed), past(0) {}

Team::Team() : shares_(n_threads()), context_(tbb::task_group_context::isolated), helpers_(context_) {}

Team::~Team() {
  over_ = true;
  helpers_.wait();
}

void Team::run(std::size_t n, std::size_t at_a_time, Call call, const void* work) {
  if (n == 0) return;
  if (size() < 2 || n < 2 * at_a_time) return call(work, 0, n, 0);
  if (!std::exchange(awake_, true)) {
    for (std::size_t k = 1; k < size(); ++k) helpers_.run([this, k] { help(k); });
  }
  // The tickets are closed: nobody takes part in the last loop any more, nor in this one before its ticket is out.
  call_ = call;
  work_ = work;
  at_a_time_ = at_a_time;
  done_ = 0;
  for (std::size_t k = 0; k < size(); ++k) {
    const std::uint64_t loop = (shares_[k].ticket & ~closed) + closed + 1;
    shares_[k].past = (k + 1) * n / size();
    shares_[k].ticket = loop + k * n / size();
  }
  while (do_part(0)) {
  }
  for (int times = 0; done_.load(std::memory_order_acquire) < n;) wait(times);
  for (Share& share : shares_) share.ticket |= closed;
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void Team::help(std::size_t member) {
  for (int times = 0; !over_.load(std::memory_order_relaxed);) {
    if (do_part(member)) {
      times = 0;
    } else {
      wait(times);
    }
  }
}

bool Team::do_part(std::size_t member) {
  for (std::size_t k = 0; k < size(); ++k) {
    if (do_part_of(shares_[(member + k) % size()], member)) return true;
  }
  return false;
}

bool Team::do_part_of(Share& share, std::size_t member) {
  std::uint64_t ticket = share.ticket.load(std::memory_order_acquire);
  for (;;) {
    const std::size_t first = ticket & closed;
    const std::size_t past = share.past.load(std::memory_order_acquire);
    const std::size_t at_a_time = at_a_time_.load(std::memory_order_acquire);
    const Call call = call_.load(std::memory_order_acquire);
    const void* const work = work_.load(std::memory_order_acquire);
    if (first == closed || first >= past) return false;
    const std::size_t n = std::min(at_a_time, past - first);
    // It fails if another member took these, or the loop is not the one any more that was read above.
    if (!share.ticket.compare_exchange_weak(ticket, ticket + n, std::memory_order_acq_rel)) continue;
    try {
      call(work, first, first + n, member);
    } catch (...) {
      const std::lock_guard guard(lock_);
      if (!thrown_) thrown_ = std::current_exception();
    }
    done_.fetch_add(n, std::memory_order_release);
    return true;
  }
}

}  // namespace isopath
