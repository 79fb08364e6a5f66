// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/pdf.hpp"

#include <algorithm>
#include <cairo-pdf.h>
#include <cairo.h>
#include <fstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/printable.hpp"
#include "tagsmith/render/page_on_cairo.hpp"
#include "tagsmith/render/print_settings.hpp"
#include "tagsmith/render/text.hpp"

namespace tagsmith {
namespace {

constexpr double kPointsPerMetre = 72 / 0.0254;
constexpr double kMostPoints = 14400;

cairo_status_t take(void* filter, const unsigned char* data, unsigned int length) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), length);
  return static_cast<PrintSettingsFilter*>(filter)->take(bytes) ? CAIRO_STATUS_SUCCESS
                                                                : CAIRO_STATUS_WRITE_ERROR;
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

// A PDF that goes to the sink page by page.
class CairoPdf {
 public:
  CairoPdf(PrintSettingsFilter::Sink sink, const PageNotes& notes)
      : filter_(std::move(sink)),
        surface_(cairo_pdf_surface_create_for_stream(take, &filter_, 0, 0)),
        context_(cairo_create(surface_)) {
    cairo_pdf_surface_restrict_to_version(surface_, CAIRO_PDF_VERSION_1_4);
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
    filter_.add_page(settings_of(page));
    cairo_show_page(context_);
    has_page_ = true;
  }

  Result<void> finish() {
    const cairo_status_t drawn = cairo_status(context_);
    cairo_surface_finish(surface_);
    const cairo_status_t finished = drawn ? drawn : cairo_surface_status(surface_);
    if (!problem_.empty()) return fail(problem_);
    if (!has_page_) return fail("PDF: no page to print, expected at least one");
    if (finished) return fail(std::string("PDF: ") + cairo_status_to_string(finished));
    return filter_.finish();
  }

 private:
  static std::string too_large(const Page& page) {
    return fmt::format("PDF: the page of {} is {:.2f} x {:.2f} m, expected at most 5.08 m",
                       page.notes.title, page.width, page.height);
  }

  PrintSettingsFilter filter_;
  cairo_surface_t* surface_;
  cairo_t* context_;
  bool has_page_ = false;
  std::string problem_;
};

}  // namespace

Result<std::string> render_pdf(std::span<const Page> pages) {
  return render_pdf(pages, pages.empty() ? PageNotes{} : pages.front().notes);
}

Result<std::string> render_pdf(std::span<const Page> pages, const PageNotes& notes) {
  std::string bytes;
  CairoPdf pdf(
      [&](std::string_view part) {
        bytes += part;
        return true;
      },
      notes);
  for (const Page& page : pages) pdf.add(page);
  const Result<void> finished = pdf.finish();
  return finished ? Result<std::string>(std::move(bytes)) : fail(finished.error().message);
}

Result<void> write_pdf(const std::filesystem::path& path, const PageSource& pages,
                       const PageNotes& notes) {
  std::ofstream stream(path, std::ios::binary);
  CairoPdf pdf(
      [&](std::string_view part) {
        stream.write(part.data(), static_cast<std::streamsize>(part.size()));
        return stream.good();
      },
      notes);
  pages([&](const Page& page) { pdf.add(page); });
  if (auto finished = pdf.finish(); !finished) return finished;
  stream.close();
  return stream ? Result<void>{} : fail(path.string() + ": cannot be written, is the disk full?");
}

}  // namespace tagsmith
