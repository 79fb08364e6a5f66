// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/png.hpp"

#include <algorithm>
#include <cairo.h>
#include <cmath>
#include <cstdint>
#include <png.h>
#include <vector>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/render/sheet_on_cairo.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {
namespace {

constexpr int kMostSide = 30'000;  // Cairo's limit is 32767
constexpr int kBandRows = 512;

// Rows of the sheet as PNG has them.
class BandPainter {
 public:
  BandPainter(const Sheet& sheet, int width, int height, double pixels_per_metre,
              PngColours colours)
      : sheet_(sheet),
        width_(width),
        scale_(pixels_per_metre),
        grey_(colours == PngColours::grey),
        surface_(
            cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, std::min(kBandRows, height))),
        row_(static_cast<std::size_t>(width) * (grey_ ? 1 : 3)) {}

  bool ok() const { return cairo_surface_status(surface_.get()) == CAIRO_STATUS_SUCCESS; }

  // Rows are requested one after the other.
  const unsigned char* row(int number) {
    if (number % kBandRows == 0) paint(number);
    const unsigned char* pixels = cairo_image_surface_get_data(surface_.get()) +
                                  static_cast<std::ptrdiff_t>(number % kBandRows) *
                                      cairo_image_surface_get_stride(surface_.get());
    const auto* colours = reinterpret_cast<const std::uint32_t*>(pixels);
    if (grey_) {  // red, green and blue are the same
      std::transform(colours, colours + width_, row_.begin(),
                     [](std::uint32_t colour) { return static_cast<unsigned char>(colour); });
      return row_.data();
    }
    for (std::size_t i = 0; i < row_.size(); ++i) {
      row_[i] = static_cast<unsigned char>(colours[i / 3] >> (8 * (2 - i % 3)));
    }
    return row_.data();
  }

 private:
  void paint(int first_row) {
    const CairoContext context(cairo_create(surface_.get()));
    cairo_set_source_rgb(context.get(), 1, 1, 1);
    cairo_paint(context.get());
    cairo_translate(context.get(), 0, -first_row);
    draw_sheet(context.get(), sheet_, scale_);
    cairo_surface_flush(surface_.get());
  }

  const Sheet& sheet_;
  int width_;
  double scale_;
  bool grey_;
  CairoSurface surface_;
  std::vector<unsigned char> row_;
};

void append(png_structp png, png_bytep data, png_size_t length) {
  static_cast<std::string*>(png_get_io_ptr(png))
      ->append(reinterpret_cast<const char*>(data), length);
}

// libpng reports errors by a long jump to here; nothing with a destructor is made behind it.
bool write_rows(png_structp png, png_infop info, std::string& bytes, png_uint_32 width,
                png_uint_32 height, int colour_type, double pixels_per_metre, const char* title,
                BandPainter& painter) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_write_fn(png, &bytes, append, nullptr);
  png_set_compression_level(png, 6);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);  // rows repeat those above them
  png_set_IHDR(png, info, width, height, 8, colour_type, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  const auto resolution = static_cast<png_uint_32>(std::lround(pixels_per_metre));
  png_set_pHYs(png, info, resolution, resolution, PNG_RESOLUTION_METER);
  png_text text{};
  text.compression = PNG_ITXT_COMPRESSION_NONE;
  text.key = const_cast<char*>("Title");
  text.text = const_cast<char*>(title);
  png_set_text(png, info, &text, 1);
  png_write_info(png, info);
  for (png_uint_32 row = 0; row < height; ++row) {
    png_write_row(png, painter.row(static_cast<int>(row)));
  }
  png_write_end(png, info);
  return true;
}

}  // namespace

Result<std::string> render_png(const Sheet& sheet, double dots_per_inch, PngColours colours) {
  constexpr double kRounding = 1e-6;  // pixels: whole ones stay unchanged
  const double pixels_per_metre = dots_per_inch / kMetresPerInch;
  const double width = std::ceil(sheet.width * pixels_per_metre - kRounding);
  const double height = std::ceil(sheet.height * pixels_per_metre - kRounding);
  if (std::max(width, height) > kMostSide) {
    return fail(
        fmt::format("PNG: the page of {} would have {:.0f} x {:.0f} pixels at {} dpi, expected "
                    "at most {} a side: fewer dpi, or PDF",
                    sheet.title, width, height, dots_per_inch, kMostSide));
  }
  BandPainter painter(sheet, static_cast<int>(width), static_cast<int>(height), pixels_per_metre,
                      colours);
  std::string bytes;
  const std::string title = printable_text(sheet.title);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  const bool written = painter.ok() && write_rows(png, info, bytes, static_cast<png_uint_32>(width),
                                                  static_cast<png_uint_32>(height),
                                                  colours == PngColours::grey ? PNG_COLOR_TYPE_GRAY
                                                                              : PNG_COLOR_TYPE_RGB,
                                                  pixels_per_metre, title.c_str(), painter);
  png_destroy_write_struct(&png, &info);
  if (!written) return fail("PNG: no memory for the page of " + sheet.title);
  return bytes;
}

}  // namespace tagsmith::detail
