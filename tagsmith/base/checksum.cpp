// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/checksum.hpp"

#include <array>
#include <fstream>
#include <memory>

#include <openssl/evp.h>

namespace tagsmith::detail {
namespace {

struct FreeContext {
  void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
};
using Checksum = std::unique_ptr<EVP_MD_CTX, FreeContext>;

// libcrypto's default provider always has SHA-256: a call below can fail only if memory runs out.
// The provider is looked for once (OpenSSL's crypto(7), "Performance"), and kept to the end of the
// program.
Checksum begin() {
  static const EVP_MD* const kSha256 = EVP_MD_fetch(nullptr, "SHA256", nullptr);
  Checksum checksum(EVP_MD_CTX_new());
  EVP_DigestInit_ex2(checksum.get(), kSha256, nullptr);
  return checksum;
}

void add(const Checksum& checksum, std::string_view bytes) {
  EVP_DigestUpdate(checksum.get(), bytes.data(), bytes.size());
}

std::string hexadecimal(const Checksum& checksum) {
  std::array<unsigned char, 32> digest{};
  EVP_DigestFinal_ex(checksum.get(), digest.data(), nullptr);
  std::string text;
  for (const unsigned char byte : digest) {
    text += "0123456789abcdef"[byte >> 4U];
    text += "0123456789abcdef"[byte & 15U];
  }
  return text;
}

}  // namespace

std::string sha256(std::string_view bytes) {
  const Checksum checksum = begin();
  add(checksum, bytes);
  return hexadecimal(checksum);
}

Result<std::string> sha256_of_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return fail(path.string() + ": cannot be read");
  const Checksum checksum = begin();
  std::array<char, 1U << 16U> buffer;
  while (stream.read(buffer.data(), buffer.size()) || stream.gcount() > 0) {
    add(checksum, {buffer.data(), static_cast<std::size_t>(stream.gcount())});
  }
  if (stream.bad()) return fail(path.string() + ": cannot be read");
  return hexadecimal(checksum);
}

}  // namespace tagsmith::detail
