// SPDX-License-Identifier: Apache-2.0
// Which version of the library is loaded.
#pragma once

#include <tagsmith/export.hpp>

namespace tagsmith {

// "1.2.3" (Semantic Versioning 2.0.0), of the library that the program runs with.
TAGSMITH_EXPORT const char* version() noexcept;

}  // namespace tagsmith
