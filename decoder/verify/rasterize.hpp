// SPDX-License-Identifier: Apache-2.0
// Print files as grey images: PDF by the programs pdfinfo and pdftoppm of poppler-utils, SVG by
// rsvg-convert of librsvg2-bin, which run as separate processes.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "decoder/image/gray.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {

// ---- Runs another program without a shell.

struct ProcessLimits {
  std::chrono::milliseconds time{60'000};  // wall time, then it is killed
  std::size_t output_bytes = 256U << 20U;  // of its standard output, then it is killed
};

struct ProcessOutput {
  int exit_code = 0;  // 128 + signal when one ended it
  std::string out;
  std::string err;  // its first 64 KiB
};

// Runs argv[0], looked for on the PATH, with standard input empty. Fails when it cannot be started
// ("NAME: not found" in the message) or exceeds a limit; its exit code is the caller's to judge.
Result<ProcessOutput> run_process(const std::vector<std::string>& argv,
                                  const ProcessLimits& limits = {});

// ---- Print files.

// A page's size in metres, as displayed (its rotation applied).
struct PageSize {
  double width = 0;
  double height = 0;
};

struct PageImage {  // upright, as displayed
  GrayImage image;
  double metres_per_pixel = 0;
  std::string error{};  // of a PDF that was drawn nevertheless: poppler's error; empty = none
};

// True when the file is called .pdf, in any case of letters.
bool is_called_pdf(const std::filesystem::path& path);

// True for the content of a PDF file.
bool is_pdf(std::string_view bytes);

// True when the file is called .svg, in any case of letters.
bool is_svg(const std::filesystem::path& path);

// What a print file of one tag states about itself, as `print` writes it into PDF and SVG.
struct StatedTag {
  std::string name;
  std::string digits;  // twelve
};

// From a PDF or SVG; nothing where it states nothing, or holds several tags.
std::optional<StatedTag> stated_tag(const std::filesystem::path& path, std::string_view bytes);

// The pages' sizes. Fails when poppler-utils is not installed, the file is no readable PDF, or has
// more than 1000 pages.
Result<std::vector<PageSize>> pdf_pages(const std::filesystem::path& path);

// Page `number` (from 1) at 150 dpi, or fewer when the page would have more than 40 million pixels,
// as a printer of this scale prints it.
// Fails when the page takes longer than a minute.
Result<PageImage> rasterize_page(const std::filesystem::path& path, int number,
                                 const PageSize& size, const PrinterScale& scale = {});

// A part of a page in whole pixels at some resolution, counted from the page's upper left corner.
struct PixelRegion {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

// That part of any print file: page `number` of a PDF, or an SVG or a picture (number 0), which is
// assumed to have so many dots per inch; the scale applies to PDFs only. Fails when the region is
// not wholly in it.
Result<GrayImage> rasterize_part(const std::filesystem::path& path, int number,
                                 double dots_per_inch, const PixelRegion& region,
                                 const PrinterScale& scale = {});

// Copies the piece over the image, its upper left corner at pixel (x, y); what lies outside is
// dropped.
void paste(const GrayImage& piece, GrayImage& image, int x, int y);

// A whole SVG; 150 dpi are enough for reading. Fails when rsvg-convert is not installed, the file
// is no SVG, or the picture would have more than 200 million pixels.
Result<PageImage> rasterize_svg(const std::filesystem::path& path, double dots_per_inch = 150);

}  // namespace tagsmith::detail
