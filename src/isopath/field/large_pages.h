#pragma once

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace isopath {

/// Asks the system for large pages below big arrays: a method that touches every element only a few times spends
/// as long on page faults as on its work otherwise. Where the system has no say in it, an ordinary allocator. Elements
/// that come without a value are left uninitialised where their type allows it, so that no page is touched too early.
template <typename T>
struct LargePageAllocator {
  using value_type = T;

  LargePageAllocator() = default;
  template <typename U>
  LargePageAllocator(const LargePageAllocator<U>&) {}  // NOLINT(google-explicit-constructor): allocators rebind

  T* allocate(std::size_t n) {
    if (n * sizeof(T) < page) return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{alignment}));
    void* memory = ::operator new (n * sizeof(T), std::align_val_t{page});
#ifdef __linux__
    madvise(memory, n * sizeof(T), MADV_HUGEPAGE);  // a wish: refusal changes nothing but time
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t n) {
    ::operator delete (memory, std::align_val_t{n * sizeof(T) < page ? alignment : page});
  }
  template <typename U, typename... Values>
  void construct(U* at, Values&&... values) {
    if constexpr (sizeof...(Values) == 0) {
      ::new (static_cast<void*>(at)) U;
    } else {
      ::new (static_cast<void*>(at)) U(std::forward<Values>(values)...);
    }
  }
  friend bool operator==(const LargePageAllocator&, const LargePageAllocator&) { return true; }

 private:
  static constexpr std::size_t page = std::size_t{1} << 21;
  static constexpr std::size_t alignment = 64;
};

template <typename T>
using LargeVector = std::vector<T, LargePageAllocator<T>>;

}  // namespace isopath
