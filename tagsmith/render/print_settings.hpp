// SPDX-License-Identifier: Apache-2.0
// What Cairo leaves unsaid in a PDF that must be printed at true scale.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"

namespace tagsmith {

// A rectangle as PDF has it: points from the page's lower left corner.
struct PdfRectangle {
  double left = 0;
  double bottom = 0;
  double right = 0;
  double top = 0;
};

// What a page says to those who cut it.
struct PdfPageSettings {
  std::optional<PdfRectangle> trim{};   // /TrimBox (ISO 32000-2, 14.11.2)
  std::optional<PdfRectangle> bleed{};  // /BleedBox
  bool has_contour = false;             // pure magenta strokes are a cut contour
};

// The same PDF with
// - /ViewerPreferences that forbid scaling and pick the paper by the page's size (ISO
// 32000-2, 12.2),
// - black as DeviceGray 0, which a printer sets in black ink alone, not as a mixture,
// - the pages' settings, one a page in their order, none for the others; cut contours are strokes
// in
//   the spot colour CutContour, which cutting plotters look for,
// - no transparency groups and no creation date, and an ID that follows from the content, so that
//   equal input gives equal bytes.
Result<std::string> with_print_settings(const std::string& pdf,
                                        const std::vector<PdfPageSettings>& pages = {});

// As with_print_settings, from file to file.
Result<void> add_print_settings(const std::filesystem::path& from, const std::filesystem::path& to,
                                const std::vector<PdfPageSettings>& pages);

}  // namespace tagsmith
