// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/heif.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <dlfcn.h>
#include <memory>

#include <libheif/heif.h>

#include "decoder/image/bytes.hpp"
#include "tagsmith/base/late_library.hpp"

namespace tagsmith::detail {
namespace {

using namespace std::string_view_literals;

// --- libheif ---

// The library's functions by name: if it were linked, it and its codecs would be loaded at every
// start of the program (docs/decisions/0017-third-party-libraries.md).
struct Libheif {
  decltype(&::heif_context_alloc) context_alloc = nullptr;
  decltype(&::heif_context_free) context_free = nullptr;
  decltype(&::heif_context_set_max_decoding_threads) set_max_threads = nullptr;
  decltype(&::heif_context_read_from_memory_without_copy) read = nullptr;
  decltype(&::heif_context_get_primary_image_handle) primary_image = nullptr;
  decltype(&::heif_image_handle_release) handle_release = nullptr;
  decltype(&::heif_image_handle_get_width) handle_width = nullptr;
  decltype(&::heif_image_handle_get_height) handle_height = nullptr;
  decltype(&::heif_image_handle_get_list_of_metadata_block_IDs) metadata_ids = nullptr;
  decltype(&::heif_image_handle_get_metadata_size) metadata_size = nullptr;
  decltype(&::heif_image_handle_get_metadata) metadata = nullptr;
  decltype(&::heif_decoding_options_alloc) options_alloc = nullptr;
  decltype(&::heif_decoding_options_free) options_free = nullptr;
  decltype(&::heif_decode_image) decode = nullptr;
  decltype(&::heif_image_release) image_release = nullptr;
  decltype(&::heif_image_get_width) width = nullptr;
  decltype(&::heif_image_get_height) height = nullptr;
  decltype(&::heif_image_get_bits_per_pixel_range) bits = nullptr;
  decltype(&::heif_image_get_plane_readonly) plane = nullptr;
};

Result<Libheif> load_libheif() {
  void* library = dlopen("libheif.so.1", RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr) return fail(std::string("libheif is missing: ") + dlerror());
  Libheif heif;
  const bool whole =
      find_function(library, "heif_context_alloc", heif.context_alloc) &&
      find_function(library, "heif_context_free", heif.context_free) &&
      find_function(library, "heif_context_set_max_decoding_threads", heif.set_max_threads) &&
      find_function(library, "heif_context_read_from_memory_without_copy", heif.read) &&
      find_function(library, "heif_context_get_primary_image_handle", heif.primary_image) &&
      find_function(library, "heif_image_handle_release", heif.handle_release) &&
      find_function(library, "heif_image_handle_get_width", heif.handle_width) &&
      find_function(library, "heif_image_handle_get_height", heif.handle_height) &&
      find_function(library, "heif_image_handle_get_list_of_metadata_block_IDs",
                    heif.metadata_ids) &&
      find_function(library, "heif_image_handle_get_metadata_size", heif.metadata_size) &&
      find_function(library, "heif_image_handle_get_metadata", heif.metadata) &&
      find_function(library, "heif_decoding_options_alloc", heif.options_alloc) &&
      find_function(library, "heif_decoding_options_free", heif.options_free) &&
      find_function(library, "heif_decode_image", heif.decode) &&
      find_function(library, "heif_image_release", heif.image_release) &&
      find_function(library, "heif_image_get_width", heif.width) &&
      find_function(library, "heif_image_get_height", heif.height) &&
      find_function(library, "heif_image_get_bits_per_pixel_range", heif.bits) &&
      find_function(library, "heif_image_get_plane_readonly", heif.plane);
  if (!whole) return fail("libheif is older than version 1.13");
  return heif;
}

const Result<Libheif>& libheif() {
  static const Result<Libheif> loaded = load_libheif();
  return loaded;
}

// One channel of a decoded picture.
struct Decoded {
  std::shared_ptr<heif_image> image;
  int width = 0;
  int height = 0;
  int bits = 0;
  int stride = 0;
  const std::uint8_t* rows = nullptr;

