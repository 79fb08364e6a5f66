// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/pdf.hpp"

#include <algorithm>
#include <cairo-pdf.h>
#include <cairo.h>
#include <fstream>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tagsmith/render/page_on_cairo.hpp"
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

cairo_status_t write(void* stream, const unsigned char* data, unsigned int length) {
  auto& out = *static_cast<std::ofstream*>(stream);
  out.write(reinterpret_cast<const char*>(data), length);
  return out ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

void set_metadata(cairo_surface_t* surface, const PageNotes& notes) {
  const auto set = [&](cairo_pdf_metadata_t key, const std::string& text) {
    if (!text.empty()) cairo_pdf_surface_set_metadata(surface, key, printable_text(text).c_str());
  };
  set(CAIRO_PDF_METADATA_TITLE, notes.title);
  set(CAIRO_PDF_METADATA_SUBJECT, notes.subject);
  set(CAIRO_PDF_METADATA_KEYWORDS, notes.keywords);
  set(CAIRO_PDF_METADATA_CREATOR, "tagsmith");
}

// In points from the page's lower left corner, as PDF has it.
PdfRectangle in_points(const Rectangle& box, const Page& page) {
  return {box.x * kPointsPerMetre, (page.height - box.y - box.height) * kPointsPerMetre,
          (box.x + box.width) * kPointsPerMetre, (page.height - box.y) * kPointsPerMetre};
}

PdfPageSettings settings_of(const Page& page) {
  PdfPageSettings settings;
  if (page.trim) settings.trim = in_points(*page.trim, page);
  if (page.bleed) settings.bleed = in_points(*page.bleed, page);
  settings.has_contour =
      std::ranges::any_of(page.tags, [](const PageTag& tag) { return tag.drawing.cut_contour; });
  return settings;
}

// Cairo's half of the work: a PDF that says nothing yet about how to print it.
class CairoPdf {
 public:
  CairoPdf(cairo_write_func_t sink, void* target, const PageNotes& notes)
      : surface_(cairo_pdf_surface_create_for_stream(sink, target, 0, 0)),
        context_(cairo_create(surface_)) {
    set_metadata(surface_, notes);
  }
  ~CairoPdf() {
    cairo_destroy(context_);
    cairo_surface_destroy(surface_);
  }
  CairoPdf(const CairoPdf&) = delete;
  CairoPdf& operator=(const CairoPdf&) = delete;

  void add(const Page& page) {
    if (std::max(page.width, page.height) * kPointsPerMetre > kMostPoints) {
      if (problem_.empty()) problem_ = too_large(page);
      return;
    }
    cairo_pdf_surface_set_size(surface_, page.width * kPointsPerMetre,
                               page.height * kPointsPerMetre);
    cairo_save(context_);
    cairo_scale(context_, kPointsPerMetre, kPointsPerMetre);
    draw_page(context_, page, true);
    cairo_restore(context_);
    cairo_show_page(context_);
    settings_.push_back(settings_of(page));
  }

  // The settings of each page for with_print_settings.
  Result<std::vector<PdfPageSettings>> finish() {
    const cairo_status_t drawn = cairo_status(context_);
    cairo_surface_finish(surface_);
    const cairo_status_t finished = drawn ? drawn : cairo_surface_status(surface_);
    if (!problem_.empty()) return fail(problem_);
    if (settings_.empty()) return fail("PDF: no page to print, expected at least one");
    if (finished) return fail(std::string("PDF: ") + cairo_status_to_string(finished));
    return std::move(settings_);
  }

 private:
  static std::string too_large(const Page& page) {
    return fmt::format("PDF: the page of {} is {:.2f} x {:.2f} m, expected at most 5.08 m",
                       page.notes.title, page.width, page.height);
  }

  cairo_surface_t* surface_;
  cairo_t* context_;
  std::vector<PdfPageSettings> settings_;
  std::string problem_;
};

}  // namespace

Result<std::string> render_pdf(std::span<const Page> pages) {
  return render_pdf(pages, pages.empty() ? PageNotes{} : pages.front().notes);
}

Result<std::string> render_pdf(std::span<const Page> pages, const PageNotes& notes) {
  std::string bytes;
  CairoPdf pdf(append, &bytes, notes);
  for (const Page& page : pages) pdf.add(page);
  const Result<std::vector<PdfPageSettings>> settings = pdf.finish();
  if (!settings) return fail(settings.error().message);
  return with_print_settings(bytes, *settings);
}

Result<void> write_pdf(const std::filesystem::path& path, const PageSource& pages,
                       const PageNotes& notes) {
  std::filesystem::path part = path;
  part += ".part";
  std::ofstream stream(part, std::ios::binary);
  CairoPdf pdf(write, &stream, notes);
  pages([&](const Page& page) { pdf.add(page); });
  const Result<std::vector<PdfPageSettings>> settings = pdf.finish();
  stream.close();
  Result<void> written = settings ? add_print_settings(part, path, *settings)
                                  : Result<void>(fail(settings.error().message));
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  return written;
}

}  // namespace tagsmith
