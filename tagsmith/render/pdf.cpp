// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/pdf.hpp"

#include <algorithm>
#include <cairo-pdf.h>
#include <cairo.h>
#include <memory>

#include <fmt/format.h>

#include "tagsmith/render/print_settings.hpp"
#include "tagsmith/render/text.hpp"

namespace tagsmith {
namespace {

constexpr double kPointsPerMetre = 72 / 0.0254;
constexpr double kMostPoints = 14400;

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

void add_rectangle(cairo_t* context, const Rectangle& rectangle) {
  cairo_rectangle(context, rectangle.x, rectangle.y, rectangle.width, rectangle.height);
}

// One path, filled by the even-odd rule: four rectangles would leave hairline seams on some
// printers.
void fill_feature_frame(cairo_t* context, const TagDrawing& tag) {
  add_rectangle(context, tag.frame_outer);
  add_rectangle(context, tag.frame_inner);
  cairo_set_fill_rule(context, CAIRO_FILL_RULE_EVEN_ODD);
  cairo_fill(context);
}

void fill_arrow(cairo_t* context, const UpArrow& arrow) {
  for (const PlatePoint& corner : outline_of(arrow)) cairo_line_to(context, corner.x, corner.y);
  cairo_close_path(context);
  cairo_fill(context);
}

void draw_tag_shapes(cairo_t* context, const TagDrawing& tag) {
  fill_feature_frame(context, tag);
  for (const Rectangle& bar : tag.bars) add_rectangle(context, bar);
  cairo_fill(context);
  for (const UpArrow& arrow : tag.arrows) fill_arrow(context, arrow);
  for (const TextItem& item : tag.label) show_text(context, item);
}

void draw_page(cairo_t* context, const Page& page) {
  cairo_save(context);
  cairo_scale(context, kPointsPerMetre, kPointsPerMetre);
  cairo_set_source_rgb(context, 0, 0, 0);
  draw_tag_shapes(context, page.tag);
  cairo_set_line_width(context, page.line_width);
  for (const PageLine& line : page.lines) {
    cairo_move_to(context, line.from.x, line.from.y);
    cairo_line_to(context, line.to.x, line.to.y);
  }
  cairo_stroke(context);
  for (const TextItem& item : page.texts) show_text(context, item);
  cairo_restore(context);
  cairo_show_page(context);
}

Result<void> check_pages(std::span<const Page> pages) {
  if (pages.empty()) return fail("PDF: no page to print, expected at least one");
  for (const Page& page : pages) {
    if (std::max(page.width, page.height) * kPointsPerMetre <= kMostPoints) continue;
    return fail(fmt::format("PDF: the page of {} is {:.2f} x {:.2f} m, expected at most 5.08 m",
                            page.notes.title, page.width, page.height));
  }
  return {};
}

void set_metadata(cairo_surface_t* surface, const PageNotes& notes) {
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_TITLE,
                                 printable_text(notes.title).c_str());
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_SUBJECT,
                                 printable_text(notes.subject).c_str());
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATOR, "tagsmith");
}

}  // namespace

Result<std::string> render_pdf(std::span<const Page> pages) {
  return render_pdf(pages, pages.empty() ? PageNotes{} : pages.front().notes);
}

Result<std::string> render_pdf(std::span<const Page> pages, const PageNotes& notes) {
  if (const Result<void> checked = check_pages(pages); !checked)
    return fail(checked.error().message);
  std::string bytes;
  cairo_surface_t* surface = cairo_pdf_surface_create_for_stream(append, &bytes, 0, 0);
  set_metadata(surface, notes);
  cairo_t* context = cairo_create(surface);
  for (const Page& page : pages) {
    cairo_pdf_surface_set_size(surface, page.width * kPointsPerMetre,
                               page.height * kPointsPerMetre);
    draw_page(context, page);
  }
  const cairo_status_t drawn = cairo_status(context);
  cairo_destroy(context);
  cairo_surface_finish(surface);
  const cairo_status_t finished = drawn ? drawn : cairo_surface_status(surface);
  cairo_surface_destroy(surface);
  if (finished) return fail(std::string("PDF: ") + cairo_status_to_string(finished));
  return with_print_settings(bytes);
}

}  // namespace tagsmith
