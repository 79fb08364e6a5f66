// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/pdf.hpp"

#include <algorithm>
#include <cairo-pdf.h>
#include <fstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/render/print_settings.hpp"
#include "tagsmith/render/sheet_on_cairo.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kPointsPerMetre = 72 / 0.0254;
constexpr double kLongestSidePoints = 14400;

cairo_status_t take(void* filter, const unsigned char* data, unsigned int length) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), length);
  return static_cast<PrintSettingsFilter*>(filter)->take(bytes) ? CAIRO_STATUS_SUCCESS
                                                                : CAIRO_STATUS_WRITE_ERROR;
}

void set_metadata(cairo_surface_t* surface, const Sheet& sheet) {
  const auto set = [&](cairo_pdf_metadata_t key, const std::string& text) {
    if (!text.empty()) cairo_pdf_surface_set_metadata(surface, key, printable_text(text).c_str());
  };
  set(CAIRO_PDF_METADATA_TITLE, sheet.title);
  set(CAIRO_PDF_METADATA_SUBJECT, sheet.subject);
  set(CAIRO_PDF_METADATA_KEYWORDS, sheet.keywords);
  set(CAIRO_PDF_METADATA_CREATOR, "tagsmith");
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, "");  // none
}

PdfPageSettings settings_of(const Sheet& sheet, bool pdf_x) {
  PdfPageSettings settings;
  // In points from the page's lower left corner.
  const auto add = [&](const char* name, const std::optional<Eigen::AlignedBox2d>& box) {
    if (!box) return;
    const auto points = [](double metres) { return format_number(metres * kPointsPerMetre, 5); };
    settings.boxes += fmt::format("\n   /{} [ {} {} {} {} ]", name, points(box->min().x()),
                                  points(sheet.height - box->max().y()), points(box->max().x()),
                                  points(sheet.height - box->min().y()));
  };
  const Eigen::AlignedBox2d page(Eigen::Vector2d(0, 0), Eigen::Vector2d(sheet.width, sheet.height));
  const bool needs_trim = pdf_x && !sheet.trim;  // PDF/X-4 asks for it
  add("TrimBox", needs_trim ? page : sheet.trim);
  add("BleedBox", sheet.bleed);
  settings.has_contour = std::ranges::count(sheet.layers, kCutContour, &SheetLayer::name) > 0;
  return settings;
}

// Draws all sheets and hands the bytes to the sink.
Result<void> draw_pdf(const SheetSource& sheets, const OutputIntent* intent,
                      PrintSettingsFilter::Sink sink) {
  PrintSettingsFilter filter(std::move(sink), intent);
  const CairoSurface surface(cairo_pdf_surface_create_for_stream(take, &filter, 0, 0));
  cairo_pdf_surface_restrict_to_version(surface.get(), CAIRO_PDF_VERSION_1_4);
  CairoContext context(cairo_create(surface.get()));
  bool has_page = false;
  std::string problem;
  sheets([&](const Sheet& sheet) {
    if (!has_page) {
      set_metadata(surface.get(), sheet);
      filter.describe({sheet.title, sheet.subject, sheet.keywords});
    }
    has_page = true;
    if (std::max(sheet.width, sheet.height) * kPointsPerMetre > kLongestSidePoints &&
        problem.empty()) {
      problem = fmt::format("PDF: the page of {} is {:.2f} x {:.2f} m, expected at most 5.08 m",
                            sheet.title, sheet.width, sheet.height);
    }
    const PdfPageSettings settings = settings_of(sheet, intent != nullptr);
    if (intent != nullptr && settings.has_contour && !intent->has_process && problem.empty()) {
      problem =
          "PDF/X-4: the cut contour is a spot colour, which a press of black ink alone "
          "cannot have: the profile of a press with four inks, or cut: { contour: false }";
    }
    if (!problem.empty()) return;
    cairo_pdf_surface_set_size(surface.get(), sheet.width * kPointsPerMetre,
                               sheet.height * kPointsPerMetre);
    draw_sheet(context.get(), sheet, kPointsPerMetre);
    filter.add_page(settings);
    cairo_show_page(context.get());
  });
  const cairo_status_t drawn = cairo_status(context.get());
  context.reset();
  cairo_surface_finish(surface.get());
  const cairo_status_t finished = drawn ? drawn : cairo_surface_status(surface.get());
  if (!problem.empty()) return fail(problem);
  if (!has_page) return fail("PDF: no page to print, expected at least one");
  if (finished) return fail(std::string("PDF: ") + cairo_status_to_string(finished));
  return filter.finish();
}

}  // namespace

Result<std::string> render_pdf(std::span<const Sheet> sheets, const OutputIntent* intent) {
  std::string bytes;
  const auto keep = [&](std::string_view part) {
    bytes += part;
    return true;
  };
  const Result<void> drawn =
      draw_pdf([&](const auto& add) { std::ranges::for_each(sheets, add); }, intent, keep);
  return drawn ? Result<std::string>(std::move(bytes)) : fail(drawn);
}

Result<void> write_pdf(const std::filesystem::path& path, const SheetSource& sheets,
                       const OutputIntent* intent) {
  std::ofstream stream(path, std::ios::binary);
  auto drawn = draw_pdf(sheets, intent, [&](std::string_view part) {
    stream.write(part.data(), static_cast<std::streamsize>(part.size()));
    return stream.good();
  });
  if (!drawn) return drawn;
  stream.close();
  return stream ? Result<void>{} : fail(path.string() + ": cannot be written, is the disk full?");
}

}  // namespace tagsmith::detail
