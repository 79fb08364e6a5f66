// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/sheet_on_cairo.hpp"

#include <cairo.h>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>

#include "tagsmith/render/text.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {
namespace {

using Points = std::vector<Eigen::Vector2d>;

CairoSurface pixels_of(const SheetPicture& picture) {
  CairoSurface pixels(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, picture.columns, picture.rows));
  if (cairo_surface_status(pixels.get()) != CAIRO_STATUS_SUCCESS) return nullptr;
  unsigned char* data = cairo_image_surface_get_data(pixels.get());
  const int stride = cairo_image_surface_get_stride(pixels.get());
  std::size_t at = 0;
  for (int y = 0; y < picture.rows; ++y) {
    auto* row = reinterpret_cast<std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * stride);
    for (int x = 0; x < picture.columns; ++x) row[x] = 0x010101U * picture.samples[at++];
  }
  cairo_surface_mark_dirty(pixels.get());
  return pixels;
}

// PDF carries these bytes instead of the pixels; Cairo frees the copy.
void attach_jpeg(cairo_surface_t* pixels, const std::string& jpeg) {
  auto copy = std::make_unique<std::string>(jpeg);
  const auto destroy = [](void* bytes) { delete static_cast<std::string*>(bytes); };
  const cairo_status_t attached = cairo_surface_set_mime_data(
      pixels, CAIRO_MIME_TYPE_JPEG, reinterpret_cast<const unsigned char*>(copy->data()),
      copy->size(), destroy, copy.get());
  // NOLINTNEXTLINE(bugprone-unused-return-value): the surface owns the copy from here on.
  if (attached == CAIRO_STATUS_SUCCESS) copy.release();
}

bool alike(const LineStyle& a, const LineStyle& b) {
  const auto all = [](const LineStyle& line) {
    return std::tie(line.width, line.dashes, line.colour.red, line.colour.green, line.colour.blue);
  };
  return all(a) == all(b);
}

// Draws items on a context whose user space is the sheet's frame.
class Painter {
 public:
  Painter(cairo_t* context, bool text_as_outlines)
      : context_(context), text_as_outlines_(text_as_outlines) {}

  // Lines of one style that follow each other are one stroke.
  void operator()(const SheetLine& line) {
    if (!alike(style_, line.line)) stroke();
    style_ = line.line;
    trace(line.points, line.closed);
  }

  // Draws the lines that were traced.
  void stroke() {
    if (!cairo_has_current_point(context_)) return;
    set_colour(style_.colour);
    // Cairo's PDF leaves out dashes and gaps that are short in metres.
    std::vector<double> dashes_mm = style_.dashes;
    for (double& dash : dashes_mm) dash /= kMillimetre;
    cairo_save(context_);
    cairo_scale(context_, kMillimetre, kMillimetre);
    cairo_set_line_width(context_, style_.width / kMillimetre);
    cairo_set_dash(context_, dashes_mm.data(), static_cast<int>(dashes_mm.size()), 0);
    cairo_stroke(context_);
    cairo_restore(context_);
  }

  void operator()(const SheetArea& area) {
    stroke();
    set_colour(area.fill);
    for (const Points& outline : area.outlines) trace(outline, true);
    cairo_fill(context_);
  }

  void operator()(const SheetText& text) {
    stroke();
    set_colour(text.colour);
    show_text(context_, text, text_as_outlines_);
  }

  void operator()(const SheetPicture& picture) {
    stroke();
    const auto needed =
        static_cast<std::size_t>(picture.columns) * static_cast<std::size_t>(picture.rows);
    if (needed == 0 || picture.samples.size() != needed) return;
    const CairoSurface pixels = pixels_of(picture);
    if (pixels == nullptr) return;
    if (!picture.jpeg.empty()) attach_jpeg(pixels.get(), picture.jpeg);
    cairo_save(context_);
    cairo_translate(context_, picture.at.x(), picture.at.y());
    cairo_scale(context_, picture.width / picture.columns, picture.height / picture.rows);
    cairo_set_source_surface(context_, pixels.get(), 0, 0);
    cairo_paint(context_);
    cairo_restore(context_);
  }

 private:
  void set_colour(const Colour& colour) {
    cairo_set_source_rgb(context_, colour.red, colour.green, colour.blue);
  }

  // Cairo rounds places to 1/256 point. Rectangles are drawn by their sides, so that bars of equal
  // width stay equal.
  void trace(const Points& points, bool closed) {
    const bool by_sides = closed && points.size() == 4;
    cairo_new_sub_path(context_);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (by_sides && i > 0) {
        const Eigen::Vector2d side = points[i] - points[i - 1];
        cairo_rel_line_to(context_, side.x(), side.y());
      } else {
        cairo_line_to(context_, points[i].x(), points[i].y());
      }
    }
    if (closed) cairo_close_path(context_);
  }

  cairo_t* context_;
  bool text_as_outlines_;
  LineStyle style_{};  // of the lines that are traced and not yet drawn
};

}  // namespace

void CairoDestroy::operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
void CairoDestroy::operator()(cairo_t* context) const { cairo_destroy(context); }

void draw_sheet(cairo_t* context, const Sheet& sheet, double units_per_metre) {
  cairo_save(context);
  cairo_scale(context, units_per_metre, units_per_metre);
  cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
  cairo_set_fill_rule(context, CAIRO_FILL_RULE_EVEN_ODD);
  Painter painter(context, sheet.text_as_outlines);
  for (const SheetLayer& layer : sheet.layers) {
    cairo_save(context);
    if (layer.window) {
      const Eigen::Vector2d size = layer.window->sizes();
      cairo_rectangle(context, layer.window->min().x(), layer.window->min().y(), size.x(),
                      size.y());
      cairo_clip(context);
    }
    for (const SheetItem& item : layer.items) std::visit(painter, item);
    painter.stroke();
    cairo_restore(context);
  }
  cairo_restore(context);
}

}  // namespace tagsmith::detail
