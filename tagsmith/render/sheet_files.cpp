// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/sheet_files.hpp"

#include <algorithm>
#include <cairo-pdf.h>
#include <cairo.h>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include "tagsmith/base/base64.hpp"
#include "tagsmith/base/printable.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/render/print_settings.hpp"
#include "tagsmith/render/svg_elements.hpp"
#include "tagsmith/render/text.hpp"

namespace tagsmith {
namespace {

constexpr double kInch = 0.0254;
constexpr double kPointsPerMetre = 72 / kInch;

struct Destroy {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Surface = std::unique_ptr<cairo_surface_t, Destroy>;
using Context = std::unique_ptr<cairo_t, Destroy>;

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

TextItem at_origin(const SheetText& text) {
  return {.text = text.text, .height = text.height, .max_width = text.max_width};
}

// Draws items on a context whose user space is the sheet's frame.
class Painter {
 public:
  explicit Painter(cairo_t* context) : context_(context) {
    cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(context, CAIRO_LINE_CAP_BUTT);
  }

  void operator()(const SheetLine& line) {
    set_colour(line.line.colour);
    trace(line.points);
    if (line.closed) cairo_close_path(context_);
    stroke(line.line);
  }

  void operator()(const SheetArea& area) {
    set_colour(area.fill);
    trace(area.points);
    cairo_close_path(context_);
    cairo_fill(context_);
  }

  void operator()(const SheetText& text) {
    cairo_save(context_);
    set_colour(text.colour);
    cairo_translate(context_, text.at.x(), text.at.y());
    cairo_rotate(context_, -text.angle);
    show_text(context_, at_origin(text));
    cairo_restore(context_);
  }

  void operator()(const SheetPicture& picture) {
    const auto needed =
        static_cast<std::size_t>(picture.columns) * static_cast<std::size_t>(picture.rows);
    if (needed == 0 || picture.samples.size() != needed) return;
    const Surface pixels(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, picture.columns, picture.rows));
    if (cairo_surface_status(pixels.get()) != CAIRO_STATUS_SUCCESS) return;
    fill(pixels.get(), picture);
    if (!picture.jpeg.empty()) attach_jpeg(pixels.get(), picture.jpeg);
    cairo_save(context_);
    cairo_translate(context_, picture.at.x(), picture.at.y());
    cairo_scale(context_, picture.width / picture.columns, picture.height / picture.rows);
    cairo_set_source_surface(context_, pixels.get(), 0, 0);
    cairo_paint(context_);
    cairo_restore(context_);
  }

 private:
  // In millimetres, because Cairo's PDF leaves out gaps that are short in metres.
  void stroke(const LineStyle& style) {
    constexpr double kMillimetre = 0.001;
    std::vector<double> dashes_mm = style.dashes;
    for (double& dash : dashes_mm) dash /= kMillimetre;
    cairo_save(context_);
    cairo_scale(context_, kMillimetre, kMillimetre);
    cairo_set_line_width(context_, style.width / kMillimetre);
    cairo_set_dash(context_, dashes_mm.data(), static_cast<int>(dashes_mm.size()), 0);
    cairo_stroke(context_);
    cairo_restore(context_);
  }

  static void fill(cairo_surface_t* pixels, const SheetPicture& picture) {
    unsigned char* data = cairo_image_surface_get_data(pixels);
    const int stride = cairo_image_surface_get_stride(pixels);
    std::size_t at = 0;
    for (int y = 0; y < picture.rows; ++y) {
      auto* row = reinterpret_cast<std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * stride);
      for (int x = 0; x < picture.columns; ++x) row[x] = 0x010101U * picture.samples[at++];
    }
    cairo_surface_mark_dirty(pixels);
  }

  // PDF carries these bytes instead of the pixels; Cairo frees the copy.
  static void attach_jpeg(cairo_surface_t* pixels, const std::string& jpeg) {
    auto copy = std::make_unique<std::string>(jpeg);
    const auto destroy = [](void* bytes) { delete static_cast<std::string*>(bytes); };
    const cairo_status_t attached = cairo_surface_set_mime_data(
        pixels, CAIRO_MIME_TYPE_JPEG, reinterpret_cast<const unsigned char*>(copy->data()),
        copy->size(), destroy, copy.get());
    if (attached == CAIRO_STATUS_SUCCESS) copy.release();
  }

