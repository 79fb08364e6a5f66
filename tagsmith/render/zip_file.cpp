// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/zip_file.hpp"

#include <cstdint>
#include <fstream>
#include <initializer_list>
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

// A number of so many bytes, the lowest first.
struct Number {
  std::uint64_t value;
  int bytes;
};

std::string bytes_of(std::initializer_list<Number> numbers) {
  std::string result;
  for (const auto& [value, bytes] : numbers) {
    for (int i = 0; i < bytes; ++i) result += static_cast<char>(value >> (8 * i) & 0xffU);
  }
  return result;
}

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
  return bytes_of({{kVersion, 2},
                   {kUtf8Names, 2},
                   {kDeflated, 2},
                   {kNoTime, 4},
                   {sum, 4},
                   {packed, 4},
                   {bytes.size(), 4},
                   {name.size(), 2},
                   {0, 2}});
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
    directory += "PK\1\2" + bytes_of({{kVersion, 2}}) + described +
                 bytes_of({{0, 2}, {0, 2}, {0, 2}, {0, 4}, {position, 4}}) + entry.name;
    put("PK\3\4" + described + entry.name);
    put(*packed);
    if (position + directory.size() > kMostInAll) return fail(too_much);
  }
  const std::uint64_t start = position;
  put(directory);
  put("PK\5\6" + bytes_of({{0, 2},
                           {0, 2},
                           {entries.size(), 2},
                           {entries.size(), 2},
                           {directory.size(), 4},
                           {start, 4},
                           {0, 2}}));
  stream.close();
  return stream ? Result<void>{} : fail(path.string() + ": cannot be written, is the disk full?");
}

}  // namespace tagsmith::detail
