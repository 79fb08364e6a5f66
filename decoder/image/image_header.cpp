// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/image_header.hpp"

#include <algorithm>
#include <cctype>

#include "decoder/image/bytes.hpp"
#include "decoder/image/png_chunks.hpp"

namespace tagsmith::detail {
namespace {

using namespace std::string_view_literals;

std::optional<ImageHeader> header_of(const Bytes& bytes, std::uint32_t width, std::uint32_t height,
                                     bool complete = true) {
  if (bytes.beyond() || width == 0 || height == 0) return std::nullopt;
  return ImageHeader{width, height, complete};
}

// ISO/IEC 15948, 11.2.2 IHDR and 11.2.5 IEND.
std::optional<ImageHeader> read_png(std::string_view text) {
  Bytes bytes(text, true);
  const bool complete = text.find("IEND"sv) != std::string_view::npos;
  return header_of(bytes, bytes.number(16, 4), bytes.number(20, 4), complete);
}

// ITU-T T.81, B.1.1.3: the frame header (SOF) among the marker segments; the end of the image (EOI)
// cannot occur within the coded data that follow it.
std::optional<ImageHeader> read_jpeg(std::string_view text) {
  Bytes bytes(text, true);
  std::size_t at = 2;
  while (!bytes.beyond()) {
    if (bytes.number(at, 1) != 0xFF) return std::nullopt;
    const std::uint32_t marker = bytes.number(at + 1, 1);
    if (marker == 0xFF) {  // fill byte
      ++at;
      continue;
    }
    const bool is_frame =
        marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame) {
      const bool complete = text.find("\xFF\xD9"sv, at) != std::string_view::npos;
      return header_of(bytes, bytes.number(at + 7, 2), bytes.number(at + 5, 2), complete);
    }
    const std::size_t length = bytes.number(at + 2, 2);
    if (length < 2) return std::nullopt;
    at += 2 + length;
  }
  return std::nullopt;
}

// RFC 9649, 2.5 to 2.7.
std::optional<ImageHeader> read_webp(std::string_view text) {
  Bytes bytes(text);
  const std::string_view kind = text.substr(12, 4);
  const bool complete = text.size() >= std::size_t{8} + bytes.number(4, 4);
  if (kind == "VP8X"sv) {
    constexpr std::uint32_t kAnimated = 2;
    auto header = header_of(bytes, 1 + bytes.number(24, 3), 1 + bytes.number(27, 3), complete);
    if (header) header->has_more = (bytes.number(20, 1) & kAnimated) != 0;
    return header;
  }
  if (kind == "VP8L"sv) {
    const std::uint32_t bits = bytes.number(21, 4);
    return header_of(bytes, 1 + (bits & 0x3FFFU), 1 + (bits >> 14U & 0x3FFFU), complete);
  }
  if (kind != "VP8 "sv) return std::nullopt;
  return header_of(bytes, bytes.number(26, 2) & 0x3FFFU, bytes.number(28, 2) & 0x3FFFU, complete);
}

// TIFF 6.0, section 2: of a directory NewSubfileType (254), ImageWidth (256), ImageLength (257).
struct TiffDirectory {
  std::uint32_t kind = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::size_t next = 0;  // where the next directory begins; 0 = none
};

TiffDirectory read_tiff_directory(Bytes& bytes, std::size_t at) {
  TiffDirectory directory;
  const std::uint32_t count = bytes.number(at, 2);
  for (std::uint32_t i = 0; i < count && !bytes.beyond(); ++i) {
    const std::size_t entry = at + 2 + std::size_t{12} * i;
    const std::uint32_t tag = bytes.number(entry, 2);
    constexpr std::uint32_t kShort = 3;
    const std::size_t size = bytes.number(entry + 2, 2) == kShort ? 2 : 4;
    if (tag == 254) directory.kind = bytes.number(entry + 8, size);
    if (tag == 256) directory.width = bytes.number(entry + 8, size);
    if (tag == 257) directory.height = bytes.number(entry + 8, size);
  }
  Bytes rest = bytes;
  const std::size_t next = rest.number(at + 2 + std::size_t{12} * count, 4);
  if (!rest.beyond()) directory.next = next;
  return directory;
}

// Further directories are further pages, unless they are the first one in small, or a mask of it.
bool has_further_pages(std::string_view text, std::size_t directory) {
  constexpr int kMostLooked = 16;
  for (int i = 0; i < kMostLooked && directory != 0; ++i) {
    Bytes bytes(text, text.front() == 'M');
    const TiffDirectory further = read_tiff_directory(bytes, directory);
    if (bytes.beyond()) return false;
    constexpr std::uint32_t kReduced = 1, kMask = 4;
    if ((further.kind & (kReduced | kMask)) == 0) return true;
    directory = further.next;
  }
  return false;
}

std::optional<ImageHeader> read_tiff(std::string_view text) {
  Bytes bytes(text, text.front() == 'M');
  const std::size_t at = bytes.number(4, 4);
  const TiffDirectory first = read_tiff_directory(bytes, at);
  auto header = header_of(bytes, first.width, first.height);
  if (header) header->has_more = has_further_pages(text, first.next);
  return header;
}

// Netpbm: "P", a digit, then width and height as text among white space and # comments.
std::optional<ImageHeader> read_pnm(std::string_view text) {
  std::size_t at = 2;
  const auto number = [&]() -> std::uint32_t {
    while (at < text.size() &&
           (std::isspace(static_cast<unsigned char>(text[at])) != 0 || text[at] == '#')) {
      at = text[at] == '#' ? std::min(text.find('\n', at), text.size()) : at + 1;
    }
    std::uint32_t value = 0;
    constexpr std::uint32_t kMost = 100'000'000;
    for (; at < text.size() && text[at] >= '0' && text[at] <= '9' && value < kMost; ++at) {
      value = 10 * value + static_cast<std::uint32_t>(text[at] - '0');
    }
    return value;
  };
  const std::uint32_t width = number();
  const std::uint32_t height = number();
  return header_of(Bytes(text), width, height);
}

// BITMAPCOREHEADER has 12 bytes and 16-bit sizes, its successors 32-bit ones; a negative height
// means that the rows come from the top.
std::optional<ImageHeader> read_bmp(std::string_view text) {
  Bytes bytes(text);
  if (bytes.number(14, 4) == 12) return header_of(bytes, bytes.number(18, 2), bytes.number(20, 2));
  const auto height = static_cast<std::int32_t>(bytes.number(22, 4));
  const std::uint32_t rows =
      height < 0 ? 0U - static_cast<std::uint32_t>(height) : static_cast<std::uint32_t>(height);
  return header_of(bytes, bytes.number(18, 4), rows);
}

}  // namespace

std::optional<ImageHeader> read_image_header(std::string_view bytes) {
  if (is_png(bytes)) return read_png(bytes);
  if (bytes.starts_with("\xFF\xD8\xFF"sv)) return read_jpeg(bytes);
  if (bytes.starts_with("RIFF"sv) && bytes.size() > 16 && bytes.substr(8, 4) == "WEBP"sv) {
    return read_webp(bytes);
  }
  if (bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv)) return read_tiff(bytes);
  if (bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6') {
    return read_pnm(bytes);
  }
  if (bytes.starts_with("BM"sv)) return read_bmp(bytes);
  return std::nullopt;
}

}  // namespace tagsmith::detail
