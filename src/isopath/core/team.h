#pragma once

#include <tbb/task_group.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <mutex>
#include <new>
#include <tuple>
#include <type_traits>
#include <vector>

namespace isopath {

/// Threads that stay awake from one parallel loop to the next.
///
/// A computation in thousands of short rounds spends as much on waking threads for each (10 µs) as on what they do. The
/// members of a team wait busily instead, from the first loop that is worth sharing until the team ends: keep it for
/// one computation. They are tasks of TBB: as many threads work as its limits allow, and where all are busy elsewhere
/// the caller does the whole loop.
///
/// While a team is awake, neither its owner nor the work it shares may wait for other tasks of TBB: who waits may take
/// up a member's part meanwhile, of this team or of another one, and is not back before that team ends.
class Team {
 public:
  Team();
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  /// Members, the caller among them: numbered from 0.
  std::size_t size() const { return size_; }

  /// Calls work(first, past, member) for parts of [0, n), at the same time, of `at_a_time` items or whole multiples of
  /// that, unless the whole loop is too short to be worth sharing. While much is left a member takes much at once:
  /// what members tell each other of their parts costs as much as some items do. Returns after the last of them; throws
  /// what one of them threw. Two members have one share of the items in common: the even one takes parts from
  /// its front, the odd one from its back, until they meet; then they help others. So where loops follow each other
  /// over things in the same order, a member finds in its cache what it left there. One loop at a time, always from the
  /// same thread, which is member 0.
  ///
  /// Work that holds four words at most, and may be copied byte by byte, reaches the other members together with their
  /// parts; what it refers to they fetch afterwards, one after the other, and between two processors far from each
  /// other each takes as long as an item.
  template <class Work>
  void share(std::size_t n, std::size_t at_a_time, const Work& work) {
    if constexpr (std::is_trivially_copyable_v<Work> && sizeof(Work) <= sizeof(Words)) {
      Words words{};
      std::memcpy(words.data(), &work, sizeof(Work));
      run(n, at_a_time, do_part<Work>, words);
    } else {
      share(n, at_a_time, [&work](auto... part) { work(part...); });
    }
  }

 private:
  using Words = std::array<std::uint64_t, 4>;
  using Call = void (*)(const Words& work, std::size_t first, std::size_t past, std::size_t member);

  /// What two members begin with; the others help when they are done with theirs. All of it on one line of the cache.
  struct alignas(64) Share {
    /// Number of the loop, the first part that is left, and one past the last, in 28, 18 and 18 bits.
    std::atomic<std::uint64_t> left = 0;
    std::atomic<Call> call = nullptr;
    std::atomic<std::size_t> n = 0;
    std::atomic<std::size_t> at_a_time = 1;
    std::array<std::atomic<std::uint64_t>, std::tuple_size_v<Words>> work{};
  };

  template <class Work>
  static void do_part(const Words& words, std::size_t first, std::size_t past, std::size_t member) {
    alignas(Work) std::byte work[sizeof(Work)];
    std::memcpy(work, words.data(), sizeof(Work));
    (*std::launder(reinterpret_cast<const Work*>(work)))(first, past, member);
  }

  void run(std::size_t n, std::size_t at_a_time, Call call, const Words& work);
  void help(std::size_t member);
  /// Does parts of the loop until none is left; true if there was one.
  bool do_parts(std::size_t member);
  /// Takes some parts and does them; returns their number of items, 0 when none is left.
  std::size_t do_some_of(Share& share, std::size_t member);

  std::size_t size_;
  std::vector<Share> shares_;
  alignas(64) std::atomic<std::size_t> done_ = 0;
  alignas(64) std::atomic<bool> over_ = false;
  std::mutex lock_;
  std::exception_ptr thrown_;
  bool awake_ = false;
  tbb::task_group_context context_;
  tbb::task_group helpers_;
};

}  // namespace isopath
