// SPDX-License-Identifier: Apache-2.0
// The JSON lines of `read` and `verify` (docs/formats.md). Each function returns one line without
// its line end. Bytes of file names that are no UTF-8 become U+FFFD.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "decoder/cli/file_list.hpp"
#include "decoder/cli/verify_merge.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/verify/finding.hpp"
#include "decoder/verify/hung_tags.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith {

// What `read` has to say about one picture.
struct ImageReadings {
  std::filesystem::path image;
  int width = 0;
  int height = 0;
  ReadResult result;
  double time_ms = 0;     // of reading alone, decoding the file apart
  std::string warning{};  // what the file's decoder could make good; empty = nothing
};

// The position that the digits code: by the code of the survey that has such a tag, else by the
// paper's (4, 4, 3 digits, centimetres, origin 0). Metres, rounded to a micrometre.
GridPoint coded_position(const Digits& digits, const std::vector<Survey>& surveys);

// "sum10", "gs1", "both", or "none".
std::string check_digit_name(const Reading& reading);
std::string check_digit_name(const FramelessReading& reading);

std::string to_json_line(const ImageReadings& readings, const std::vector<Survey>& surveys);
std::string to_json_line(const FileReport& report);
std::string to_json_line(const VerifySummary& summary);

// The summary with `completeness`: what the files, and those of earlier runs, cover of the survey.
// `hung`: where tags hang, when that was asked for. `skipped`: what folders hold besides.
std::string to_json_line(const VerifySummary& summary, const Survey& survey,
                         const VerifyMerge& merged, const std::optional<HungTags>& hung,
                         const SkippedFiles& skipped);

// The summary of `report`.
std::string report_json_line(const Survey& survey, const VerifyMerge& merged,
                             const std::optional<HungTags>& hung);

}  // namespace tagsmith
