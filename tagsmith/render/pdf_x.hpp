// SPDX-License-Identifier: Apache-2.0
// PDF/X-4 (ISO 15930-7): PDF files that state for which press they are made.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// The press, as the shop's ICC profile describes it.
struct OutputIntent {
  std::string profile;       // the file's bytes
  std::string condition;     // the profile's own description of the press and its paper
  bool has_process = false;  // four inks; else black alone, which cannot preview a spot colour
  std::string date;          // of the PDF files: 2026-03-31T12:00:00Z
};

// Fails on a file of more than 10 MB, on one that is no ICC profile and on the profile of a screen,
// a camera or a press of other inks than black or cyan, magenta, yellow and black. The date is now;
// or $SOURCE_DATE_EPOCH, so that builds can be repeated byte by byte.
Result<OutputIntent> load_output_intent(const std::filesystem::path& file);

// What the document states about itself; empty texts are left out.
struct PdfDescription {
  std::string title;
  std::string subject;
  std::string keywords;
};

// The document's metadata (XMP) with an identifier of 32 hexadecimal digits.
std::string pdf_x_metadata(const OutputIntent& intent, const PdfDescription& description,
                           const std::string& id);

// Entries of the document's information dictionary and of its catalog; objects by their numbers.
std::string pdf_x_information(const OutputIntent& intent);
std::string pdf_x_catalog(const OutputIntent& intent, std::size_t profile, std::size_t metadata);

// The profile as a stream's object body.
std::string pdf_x_profile(const OutputIntent& intent);

}  // namespace tagsmith::detail
