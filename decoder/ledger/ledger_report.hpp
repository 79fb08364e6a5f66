// SPDX-License-Identifier: Apache-2.0
// What the ledger says of all plates of a survey.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "decoder/ledger/ledger.hpp"
#include "decoder/ledger/plate_history.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

struct LedgerReport {
  LedgerCounts photos;
  std::optional<Day> oldest;        // day of the oldest photo of a plate
  std::optional<Day> newest;        // day of the newest one: now, in what follows
  std::vector<PlateState> plates;   // all of the survey, the most urgent first
  std::vector<MendedFault> mended;  // the latest first
  std::size_t trends = 0;           // plates that have one
  std::size_t losing_light = 0;     // of these, by contrast or modulation on their way to the limit

  // Plates do not get dirty all at once: then it is a lens, its focus, a lamp, or dust in the air.
  bool blames_camera() const { return trends >= 5 && 2 * losing_light > trends; }
};

// What to do when the report blames the camera, in words.
std::string camera_in_words(const LedgerReport& report);

// No photo can have been taken after the day `last`: those that are dated so count as undated.
Result<LedgerReport> make_ledger_report(const Survey& survey, const Ledger& ledger, Day last);

// The survey's plates for which this is to be done, in the survey's order.
std::vector<std::string> plates_to(PlateAction action, const Survey& survey,
                                   const LedgerReport& report);

}  // namespace tagsmith::detail
