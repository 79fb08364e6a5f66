// SPDX-License-Identifier: Apache-2.0
// The JSON lines of `read` (docs/formats.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "decoder/reader/reading.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// The result of `read` for one picture.
struct ImageReadings {
  std::filesystem::path image;
  int width = 0;
  int height = 0;
  ReadResult result;
  double time_ms = 0;     // of reading alone, without decoding the file
  std::string warning{};  // the damage that the file's decoder repaired; empty = none
};

// The position that the digits code: by the code of the survey that has such a tag, else by the
// paper's (4, 4, 3 digits, centimetres, origin 0). Metres, rounded to a micrometre.
GridPoint coded_position(const Digits& digits, const std::vector<Survey>& surveys);

// Which check digits hold: "sum10", "gs1", "both", or "none".
template <class AnyReading>
std::string check_digit_name(const AnyReading& reading) {
  if (reading.sum10_holds && reading.gs1_holds) return "both";
  if (reading.sum10_holds) return "sum10";
  return reading.gs1_holds ? "gs1" : "none";
}

// Without its line end. Bytes of file names that are no UTF-8 become U+FFFD.
std::string to_json_line(const ImageReadings& readings, const std::vector<Survey>& surveys);

}  // namespace tagsmith::detail
