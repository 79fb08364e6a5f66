// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/jpeg.hpp"

#include <array>
#include <csetjmp>
#include <cstddef>
#include <jpeglib.h>
#include <utility>

namespace tagsmith::detail {
namespace {

// libjpeg leaves a file that it cannot decode by a long jump out of its error handler: no
// destructors run in between. So the functions that jump hold plain values only.
class JpegDecoder {
 public:
  JpegDecoder() {
    info_.err = jpeg_std_error(&errors_);
    info_.client_data = this;
    errors_.error_exit = [](j_common_ptr info) {
      JpegDecoder& self = of(info);
      self.errors_.format_message(info, self.failure_.data());
      std::longjmp(self.escape_, 1);
    };
    errors_.emit_message = [](j_common_ptr info, int level) {
      JpegDecoder& self = of(info);
      if (level < 0 && self.errors_.num_warnings++ == 0) {
        self.errors_.format_message(info, self.warning_.data());
      }
    };
    errors_.output_message = [](j_common_ptr) {};
  }
  ~JpegDecoder() {
    if (is_made_) jpeg_destroy_decompress(&info_);
  }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  // False when it fails, as the next.
  bool read_header(std::string_view bytes) {
    if (setjmp(escape_) != 0) return false;
    jpeg_create_decompress(&info_);
    is_made_ = true;
    jpeg_mem_src(&info_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&info_, TRUE);
    return true;
  }

  // `samples` has room for all pixels.
  bool read_rows(J_COLOR_SPACE colours, std::uint8_t* samples) {
    if (setjmp(escape_) != 0) return false;
    info_.out_color_space = colours;
    jpeg_start_decompress(&info_);
    const std::size_t row_bytes = static_cast<std::size_t>(info_.output_width) *
                                  static_cast<std::size_t>(info_.output_components);
    while (info_.output_scanline < info_.output_height) {
      JSAMPROW row = samples + static_cast<std::size_t>(info_.output_scanline) * row_bytes;
      jpeg_read_scanlines(&info_, &row, 1);
    }
    jpeg_finish_decompress(&info_);
    return true;
  }

  int components() const { return info_.num_components; }
  int width() const { return static_cast<int>(info_.image_width); }
  int height() const { return static_cast<int>(info_.image_height); }
  std::string failure() const { return failure_.data(); }

  // The first, and how many more there were.
  std::string warning() const {
    std::string words = warning_.data();
    if (errors_.num_warnings > 1) {
      words += " (and " + std::to_string(errors_.num_warnings - 1) + " more)";
    }
    return words;
  }

 private:
  static JpegDecoder& of(j_common_ptr info) {
    return *static_cast<JpegDecoder*>(info->client_data);
  }

  jpeg_decompress_struct info_{};
  jpeg_error_mgr errors_{};
  std::jmp_buf escape_{};
  std::array<char, JMSG_LENGTH_MAX> failure_{};
  std::array<char, JMSG_LENGTH_MAX> warning_{};
  bool is_made_ = false;
};

using Samples = std::vector<std::uint8_t>;

// All samples, so many a pixel; nothing when the file has components that are not decoded here.
Result<std::optional<Samples>> samples_of(JpegDecoder& decoder, std::string_view bytes,
                                          double most_pixels, J_COLOR_SPACE colours,
                                          std::size_t samples_a_pixel) {
  if (!decoder.read_header(bytes)) return fail(decoder.failure());
  // The decoder may find another header than the earlier check.
  if (static_cast<double>(decoder.width()) * decoder.height() > most_pixels) {
    return fail("it has too many pixels");
  }
  if (decoder.components() != 1 && decoder.components() != 3) return std::nullopt;
  Samples samples(samples_a_pixel * static_cast<std::size_t>(decoder.width()) *
                  static_cast<std::size_t>(decoder.height()));
  if (!decoder.read_rows(colours, samples.data())) return fail(decoder.failure());
  return samples;
}

}  // namespace

Result<std::optional<ColourImage>> decode_jpeg_colour(std::string_view bytes, double most_pixels) {
  JpegDecoder decoder;
  auto samples = samples_of(decoder, bytes, most_pixels, JCS_EXT_BGR, 3);
  if (!samples) return fail(samples);
  if (!*samples) return std::nullopt;
  return ColourImage{decoder.width(), decoder.height(), std::move(**samples)};
}

Result<std::optional<DecodedImage>> decode_jpeg(std::string_view bytes, double most_pixels) {
  JpegDecoder decoder;
  auto samples = samples_of(decoder, bytes, most_pixels, JCS_GRAYSCALE, 1);
  if (!samples) return fail(samples);
  if (!*samples) return std::nullopt;
  std::optional<DecodedImage> decoded(std::in_place);
  decoded->image = {decoder.width(), decoder.height(), std::move(**samples)};
  decoded->warning = decoder.warning();
  return decoded;
}

}  // namespace tagsmith::detail