  const std::uint8_t* row(int y) const { return rows + static_cast<std::ptrdiff_t>(y) * stride; }
};

Error in_words(const heif_error& error) {
  return {error.message == nullptr ? "unknown error" : error.message};
}

bool too_large(int width, int height, double most_pixels) {
  return static_cast<double>(width) * height > most_pixels;
}

// The primary image of a file, not yet decoded. Refers to the file's bytes.
struct Primary {
  std::shared_ptr<heif_context> context;
  std::shared_ptr<heif_image_handle> handle;
};

Result<Primary> primary_of(const Libheif& heif, std::string_view bytes) {
  Primary primary{{heif.context_alloc(), heif.context_free}, {}};
  heif.set_max_threads(primary.context.get(), 0);  // several files are read at the same time
  heif_error error = heif.read(primary.context.get(), bytes.data(), bytes.size(), nullptr);
  if (error.code != heif_error_Ok) return tl::unexpected(in_words(error));
  heif_image_handle* handle = nullptr;
  error = heif.primary_image(primary.context.get(), &handle);
  if (error.code != heif_error_Ok) return tl::unexpected(in_words(error));
  primary.handle = {handle, heif.handle_release};
  return primary;
}

// A channel of the primary image in the requested colours, before any turning and cropping: as
// stored.
Result<Decoded> decode(std::string_view bytes, double most_pixels, heif_colorspace colours,
                       heif_chroma chroma, heif_channel channel) {
  const Result<Libheif>& library = libheif();
  if (!library) return fail(library);
  const Libheif& heif = *library;
  const Result<Primary> primary = primary_of(heif, bytes);
  if (!primary) return fail(primary);
  heif_image_handle* handle = primary->handle.get();
  if (too_large(heif.handle_width(handle), heif.handle_height(handle), most_pixels)) {
    return fail("it has too many pixels");
  }
  const std::shared_ptr<heif_decoding_options> options(heif.options_alloc(), heif.options_free);
  options->ignore_transformations = 1;
  heif_image* image = nullptr;
  const heif_error error = heif.decode(handle, &image, colours, chroma, options.get());
  if (error.code != heif_error_Ok) return tl::unexpected(in_words(error));
  Decoded decoded{std::shared_ptr<heif_image>(image, heif.image_release)};
  decoded.width = heif.width(image, channel);
  decoded.height = heif.height(image, channel);
  decoded.bits = heif.bits(image, channel);
  decoded.rows = heif.plane(image, channel, &decoded.stride);
  if (decoded.rows == nullptr) return fail("it has no luma, expected YCbCr or grey");
  if (too_large(decoded.width, decoded.height, most_pixels)) return fail("it has too many pixels");
  return decoded;
}

// --- boxes ---

// 0 where the bytes end before.
std::uint32_t number(std::string_view bytes, std::size_t at, std::size_t size) {
  return Bytes(bytes, true).number(at, size);
}

// ISO/IEC 14496-12, 4.2: a size of 4 bytes that counts itself, a type of 4, contents.
struct Box {
  std::string_view type;
  std::string_view contents;
};

// Cuts the first box off; nothing where there is none.
std::optional<Box> next_box(std::string_view& bytes) {
  constexpr std::size_t kHeader = 8;
  if (bytes.size() < kHeader) return std::nullopt;
  const std::size_t size = number(bytes, 0, 4);
  if (size < kHeader || size > bytes.size()) return std::nullopt;
  const Box box{bytes.substr(4, 4), bytes.substr(kHeader, size - kHeader)};
  bytes.remove_prefix(size);
  return box;
}

std::string_view contents_of(std::string_view boxes, std::string_view type) {
  while (const std::optional<Box> box = next_box(boxes)) {
    if (box->type == type) return box->contents;
  }
  return {};
}

// The numbers, from 1, of an item's properties in the order in which they apply (ISO/IEC 23008-12,
// 9.3.1, ItemPropertyAssociationBox).
std::vector<std::uint32_t> properties_of(std::string_view box, std::uint32_t item) {
  const std::size_t id_size = number(box, 0, 1) < 1 ? 2 : 4;
  const bool is_wide = (number(box, 3, 1) & 1U) != 0;
  const std::uint32_t entries = number(box, 4, 4);
  std::size_t at = 8;
  for (std::uint32_t i = 0; i < entries && at < box.size(); ++i) {
    const std::uint32_t id = number(box, at, id_size);
    const std::uint32_t count = number(box, at + id_size, 1);
    at += id_size + 1;
    std::vector<std::uint32_t> properties;
    for (std::uint32_t k = 0; k < count; ++k, at += is_wide ? 2 : 1) {
      properties.push_back(is_wide ? number(box, at, 2) & 0x7FFFU : number(box, at, 1) & 0x7FU);
    }
    if (id == item) return properties;
  }
  return {};
}

// EXIF's number of a picture that is mirrored left for right or not, and then turned clockwise by
// quarters.
int exif_number(bool is_mirrored, std::uint32_t quarters) {
  constexpr std::array<int, 4> kTurned{1, 6, 3, 8};
  constexpr std::array<int, 4> kMirrored{2, 7, 4, 5};
  return (is_mirrored ? kMirrored : kTurned)[quarters % 4];
}

std::string_view brand_of(std::string_view bytes) {
  return bytes.size() >= 12 && bytes.substr(4, 4) == "ftyp"sv ? bytes.substr(8, 4)
                                                              : std::string_view();
}

}  // namespace

bool is_heif(std::string_view bytes) {
  constexpr std::array kBrands{"heic"sv, "heix"sv, "hevc"sv, "hevx"sv, "heim"sv,
                               "heis"sv, "mif1"sv, "msf1"sv, "avif"sv, "avis"sv};
  return std::ranges::find(kBrands, brand_of(bytes)) != kBrands.end();
}

bool is_video(std::string_view bytes) {
  const std::string_view box = bytes.substr(std::min<std::size_t>(4, bytes.size()));
  return (!brand_of(bytes).empty() && !is_heif(bytes)) || box.starts_with("moov"sv) ||
         box.starts_with("mdat"sv) || bytes.starts_with("\0\0\0\x08wide"sv) ||
         bytes.starts_with("\x1A\x45\xDF\xA3"sv) || bytes.starts_with("\0\0\1\xBA"sv) ||
         (bytes.starts_with("RIFF"sv) && bytes.find("AVI "sv) == 8);
}

std::optional<int> heif_orientation(std::string_view bytes) {
  constexpr std::size_t kVersion = 4;  // bytes of version and flags
  std::string_view meta = contents_of(bytes, "meta");
  meta.remove_prefix(std::min(kVersion, meta.size()));
  const std::string_view primary = contents_of(meta, "pitm");
  const std::size_t id_size = number(primary, 0, 1) == 0 ? 2 : 4;
  const std::string_view all = contents_of(meta, "iprp");
  std::vector<Box> properties;
  std::string_view rest = contents_of(all, "ipco");
  while (const std::optional<Box> box = next_box(rest)) properties.push_back(*box);
  bool is_mirrored = false;
  std::uint32_t quarters = 0;  // clockwise
  bool is_said = false;
  for (const std::uint32_t i :
       properties_of(contents_of(all, "ipma"), number(primary, kVersion, id_size))) {
    if (i == 0 || i > properties.size()) continue;
    const Box& property = properties[i - 1];
    const std::uint32_t value = number(property.contents, 0, 1);
    is_said = is_said || property.type == "irot" || property.type == "imir";
    if (property.type == "irot") quarters += 4 - value % 4;  // it turns anticlockwise
    if (property.type != "imir") continue;
    // A mirror after a turn is the opposite turn after the mirror; one from top to bottom is one
    // from left to right and half a turn.
    is_mirrored = !is_mirrored;
    quarters = (4 - quarters % 4) + (value % 2 == 0 ? 2 : 0);
  }
  if (!is_said) return std::nullopt;
  return exif_number(is_mirrored, quarters);
}

// ISO/IEC 23008-12, A.2.1: four bytes give the distance behind them where the TIFF structure
// begins.
std::string heif_exif(std::string_view bytes) {
  const Result<Libheif>& heif = libheif();
  if (!heif) return {};
  const Result<Primary> primary = primary_of(*heif, bytes);
  if (!primary) return {};
  heif_item_id id = 0;
  heif_image_handle* handle = primary->handle.get();
  if (heif->metadata_ids(handle, "Exif", &id, 1) != 1) return {};
  std::string block(heif->metadata_size(handle, id), '\0');
  if (block.size() < 4 || heif->metadata(handle, id, block.data()).code != heif_error_Ok) return {};
  const std::size_t begin = std::size_t{4} + number(block, 0, 4);
  return begin < block.size() ? block.substr(begin) : std::string();
}

Result<GrayImage> decode_heif(std::string_view bytes, double most_pixels) {
  const auto decoded =
      decode(bytes, most_pixels, heif_colorspace_YCbCr, heif_chroma_420, heif_channel_Y);
  if (!decoded) return fail(decoded);
  const int width = decoded->width;
  const int bits = decoded->bits;
  GrayImage image{width, decoded->height, {}};
  image.samples.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* row = decoded->row(y);
    if (bits <= 8) {
      image.samples.insert(image.samples.end(), row, row + width);
      continue;
    }
    const auto* deep = reinterpret_cast<const std::uint16_t*>(row);
    std::transform(deep, deep + width, std::back_inserter(image.samples),
                   [&](std::uint16_t v) { return static_cast<std::uint8_t>(v >> (bits - 8)); });
  }
  return image;
}

Result<ColourImage> decode_heif_colour(std::string_view bytes, double most_pixels) {
  const auto decoded = decode(bytes, most_pixels, heif_colorspace_RGB, heif_chroma_interleaved_RGB,
                              heif_channel_interleaved);
  if (!decoded) return fail(decoded);
  ColourImage image{decoded->width, decoded->height, {}};
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* row = decoded->row(y);
    for (int x = 0; x < image.width; ++x, row += 3) {
      image.samples.insert(image.samples.end(), {row[2], row[1], row[0]});
    }
  }
  return image;
}

}  // namespace tagsmith::detail
