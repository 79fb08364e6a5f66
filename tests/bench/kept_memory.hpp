// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <malloc.h>

namespace tagsmith::detail {

// Memory that is freed stays with the process, so that of two that are compared neither pays for
// fresh pages because of what the other gave back (glibc manual, "Malloc Tunable Parameters").
inline void keep_freed_memory() {
  constexpr int kMost = 32 * 1024 * 1024;  // what the C library takes
  mallopt(M_MMAP_THRESHOLD, kMost);
  mallopt(M_TRIM_THRESHOLD, 32 * kMost - 1);
}

}  // namespace tagsmith::detail