  void set_colour(const Colour& colour) {
    cairo_set_source_rgb(context_, colour.red, colour.green, colour.blue);
  }
  void trace(const std::vector<Eigen::Vector2d>& points) {
    cairo_new_path(context_);
    for (const Eigen::Vector2d& point : points) cairo_line_to(context_, point.x(), point.y());
  }

  cairo_t* context_;
};

void paint(cairo_t* context, const Sheet& sheet, double units_per_metre) {
  cairo_save(context);
  cairo_scale(context, units_per_metre, units_per_metre);
  Painter painter(context);
  for (const SheetLayer& layer : sheet.layers) {
    for (const SheetItem& item : layer.items) std::visit(painter, item);
  }
  cairo_restore(context);
}

std::string hex(const Colour& colour) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string text = "#";
  for (const double share : {colour.red, colour.green, colour.blue}) {
    const auto level = static_cast<std::size_t>(std::lround(std::clamp(share, 0.0, 1.0) * 255));
    text += {kHex[level / 16], kHex[level % 16]};
  }
  return text;
}

// Ten nanometres are finer than any plotter, and keep files small.
std::string coarse_mm(double metres) { return format_number(metres * 1000, 5); }

std::string svg_points(const std::vector<Eigen::Vector2d>& points, bool closed) {
  std::string path;
  for (const Eigen::Vector2d& point : points) {
    path += (path.empty() ? "M" : "L") + coarse_mm(point.x()) + " " + coarse_mm(point.y());
  }
  return path + (closed ? "Z" : "");
}

std::string svg_item(const SheetLine& line) {
  std::string dashes;
  for (const double dash : line.line.dashes) dashes += (dashes.empty() ? "" : " ") + svg_mm(dash);
  return "<path fill=\"none\" stroke=\"" + hex(line.line.colour) + "\" stroke-width=\"" +
         svg_mm(line.line.width) + "\" stroke-linejoin=\"round\"" +
         (dashes.empty() ? "" : " stroke-dasharray=\"" + dashes + "\"") + " d=\"" +
         svg_points(line.points, line.closed) + "\"/>\n";
}

std::string svg_item(const SheetArea& area) {
  return "<path fill=\"" + hex(area.fill) + "\" d=\"" + svg_points(area.points, true) + "\"/>\n";
}

std::string svg_item(const SheetText& text) {
  const std::string turn =
      text.angle == 0 ? "" : " rotate(" + format_number(-degrees(text.angle), 6) + ")";
  return "<path fill=\"" + hex(text.colour) + "\" transform=\"translate(" + coarse_mm(text.at.x()) +
         " " + coarse_mm(text.at.y()) + ")" + turn + "\" d=\"" + svg_outline(at_origin(text)) +
         "\"><title>" + markup_text(text.text) + "</title></path>\n";
}

std::string svg_item(const SheetPicture& picture) {
  if (picture.jpeg.empty()) return "";
  return "<image x=\"" + coarse_mm(picture.at.x()) + "\" y=\"" + coarse_mm(picture.at.y()) +
         "\" width=\"" + coarse_mm(picture.width) + "\" height=\"" + coarse_mm(picture.height) +
         "\" preserveAspectRatio=\"none\" href=\"data:image/jpeg;base64," + base64(picture.jpeg) +
         "\"/>\n";
}

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

Error cairo_error(const std::string& format, cairo_status_t status) {
  return {format + ": " + cairo_status_to_string(status)};
}

Result<std::string> render_sheet(const Sheet& sheet, SheetFormat format) {
  return format == SheetFormat::svg ? render_sheet_svg(sheet) : render_sheet_png(sheet);
}

std::filesystem::path numbered(const std::filesystem::path& path, std::size_t number) {
  return path.parent_path() /
         (path.stem().string() + "-" + std::to_string(number) + path.extension().string());
}

}  // namespace

