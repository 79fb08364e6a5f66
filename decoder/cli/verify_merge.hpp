// SPDX-License-Identifier: Apache-2.0
// Many verified files as one answer, tag by tag.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "decoder/cli/verify_lines.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith {

// What all files say about one tag.
struct TagRecord {
  std::size_t seen = 0;  // times it was in order
  std::size_t faults = 0;
  std::optional<double> best;  // grades
  std::optional<double> worst;
  std::string blame;  // of the worst
};

struct FaultRecord {
  std::string file;
  std::string tag;  // empty when it has no name, or the whole file is meant
  std::string rule;
  std::string message;
  std::string crop;
};

// Faults that are listed; all are counted.
inline constexpr std::size_t kMostListedFaults = 20'000;

struct VerifyMerge {
  std::size_t files = 0;
  std::size_t repeated = 0;         // verified in more than one run, and counted once
  std::size_t other_revisions = 0;  // verified against another state of the survey
  std::map<std::string, TagRecord> tags;
  std::vector<FaultRecord> faults;
  std::size_t fault_count = 0;
  std::unordered_set<std::uint64_t> known;  // of file and content
};

void merge(const std::string& revision, const VerifiedFile& file, VerifyMerge& merged);

// "unseen", "faulty", "poor" (worst grade below 1.5) or "ok".
std::string status_of(const TagRecord& record);

// A line a tag of the survey: tag, digits, chainage_m, status, seen, faults, best_grade,
// worst_grade, blame.
std::string report_csv(const Survey& survey, const VerifyMerge& merged);

// The report as one web page that needs nothing else. Fails when the map cannot be drawn.
Result<std::string> report_page(const Survey& survey, const VerifyMerge& merged);

}  // namespace tagsmith
