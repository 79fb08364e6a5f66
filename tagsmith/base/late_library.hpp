// SPDX-License-Identifier: Apache-2.0
// Libraries that are opened when they are first needed
// (docs/decisions/0017-third-party-libraries.md).
#pragma once

#include <dlfcn.h>

namespace tagsmith::detail {

// The function of this name in a library opened by dlopen; false where it has none.
template <class Function>
bool find_function(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  return function != nullptr;
}

}  // namespace tagsmith::detail
