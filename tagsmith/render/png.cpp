// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/png.hpp"

#include <algorithm>
#include <cairo.h>
#include <cmath>
#include <cstdio>
#include <memory>
#include <png.h>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tagsmith/base/printable.hpp"
#include "tagsmith/render/page_on_cairo.hpp"
#include "tagsmith/render/text.hpp"
#include "tagsmith/tag/printer_dots.hpp"

namespace tagsmith {
namespace {

constexpr int kMostSide = 30'000;  // Cairo's limit is 32767
constexpr int kBandRows = 512;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

struct Destroy {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Surface = std::unique_ptr<cairo_surface_t, Destroy>;
using Context = std::unique_ptr<cairo_t, Destroy>;

struct PixelSize {
  int width = 0;
  int height = 0;
};

Result<PixelSize> pixel_size(const Page& page, double pixels_per_metre, int dots_per_inch) {
  constexpr double kRounding = 1e-6;  // pixels: whole ones stay what they are
  const double width = std::ceil(page.width * pixels_per_metre - kRounding);
  const double height = std::ceil(page.height * pixels_per_metre - kRounding);
  if (std::max(width, height) <= kMostSide) {
    return PixelSize{static_cast<int>(width), static_cast<int>(height)};
  }
  return fail(
      fmt::format("PNG: the page of {} would have {:.0f} x {:.0f} pixels at {} dpi, expected "
                  "at most {} a side: fewer dpi, or PDF",
                  page.notes.title, width, height, dots_per_inch, kMostSide));
}

// Rows of the page as coverage by ink, 0 to 255.
class BandPainter {
 public:
  BandPainter(const Page& page, const PixelSize& size, double pixels_per_metre)
      : page_(page),
        scale_(pixels_per_metre),
        surface_(cairo_image_surface_create(CAIRO_FORMAT_A8, size.width,
                                            std::min(kBandRows, size.height))) {}

  bool ok() const { return cairo_surface_status(surface_.get()) == CAIRO_STATUS_SUCCESS; }

  void paint(int first_row) {
    const Context context(cairo_create(surface_.get()));
    cairo_set_operator(context.get(), CAIRO_OPERATOR_CLEAR);
    cairo_paint(context.get());
    cairo_set_operator(context.get(), CAIRO_OPERATOR_OVER);
    cairo_translate(context.get(), 0, -first_row);
    cairo_scale(context.get(), scale_, scale_);
    draw_page(context.get(), page_, false);
    cairo_surface_flush(surface_.get());
  }

  const unsigned char* row(int row_of_band) const {
    return cairo_image_surface_get_data(surface_.get()) +
           static_cast<std::ptrdiff_t>(row_of_band) *
               cairo_image_surface_get_stride(surface_.get());
  }

 private:
  const Page& page_;
  double scale_;
  Surface surface_;
};

// libpng reports errors by a long jump to here; nothing with a destructor is made behind it.
bool write_rows(png_structp png, png_infop info, std::FILE* file, const PixelSize& size,
                double pixels_per_metre, const char* title, BandPainter& painter,
                std::vector<unsigned char>& grey) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_init_io(png, file);
  png_set_compression_level(png, 6);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);  // rows repeat those above them
  png_set_IHDR(png, info, static_cast<png_uint_32>(size.width),
               static_cast<png_uint_32>(size.height), 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  const auto resolution = static_cast<png_uint_32>(std::lround(pixels_per_metre));
  png_set_pHYs(png, info, resolution, resolution, PNG_RESOLUTION_METER);
  png_text text{};
  text.compression = PNG_ITXT_COMPRESSION_NONE;
  text.key = const_cast<char*>("Title");
  text.text = const_cast<char*>(title);
  png_set_text(png, info, &text, 1);
  png_write_info(png, info);
  for (int row = 0; row < size.height; ++row) {
    if (row % kBandRows == 0) painter.paint(row);
    const unsigned char* ink = painter.row(row % kBandRows);
    std::transform(ink, ink + size.width, grey.begin(),
                   [](unsigned char cover) { return static_cast<unsigned char>(255 - cover); });
    png_write_row(png, grey.data());
  }
  png_write_end(png, info);
  return true;
}

}  // namespace

Result<void> write_png(const std::filesystem::path& path, const Page& page, int dots_per_inch) {
  const double pixels_per_metre = dots_per_inch / kMetresPerInch;
  const Result<PixelSize> size = pixel_size(page, pixels_per_metre, dots_per_inch);
  if (!size) return fail(size.error().message);
  const auto cannot = [&] {
    return fail(path.string() + ": cannot be written, is the disk full?");
  };
  BandPainter painter(page, *size, pixels_per_metre);
  std::vector<unsigned char> grey(static_cast<std::size_t>(size->width));
  if (!painter.ok()) return fail("PNG: no memory for the page of " + page.notes.title);
  const File file(std::fopen(path.c_str(), "wb"));
  if (!file) return cannot();
  const std::string title = printable_text(page.notes.title);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  const bool written =
      write_rows(png, info, file.get(), *size, pixels_per_metre, title.c_str(), painter, grey) &&
      std::fflush(file.get()) == 0;
  png_destroy_write_struct(&png, &info);
  return written ? Result<void>{} : cannot();
}

}  // namespace tagsmith
