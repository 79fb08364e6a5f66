// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/checksum.hpp"

#include <array>
#include <fstream>
#include <glib.h>
#include <memory>

namespace tagsmith {
namespace {

struct FreeChecksum {
  void operator()(GChecksum* checksum) const { g_checksum_free(checksum); }
};
using Checksum = std::unique_ptr<GChecksum, FreeChecksum>;

Checksum begin() { return Checksum(g_checksum_new(G_CHECKSUM_SHA256)); }

void add(const Checksum& checksum, std::string_view bytes) {
  g_checksum_update(checksum.get(), reinterpret_cast<const guchar*>(bytes.data()),
                    static_cast<gssize>(bytes.size()));
}

}  // namespace

std::string sha256(std::string_view bytes) {
  const Checksum checksum = begin();
  add(checksum, bytes);
  return g_checksum_get_string(checksum.get());
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
  return std::string(g_checksum_get_string(checksum.get()));
}

}  // namespace tagsmith
