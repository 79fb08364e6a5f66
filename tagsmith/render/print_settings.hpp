// SPDX-License-Identifier: Apache-2.0
// The settings that Cairo leaves out of a PDF that must be printed at true scale. Internal to
// tagsmith/render.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/pdf_x.hpp"

namespace tagsmith::detail {

// A page's settings for cutting.
struct PdfPageSettings {
  std::string boxes;  // entries of the page's dictionary (ISO 32000-2, 14.11.2); may be empty
  bool has_contour = false;  // pure magenta strokes are a cut contour
};

// Stands between Cairo, which writes a PDF of version 1.4 object by object, and the file; holds one
// object at a time. The result is the same PDF with
// - /ViewerPreferences that forbid scaling and pick the paper by the page's size (ISO 32000-2,
//   12.2),
// - black and white as DeviceGray, which a printer sets in black ink alone, not as a mixture,
// - the pages' settings; cut contours are strokes in the spot colour CutContour, which cutting
//   plotters look for,
// - no transparency groups, which mix colours as RGB, and an ID that follows from the content, so
//   that equal input gives equal bytes,
// - with an output intent what makes it PDF/X-4.
class PrintSettingsFilter {
 public:
  // Takes the next bytes of the file; false when they cannot be written.
  using Sink = std::function<bool(std::string_view)>;

  // Null: no PDF/X. The intent must outlive the filter.
  explicit PrintSettingsFilter(Sink sink, const OutputIntent* intent = nullptr)
      : sink_(std::move(sink)), intent_(intent) {}

  // The metadata for PDF/X, before the end.
  void describe(PdfDescription description) { description_ = std::move(description); }

  // The settings of the next page; to be called before Cairo shows it.
  void add_page(const PdfPageSettings& page);

  // Cairo's bytes, in pieces of any size; false when the sink takes no more.
  bool take(std::string_view bytes);

  // After Cairo's last byte. Fails when the sink did, and when the bytes were not what this version
  // of Cairo is known to write.
  Result<void> finish();

 private:
  void take_object(std::string_view object);
  void put_object(std::size_t number, const std::string& body);
  void put_pdf_x();
  void put(std::string_view bytes);

  Sink sink_;
  const OutputIntent* intent_;
  PdfDescription description_;
  bool written_ = true;
  std::string held_;          // not yet a whole object
  std::size_t searched_ = 0;  // so much of it holds no end of an object
  std::string id_;            // checksum of all objects so far
  std::uint64_t position_ = 0;
  std::vector<std::uint64_t> offsets_;    // by object number; 0 = there is none
  std::string new_length_;                // of the stream before the object that holds its length
  std::deque<PdfPageSettings> settings_;  // of the pages that Cairo has not yet written
  std::size_t contours_missing_ = 0;
  std::size_t catalog_number_ = 0;
  std::string catalog_;  // it is written last
};

// The content of a page (ISO 32000-2, 7.8.2) with `0 0 0 rg` as `0 g`, `1 1 1 RG` as `1 G` and so
// on, and with a contour `1 0 1 RG` as the colour space CutContour in full. Text in brackets stays.
std::string with_print_colours(std::string_view content, bool has_contour);

}  // namespace tagsmith::detail
