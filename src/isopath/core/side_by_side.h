#pragma once

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <exception>
#include <vector>

namespace isopath {

/// Calls both, at the same time where a second thread is free, and throws what the first of them threw, or else what
/// the second did. Unlike tbb::parallel_invoke it lets one run on when the other throws: parallel loops inside a group
/// that is cancelled end half done without a word, and what follows them would work on what they left.
template <class First, class Second>
void side_by_side(First&& first, Second&& second) {
  std::exception_ptr thrown[2];
  const auto guarded = [](auto& call, std::exception_ptr& by) {
    try {
      call();
    } catch (...) {
      by = std::current_exception();
    }
  };
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::parallel_invoke([&] { guarded(first, thrown[0]); }, [&] { guarded(second, thrown[1]); }, context);
  for (const std::exception_ptr& by : thrown) {
    if (by) std::rethrow_exception(by);
  }
}

/// The same for call(0), …, call(n - 1): throws what the first of them in this order threw. They may hold parallel
/// loops of their own; a thread that waits for one of these does not begin another call meanwhile.
template <class Call>
void all_side_by_side(std::size_t n, Call&& call) {
  std::vector<std::exception_ptr> thrown(n);
  tbb::task_group_context context(tbb::task_group_context::isolated);
  const auto guarded = [&](std::size_t k) {
    try {
      tbb::this_task_arena::isolate([&] { call(k); });
    } catch (...) {
      thrown[k] = std::current_exception();
    }
  };
  tbb::parallel_for(std::size_t{0}, n, guarded, tbb::simple_partitioner(), context);
  for (const std::exception_ptr& by : thrown) {
    if (by) std::rethrow_exception(by);
  }
}

}  // namespace isopath
