// SPDX-License-Identifier: Apache-2.0
// Loops for the machine's widest vectors.
#pragma once

// Marks a function whose loops are also compiled for AVX2, eight floats an instruction; the machine
// uses the version that it supports. Results are the same: the compiler keeps the order of
// operations, and AVX2 adds no fused ones. Clang 16 does not include the templates that such a
// function calls. It must not throw, so it allocates no memory: gcc assumes that the choice between
// the versions never throws, and an exception that passes it ends the program.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__AVX2__) && !defined(__clang__)
#define TAGSMITH_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define TAGSMITH_WIDE
#endif

// Before a loop: the results of one iteration are not read by later ones, so that iterations may
// run in parallel. Clang detects this itself, and would warn wherever it may not use it.
#if defined(__GNUC__) && !defined(__clang__)
#define TAGSMITH_INDEPENDENT_TURNS _Pragma("GCC ivdep")
#else
#define TAGSMITH_INDEPENDENT_TURNS
#endif
