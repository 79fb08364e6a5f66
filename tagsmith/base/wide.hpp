// SPDX-License-Identifier: Apache-2.0
// Loops for the machine's widest vectors.
#pragma once

// Marks a function whose loops are also compiled for AVX2, eight floats an instruction; the machine
// takes which it can. Results are the same: the compiler keeps to the order of operations, and
// AVX2 brings no fused ones. Clang 16 leaves out the templates that such a function calls.
// It must not throw, so it takes no memory: gcc holds the choice between the versions for something
// that never throws, and an exception that passes it ends the program.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__AVX2__) && !defined(__clang__)
#define TAGSMITH_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define TAGSMITH_WIDE
#endif

// Before a loop: what one turn writes is read by no later one, so that turns may run side by side.
// Clang finds out by itself, and would warn wherever it may not use that.
#if defined(__GNUC__) && !defined(__clang__)
#define TAGSMITH_INDEPENDENT_TURNS _Pragma("GCC ivdep")
#else
#define TAGSMITH_INDEPENDENT_TURNS
#endif
