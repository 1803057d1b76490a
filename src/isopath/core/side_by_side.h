#pragma once

#include <tbb/parallel_invoke.h>

#include <exception>

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

}  // namespace isopath
