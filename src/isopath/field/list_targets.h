#pragma once

/// One portable, one common and one wide instruction set on x86-64; more would only cost time to compile.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
