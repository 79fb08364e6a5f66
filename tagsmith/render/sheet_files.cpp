// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/sheet_files.hpp"

#include <utility>

#include "tagsmith/base/text.hpp"
#include "tagsmith/render/pdf.hpp"
#include "tagsmith/render/png.hpp"
#include "tagsmith/render/svg.hpp"

namespace tagsmith::detail {
namespace {

Result<std::string> render_sheet(const Sheet& sheet, SheetFormat format) {
  constexpr double kDotsPerInch = 150;
  if (format == SheetFormat::svg) return render_svg(sheet);
  return render_png(sheet, kDotsPerInch, PngColours::rgb);
}

std::filesystem::path numbered(const std::filesystem::path& path, std::size_t number) {
  return path.parent_path() /
         (path.stem().string() + "-" + std::to_string(number) + path.extension().string());
}

}  // namespace

std::optional<SheetFormat> sheet_format_of(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".pdf") return SheetFormat::pdf;
  if (extension == ".svg") return SheetFormat::svg;
  if (extension == ".png") return SheetFormat::png;
  return std::nullopt;
}

Result<std::vector<SheetFile>> render_sheets(std::span<const Sheet> sheets,
                                             const std::filesystem::path& path) {
  const std::optional<SheetFormat> format = sheet_format_of(path);
  if (!format) {
    return fail(path.string() + ": expected a file name that ends in .pdf, .svg or .png");
  }
  if (sheets.empty()) return fail(path.string() + ": no sheet to draw, expected at least one");
  if (*format == SheetFormat::pdf) {
    Result<std::string> bytes = render_pdf(sheets);
    if (!bytes) return fail(bytes);
    return std::vector{SheetFile{path, std::move(*bytes)}};
  }
  std::vector<SheetFile> files;
  for (const Sheet& sheet : sheets) {
    Result<std::string> bytes = render_sheet(sheet, *format);
    if (!bytes) return fail(bytes);
    files.push_back(
        {sheets.size() > 1 ? numbered(path, files.size() + 1) : path, std::move(*bytes)});
  }
  return files;
}

}  // namespace tagsmith::detail
