// SPDX-License-Identifier: Apache-2.0
// What Cairo leaves unsaid in a PDF that must be printed at true scale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
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

// Stands between Cairo, which writes a PDF of version 1.4 object by object, and the file; holds one
// object at a time. What comes out is the same PDF with
// - /ViewerPreferences that forbid scaling and pick the paper by the page's size (ISO 32000-2,
//   12.2),
// - black as DeviceGray 0, which a printer sets in black ink alone, not as a mixture,
// - the pages' settings; cut contours are strokes in the spot colour CutContour, which cutting
//   plotters look for,
// - no transparency groups and no creation date, and an ID that follows from the content, so that
//   equal input gives equal bytes.
class PrintSettingsFilter {
 public:
  // Takes the next bytes of the file; false when they cannot be written.
  using Sink = std::function<bool(std::string_view)>;

  explicit PrintSettingsFilter(Sink sink) : sink_(std::move(sink)) {}

  // The settings of the next page; said before Cairo shows it.
  void add_page(const PdfPageSettings& page);

  // Cairo's bytes, in pieces of any size; false when the sink takes no more.
  bool take(std::string_view bytes);

  // After Cairo's last byte. Fails when the sink did, and when the bytes were not what this version
  // of Cairo is known to write.
  Result<void> finish();

 private:
  void take_object(std::string_view object);
  void put_object(std::size_t number, std::string_view body);
  void put_stream(std::size_t number, std::string_view dictionary, std::string_view data);
  void put(std::string_view bytes);
  std::string with_page_settings(std::string page);

  Sink sink_;
  bool written_ = true;
  std::string held_;          // not yet a whole object
  std::size_t searched_ = 0;  // so much of it holds no end of an object
  std::string id_;            // checksum of all objects so far
  std::uint64_t position_ = 0;
  std::vector<std::uint64_t> offsets_;    // by object number; 0 = there is none
  std::set<std::size_t> lengths_;         // numbers of objects that held the length of a stream
  std::deque<PdfPageSettings> settings_;  // of the pages that Cairo has not yet written
  std::size_t contours_asked_ = 0;
  std::size_t contours_made_ = 0;
  bool has_catalog_ = false;
};

// A whole PDF of Cairo's through the filter, without settings of pages.
Result<std::string> with_print_settings(std::string_view cairo_pdf);

}  // namespace tagsmith
