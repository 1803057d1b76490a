#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace isopath {

/// Four numbers in single precision side by side, and truth values or whole numbers as many. Vectors of this width
/// exist on every processor that is built for, so that nothing is chosen at run time.
using Floats = float __attribute__((vector_size(16)));
using Ints = std::int32_t __attribute__((vector_size(16)));

inline Floats all(float value) { return Floats{value, value, value, value}; }
inline Floats min(Floats a, Floats b) {
#ifdef __SSE2__
  return _mm_min_ps(a, b);
#else
  return a < b ? a : b;
#endif
}
inline Floats max(Floats a, Floats b) {
#ifdef __SSE2__
  return _mm_max_ps(a, b);
#else
  return a > b ? a : b;
#endif
}
/// In each lane `a` where it is true, else `b`.
inline Floats select(Ints truth, Floats a, Floats b) { return Floats((truth & Ints(a)) | (~truth & Ints(b))); }

inline Floats square_root(Floats a) {
#ifdef __SSE2__
  return _mm_sqrt_ps(a);
#else
  return Floats{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
#endif
}

/// One bit for each lane that is true.
inline std::uint32_t bits(Ints truth) {
#ifdef __SSE2__
  return static_cast<std::uint32_t>(_mm_movemask_ps(Floats(truth)));
#else
  return (truth[0] & 1U) | (truth[1] & 2U) | (truth[2] & 4U) | (truth[3] & 8U);
#endif
}

/// Four records of four words each, as one vector for each word.
struct FourRecords {
  Floats first;
  Floats second;
  Floats third;
  Floats fourth;
};

/// Four words from memory.
template <typename Record>
Floats words_at(const Record* at) {
  static_assert(sizeof(Floats) % sizeof(Record) == 0);
  Floats words;
  std::memcpy(&words, at, sizeof(words));
  return words;
}
template <typename Record>
Floats words_of(const Record& record) {
  static_assert(sizeof(Record) == sizeof(Floats));
  return words_at(&record);
}

template <typename Record>
void put_words(Floats words, Record* at) {
  static_assert(sizeof(words) % sizeof(Record) == 0);
  std::memcpy(static_cast<void*>(at), &words, sizeof(words));
}

/// Rows of four vectors as columns.
inline FourRecords transposed(Floats a, Floats b, Floats c, Floats d) {
  const Floats ab = __builtin_shufflevector(a, b, 0, 4, 1, 5);
  const Floats ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const Floats cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
  const Floats cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  return {__builtin_shufflevector(ab, cd, 0, 1, 4, 5), __builtin_shufflevector(ab, cd, 2, 3, 6, 7),
          __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5), __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7)};
}

template <typename Record>
FourRecords records(const Record* at) {
  return transposed(words_of(at[0]), words_of(at[1]), words_of(at[2]), words_of(at[3]));
}

}  // namespace isopath
