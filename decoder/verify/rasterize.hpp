// SPDX-License-Identifier: Apache-2.0
// PDF pages as grey images, by the programs pdfinfo and pdftoppm of poppler-utils, which run as
// processes of their own.
#pragma once

#include <filesystem>
#include <vector>

#include "decoder/image/gray.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith {

// A page's size in metres, as displayed (its rotation applied).
struct PageSize {
  double width = 0;
  double height = 0;
};

struct PageImage {
  GrayImage image;
  double metres_per_pixel = 0;
};

// True when the file begins as PDF files do.
bool is_pdf(const std::filesystem::path& path);

// The pages' sizes. Fails when poppler-utils is not installed, the file is no readable PDF, or has
// more than 1000 pages.
Result<std::vector<PageSize>> pdf_pages(const std::filesystem::path& path);

// Page `number` (from 1) at 150 dpi, or fewer when the page would have more than 40 million pixels.
// Fails when the page takes longer than a minute.
Result<PageImage> rasterize_page(const std::filesystem::path& path, int number,
                                 const PageSize& size);

}  // namespace tagsmith