std::optional<SheetFormat> sheet_format_of(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".pdf") return SheetFormat::pdf;
  if (extension == ".svg") return SheetFormat::svg;
  if (extension == ".png") return SheetFormat::png;
  return std::nullopt;
}

Result<std::string> render_sheets_pdf(std::span<const Sheet> sheets) {
  if (sheets.empty()) return fail("PDF: no sheet to draw, expected at least one");
  std::string bytes;
  const Surface surface(cairo_pdf_surface_create_for_stream(append, &bytes, 0, 0));
  cairo_pdf_surface_restrict_to_version(surface.get(), CAIRO_PDF_VERSION_1_4);
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE,
                                 printable_text(sheets.front().title).c_str());
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_SUBJECT,
                                 printable_text(sheets.front().subject).c_str());
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATOR, "tagsmith");
  Context context(cairo_create(surface.get()));
  for (const Sheet& sheet : sheets) {
    cairo_pdf_surface_set_size(surface.get(), sheet.width * kPointsPerMetre,
                               sheet.height * kPointsPerMetre);
    paint(context.get(), sheet, kPointsPerMetre);
    cairo_show_page(context.get());
  }
  const cairo_status_t drawn = cairo_status(context.get());
  context.reset();
  cairo_surface_finish(surface.get());
  const cairo_status_t finished = drawn ? drawn : cairo_surface_status(surface.get());
  if (finished) return tl::unexpected(cairo_error("PDF", finished));
  return with_print_settings(bytes);
}

std::string render_sheet_svg(const Sheet& sheet) {
  const std::string width = svg_mm(sheet.width);
  const std::string height = svg_mm(sheet.height);
  std::string svg =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"" +
      width + "mm\" height=\"" + height + "mm\" viewBox=\"0 0 " + width + " " + height +
      "\">\n<title>" + markup_text(sheet.title) + "</title>\n<desc>" + markup_text(sheet.subject) +
      "</desc>\n<rect width=\"" + width + "\" height=\"" + height + "\" fill=\"#ffffff\"/>\n";
  for (const SheetLayer& layer : sheet.layers) {
    svg += "<g id=\"" + markup_text(layer.name) + "\">\n";
    for (const SheetItem& item : layer.items) {
      svg += std::visit([](const auto& value) { return svg_item(value); }, item);
    }
    svg += "</g>\n";
  }
  return svg + "</svg>\n";
}

Result<std::string> render_sheet_png(const Sheet& sheet, double dots_per_inch) {
  const double dots_per_metre = dots_per_inch / kInch;
  const auto dots = [&](double metres) {
    return static_cast<int>(std::lround(metres * dots_per_metre));
  };
  const Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, dots(sheet.width), dots(sheet.height)));
  const Context context(cairo_create(surface.get()));
  cairo_set_source_rgb(context.get(), 1, 1, 1);
  cairo_paint(context.get());
  paint(context.get(), sheet, dots_per_metre);
  std::string bytes;
  cairo_status_t status = cairo_status(context.get());
  if (!status) status = cairo_surface_write_to_png_stream(surface.get(), append, &bytes);
  if (status) return tl::unexpected(cairo_error("PNG", status));
  return bytes;
}

Result<std::vector<SheetFile>> render_sheets(std::span<const Sheet> sheets,
                                             const std::filesystem::path& path) {
  const std::optional<SheetFormat> format = sheet_format_of(path);
  if (!format) {
    return fail(path.string() + ": expected a file name that ends in .pdf, .svg or .png");
  }
  std::vector<SheetFile> files;
  if (*format == SheetFormat::pdf) {
    Result<std::string> bytes = render_sheets_pdf(sheets);
    if (!bytes) return tl::unexpected(bytes.error());
    files.push_back({path, std::move(*bytes)});
    return files;
  }
  if (sheets.empty()) return fail(path.string() + ": no sheet to draw, expected at least one");
  for (const Sheet& sheet : sheets) {
    Result<std::string> bytes = render_sheet(sheet, *format);
    if (!bytes) return tl::unexpected(bytes.error());
    files.push_back(
        {sheets.size() > 1 ? numbered(path, files.size() + 1) : path, std::move(*bytes)});
  }
  return files;
}

}  // namespace tagsmith
