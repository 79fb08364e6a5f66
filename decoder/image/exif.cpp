// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/exif.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "decoder/image/bytes.hpp"
#include "decoder/image/heif.hpp"
#include "tagsmith/base/date.hpp"

namespace tagsmith::detail {
namespace {

using namespace std::string_view_literals;

// Tags of TIFF 6.0 and of CIPA DC-008, 4.6.
enum Tag : std::uint32_t {
  kMake = 271,
  kModel = 272,
  kOrientation = 274,
  kExifDirectory = 34665,
  kDateTimeOriginal = 36867,
  kOffsetTimeOriginal = 36881,
  kFocalLength = 37386,
  kFocalLengthIn35mmFilm = 41989,
};

// A TIFF structure (TIFF 6.0, section 2), as far as it is used here: first values of tags.
class Tiff {
 public:
  explicit Tiff(std::string_view text)
      : text_(text), bytes_(text, !text.empty() && text.front() == 'M') {}

  std::size_t first_directory() { return bytes_.number(4, 4); }

  // Where the tag's entry begins in the directory at this place; nothing when it has none.
  std::optional<std::size_t> entry(std::size_t directory, std::uint32_t tag) {
    const std::uint32_t count = bytes_.number(directory, 2);
    for (std::uint32_t i = 0; i < count && !bytes_.beyond(); ++i) {
      const std::size_t at = directory + 2 + std::size_t{12} * i;
      if (bytes_.number(at, 2) == tag && !bytes_.beyond()) return at;
    }
    return std::nullopt;
  }

  std::uint32_t short_at(std::size_t entry) { return bytes_.number(entry + 8, 2); }
  std::uint32_t offset_at(std::size_t entry) { return bytes_.number(entry + 8, 4); }

  // 0 where it is none.
  double rational_at(std::size_t entry) {
    const std::size_t at = offset_at(entry);
    const double numerator = bytes_.number(at, 4);
    const double denominator = bytes_.number(at + 4, 4);
    return denominator > 0 && !bytes_.beyond() ? numerator / denominator : 0;
  }

  // The tag's text in this directory; empty when it has none.
  std::string text(std::size_t directory, Tag tag) {
    const auto at = entry(directory, tag);
    return at ? text_at(*at) : std::string();
  }

  // Its text up to the first 0, of printable ASCII, without spaces at the ends.
  std::string text_at(std::size_t entry) {
    constexpr std::uint32_t kMost = 64;
    const std::uint32_t size = std::min(bytes_.number(entry + 4, 4), kMost);
    const std::size_t at = size <= 4 ? entry + 8 : offset_at(entry);
    if (at >= text_.size()) return {};
    std::string text(text_.substr(at, size));
    text.resize(std::min(text.find('\0'), text.size()));
    std::ranges::replace_if(
        text, [](char c) { return c < ' ' || c > '~'; }, '?');
    const std::size_t begin = std::min(text.find_first_not_of(' '), text.size());
    return text.substr(begin, text.find_last_not_of(' ') + 1 - begin);
  }

 private:
  std::string_view text_;
  Bytes bytes_;
};

bool is_tiff(std::string_view bytes) {
  return bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv);
}

// The TIFF structure of a TIFF, which is the file, or that in a JPEG's first APP1 segment with
// EXIF, which stands before the frame, behind other APP segments at most.
std::string_view exif_of(std::string_view bytes) {
  if (is_tiff(bytes)) return bytes;
  if (!bytes.starts_with("\xFF\xD8\xFF"sv)) return {};
  for (std::size_t at = 2; at + 4 < bytes.size() && bytes[at] == '\xFF';) {
    const auto marker = static_cast<unsigned char>(bytes[at + 1]);
    if (marker < 0xE0 || marker > 0xEF) return {};
    const std::size_t length = Bytes(bytes, true).number(at + 2, 2);
    if (length < 2) return {};
    const std::string_view segment = bytes.substr(at + 4, length - 2);
    if (marker == 0xE1 && segment.starts_with("Exif\0\0"sv)) return segment.substr(6);
    at += 2 + length;
  }
  return {};
}

}  // namespace

std::optional<int> exif_orientation(std::string_view bytes) {
  Tiff tiff(exif_of(bytes));
  const auto entry = tiff.entry(tiff.first_directory(), kOrientation);
  if (!entry) return std::nullopt;
  const std::uint32_t value = tiff.short_at(*entry);
  return value >= 1 && value <= 8 ? std::optional(static_cast<int>(value)) : std::nullopt;
}

std::string without_orientation(std::string tiff) {
  Tiff structure(tiff);
  const auto entry = structure.entry(structure.first_directory(), kOrientation);
  // The first two of the value's four bytes are a number of two bytes, in the file's order.
  if (is_tiff(tiff) && entry && *entry + 10 <= tiff.size()) {
    tiff[*entry + 8] = tiff.front() == 'M' ? 0 : 1;
    tiff[*entry + 9] = tiff.front() == 'M' ? 1 : 0;
  }
  return tiff;
}

std::optional<int> shown_orientation(std::string_view bytes) {
  return is_heif(bytes) ? heif_orientation(bytes) : exif_orientation(bytes);
}

std::optional<PhotoLens> photo_lens(std::string_view bytes) {
  const std::string of_heif = is_heif(bytes) ? heif_exif(bytes) : "";
  Tiff tiff(of_heif.empty() ? exif_of(bytes) : of_heif);
  const std::size_t first = tiff.first_directory();
  const auto model = tiff.entry(first, kModel);
  const auto more = tiff.entry(first, kExifDirectory);
  if (!model || !more) return std::nullopt;
  const std::size_t directory = tiff.offset_at(*more);
  const auto equivalent = tiff.entry(directory, kFocalLengthIn35mmFilm);
  PhotoLens lens{tiff.text_at(*model)};
  if (!equivalent || lens.camera.empty() || tiff.short_at(*equivalent) == 0) return std::nullopt;
  lens.focal_35_mm = tiff.short_at(*equivalent);
  if (const auto focal = tiff.entry(directory, kFocalLength)) {
    lens.focal_mm = tiff.rational_at(*focal);
  }
  const std::string by = tiff.text(first, kMake);
  if (!by.empty() && !lens.camera.starts_with(by)) lens.camera = by + " " + lens.camera;
  return lens;
}

std::optional<std::string> photo_moment(std::string_view bytes) {
  const std::string of_heif = is_heif(bytes) ? heif_exif(bytes) : "";
  Tiff tiff(of_heif.empty() ? exif_of(bytes) : of_heif);
  const auto more = tiff.entry(tiff.first_directory(), kExifDirectory);
  if (!more) return std::nullopt;
  const std::size_t directory = tiff.offset_at(*more);
  // "2026:03:31 14:05:09"
  std::string moment = tiff.text(directory, kDateTimeOriginal);
  if (moment.size() < 11 || moment[4] != ':' || moment[7] != ':' || moment[10] != ' ') {
    return std::nullopt;
  }
  moment[4] = moment[7] = '-';
  moment[10] = 'T';
  if (!is_moment(moment) || moment.starts_with("0000")) return std::nullopt;
  const std::string with_offset = moment + tiff.text(directory, kOffsetTimeOriginal);
  return is_moment(with_offset) ? with_offset : moment;
}

}  // namespace tagsmith::detail
