#pragma once

namespace isopath {

/// Calls what lies there into the cache to be written: another thread's cache gives it up at once, and not only when it
/// is written. The compiler's own prefetch means reading, unless it may rely on younger processors; older ones take
/// this instruction for none.
inline void prefetch_to_write(const void* at) {
#ifdef __x86_64__
  asm volatile("prefetchw %0" : : "m"(*static_cast<const char*>(at)));
#else
  __builtin_prefetch(at, 1);
#endif
}

}  // namespace isopath
