// SPDX-License-Identifier: Apache-2.0
// Readings of one picture against the survey.
#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "decoder/reader/reading.hpp"
#include "decoder/verify/finding.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith {

// Width and height of a picture, pixels.
struct PictureSize {
  int width = 0;
  int height = 0;
};

// A finding for every reading and every refusal, in the order given. A code that the survey has is
// `ok`; a second reading of it is a `duplicate`; a reading that breaks the survey's check digit is
// `misprinted`, any other `unknown`, both with the nearest code of the survey in the message, or
// with its name in one of the surveys `also` given. A
// refusal is `unreadable`; in a photo whose `size` is given one that lies so near the edge that the
// tag may go on outside is `cut_off`.
std::vector<TagFinding> check_tags(const Survey& survey, const ReadResult& readings,
                                   const std::optional<PictureSize>& size = std::nullopt,
                                   std::span<const Survey> also = {});

// The survey's tag whose digits differ least from these; null when the survey has no tags.
const PlacedTag* nearest_tag(const Survey& survey, const Digits& digits);

// "digit 5 (found 3, expected 8), digit 12 (...)": where two codes differ, counted from 1.
std::string describe_difference(const Digits& found, const Digits& expected);

// What is wrong with the printed size of a feature frame whose inner corners were found in a page
// rasterised at `metres_per_pixel`; nothing when both sides are within 0.5 % (or 1.5 pixels).
std::optional<std::string> check_print_size(const TagTemplate& tag, const FrameCorners& corners,
                                            double metres_per_pixel);

// Adds up reports one by one, without keeping them.
class VerifyTally {
 public:
  void add(const FileReport& report);

  // Counts, and the survey's tags that no report shows as ok (or twice).
  VerifySummary summary(const Survey& survey) const;

 private:
  VerifySummary counts_;
  std::set<std::string> seen_;
};

// The tally of reports that are at hand together.
VerifySummary summarize(const Survey& survey, std::span<const FileReport> reports);

}  // namespace tagsmith
