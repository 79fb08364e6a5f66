// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/codecs.hpp"

#include <dlfcn.h>

namespace tagsmith::detail {
namespace {

Result<Codecs> load_codecs() {
  // Found by the search path of the program or library that this is linked into.
  void* module = dlopen("tagsmith_codecs.so", RTLD_LAZY | RTLD_LOCAL);
  if (module == nullptr) return fail(std::string("OpenCV's codecs are missing: ") + dlerror());
  const auto table =
      reinterpret_cast<decltype(&tagsmith_opencv_codecs)>(dlsym(module, "tagsmith_opencv_codecs"));
  if (table == nullptr) return fail("tagsmith_codecs.so is not the module of this program");
  return *table();
}

}  // namespace

const Result<Codecs>& codecs() {
  static const Result<Codecs> loaded = load_codecs();
  return loaded;
}

}  // namespace tagsmith::detail
