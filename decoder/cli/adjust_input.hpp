// SPDX-License-Identifier: Apache-2.0
// What `adjust` works on: the survey, the rig, control tags, and every sighting of a tag.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "decoder/cli/verify_hanging.hpp"
#include "decoder/verify/hanging_check.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

inline constexpr const char* kAdjust = "adjust";

struct AdjustOptions {
  std::string survey;
  std::vector<std::string> files;
  HangingOptions hanging;
  std::vector<std::string> control;
  std::string output;   // the survey that is written
  std::string diff;     // the same as changes to the survey
  std::string drawing;  // PDF, SVG or PNG
  std::string date;
  bool json = false;
  int jobs = 0;
};

struct AdjustInput {
  Survey survey;
  HangingSetup setup;
  std::vector<std::filesystem::path> lines;  // output of verify
  std::vector<std::filesystem::path> photos;
  std::vector<std::string> control;  // names of tags of the survey
};

// Fails, before any photo is read, on what cannot be used or written.
Result<AdjustInput> load_adjust_input(const AdjustOptions& options);

// Every sighting of a tag of the survey, by the photos and by the lines. What was left out is told
// on standard error.
Result<std::vector<SightedTag>> sighted_tags(const AdjustInput& input, int jobs);

}  // namespace tagsmith::detail
