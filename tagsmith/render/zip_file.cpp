// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/zip_file.hpp"

#include <cstdint>
#include <fstream>
#include <optional>
#include <zlib.h>

#include "tagsmith/base/file.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::size_t kMostEntries = 65'534;
constexpr std::size_t kMostBytes = 1U << 30U;       // of an entry
constexpr std::uint64_t kMostInAll = 0xffff'0000U;  // of the ZIP
constexpr std::uint16_t kVersion = 20;              // 2.0: deflate
constexpr std::uint16_t kUtf8Names = 1U << 11U;
constexpr std::uint16_t kDeflated = 8;
constexpr std::uint32_t kNoTime = (1U << 5U | 1U)
                                  << 16U;  // 1 January 1980, the earliest possible date

// Little-endian numbers.
class Bytes {
 public:
  Bytes& two(std::uint64_t value) { return number(value, 2); }
  Bytes& four(std::uint64_t value) { return number(value, 4); }
  Bytes& text(const std::string& value) {
    bytes_ += value;
    return *this;
  }
  const std::string& str() const { return bytes_; }

 private:
  Bytes& number(std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i) bytes_ += static_cast<char>(value >> (8 * i) & 0xffU);
    return *this;
  }

  std::string bytes_;
};

// Without zlib's own head and sum (RFC 1951).
std::optional<std::string> raw_deflated(const std::string& bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, MAX_MEM_LEVEL,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    return std::nullopt;
  }
  std::string result(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  const int status = deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return status == Z_STREAM_END ? std::optional(std::move(result)) : std::nullopt;
}

// The part that a file's own head and its line in the directory share.
std::string description(const std::string& name, const std::string& bytes, std::size_t packed) {
  const auto sum = crc32(crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(bytes.data()),
                         static_cast<uInt>(bytes.size()));
  return Bytes()
      .two(kVersion)
      .two(kUtf8Names)
      .two(kDeflated)
      .four(kNoTime)
      .four(sum)
      .four(packed)
      .four(bytes.size())
      .two(name.size())
      .two(0)
      .str();
}

}  // namespace

Result<void> write_zip(const std::filesystem::path& path, std::span<const ZipEntry> entries) {
  const std::string too_much = path.string() +
                               ": more than a ZIP holds, 65,534 files and 4 GB: print in parts "
                               "(--tags, --only), or with --single";
  if (entries.size() > kMostEntries) return fail(too_much);
  std::ofstream stream(path, std::ios::binary);
  std::string directory;
  std::uint64_t position = 0;
  const auto put = [&](const std::string& bytes) {
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    position += bytes.size();
  };
  for (const ZipEntry& entry : entries) {
    const Result<std::string> bytes = read_file(entry.file, kMostBytes);
    if (!bytes) return fail(bytes);
    const std::optional<std::string> packed = raw_deflated(*bytes);
    if (!packed) return fail(path.string() + ": " + entry.name + " cannot be compressed");
    const std::string described = description(entry.name, *bytes, packed->size());
    directory += Bytes()
                     .text("PK\1\2")
                     .two(kVersion)
                     .text(described)
                     .two(0)
                     .two(0)
                     .two(0)
                     .four(0)
                     .four(position)
                     .text(entry.name)
                     .str();
    put("PK\3\4" + described + entry.name);
    put(*packed);
    if (position + directory.size() > kMostInAll) return fail(too_much);
  }
  const std::uint64_t start = position;
  put(directory);
  put(Bytes()
          .text("PK\5\6")
          .two(0)
          .two(0)
          .two(entries.size())
          .two(entries.size())
          .four(directory.size())
          .four(start)
          .two(0)
          .str());
  stream.close();
  return stream ? Result<void>{} : fail(path.string() + ": cannot be written, is the disk full?");
}

}  // namespace tagsmith::detail
