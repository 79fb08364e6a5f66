// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/codecs.hpp"

#include <dlfcn.h>
#include <type_traits>

#include <opencv2/imgcodecs.hpp>

namespace tagsmith {
namespace {

// What is looked up by name below has these types.
static_assert(std::is_same_v<decltype(Codecs::encode), decltype(&cv::imencode)>);
static_assert(std::is_same_v<decltype(Codecs::decode),
                             decltype(static_cast<decltype(Codecs::decode)>(&cv::imdecode))>);

// Names of C++ functions as the compiler writes them (Itanium C++ ABI, section 5.1).
constexpr const char* kDecode = "_ZN2cv8imdecodeERKNS_11_InputArrayEi";
constexpr const char* kEncode =
    "_ZN2cv8imencodeERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKNS_11_InputArrayERSt6"
    "vectorIhSaIhEERKSB_IiSaIiEE";

Result<Codecs> load_codecs() {
  void* library = dlopen(TAGSMITH_CODECS, RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr) return fail(std::string("OpenCV's codecs are missing: ") + dlerror());
  Codecs codecs;
  codecs.decode = reinterpret_cast<decltype(codecs.decode)>(dlsym(library, kDecode));
  codecs.encode = reinterpret_cast<decltype(codecs.encode)>(dlsym(library, kEncode));
  if (codecs.decode == nullptr || codecs.encode == nullptr) {
    return fail(TAGSMITH_CODECS " is not the library that this program was built with");
  }
  return codecs;
}

}  // namespace

const Result<Codecs>& codecs() {
  static const Result<Codecs> loaded = load_codecs();
  return loaded;
}

}  // namespace tagsmith
