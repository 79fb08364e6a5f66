// SPDX-License-Identifier: Apache-2.0
// For the few loops over whole images whose time shows.
#pragma once

// Compiles a function a second time for processors with AVX2; which of the two runs is settled when
// the program starts (GCC manual, "Function Multiversioning"). The processor is asked before a
// sanitizer is ready to watch, so not under one. Such functions work on whole numbers, or on floats
// without fused operations, so that results are the same on all processors.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TAGSMITH_ALSO_AVX2 __attribute__((target_clones("avx2", "default")))
#else
#define TAGSMITH_ALSO_AVX2
#endif
